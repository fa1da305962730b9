// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/touch.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <span>

#include "base/at.h"
#include "sim/compound.h"
#include "sim/lines.h"
#include "sim/outline.h"
#include "sim/pieces.h"
#include "sim/seams.h"
#include "sim/tangent.h"
#include "sim/tips.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

/// Points with which a body may touch another: its corners, or its centre.
int points_of(const BodyProperties& body) {
  return is_polygon(body) ? static_cast<int>(body.corners.size()) : 1;
}

/// What a point that touches is a tip of: a corner of a polygon, or an end of a wall. A disc's
/// centre is none.
struct Tip {
  int body = -1;            // the polygon, or -1
  Vec2 way = Vec2::Zero();  // along the bisector, outwards, in the world's frame; 0: no tip
  double most = 0.0;        // of way . n, for sides of way out n that it may touch
};

Tip tip_of(const World& world, int body, int point) {
  const BodyProperties& b = at(world.bodies, body);
  if (!is_polygon(b)) return {};
  return {body, turned(way_out_at(b.corners, point), at(world.angle, body)), 0.0};
}

/// A wall is without width: what lies flat on it may be tilted either way by round-off.
Tip tip_of_wall(const Obstacle& wall, int end) {
  if (wall.cable >= 0) return {};
  const Vec2 way = (wall.b - wall.a).normalized();
  return {-1, end == 0 ? Vec2(-way) : way, std::numbers::sqrt2 / 2.0};
}

/// Where corners are this near (m), which of two sides they are in front of is round-off.
double one_place(const World& world, int body, int other) {
  constexpr double share = 1e-11;  // the solver's within_reach: gaps are right to a tenth of it
  const double coordinate = at(world.position, body).cwiseAbs().maxCoeff();
  return share * (coordinate + at(world.bodies, body).radius +
                  (other >= 0 ? at(world.bodies, other).radius : 0.0));
}

/// How far the points of `other` are in front of the body's side that parts the two most (m).
double separation_by_sides(const World& world, int body, int other) {
  const BodyProperties& points = at(world.bodies, other);
  const double angle = at(world.angle, body), turn = at(world.angle, other) - angle;
  const Vec2 centre = turned(at(world.position, other) - at(world.position, body), -angle);
  std::array<Vec2, most_corners> places{centre};
  for (std::size_t k = 0; k < points.corners.size(); ++k) {
    places[k] = centre + turned(points.corners[k], turn);
  }
  return parted_by(at(world.bodies, body).corners,
                   std::span(places).first(index(points_of(points))));
}

/// The least distance of a point of `other` from the body's sides (m).
double distance_from_sides(const World& world, int body, int other) {
  const int sides = points_of(at(world.bodies, body));
  double least = infinity;
  for (int k = 0; k < points_of(at(world.bodies, other)); ++k) {
    const Vec2 point = place_of_point(world, other, k);
    for (int i = 0; i < sides; ++i) {
      least =
          std::min(least, distance_from_line(place_of_point(world, body, i),
                                             place_of_point(world, body, (i + 1) % sides), point));
    }
  }
  return least;
}

/// Whether two polygons overlap by `depth` (m, > 0) or more along every side's way out.
bool overlap_by(const World& world, int body, int other, double depth) {
  return separation_by_sides(world, body, other) <= -depth &&
         separation_by_sides(world, other, body) <= -depth;
}

/// Of a tip (m) from the body's core: where it is not in front of a side that it may touch, all of
/// what it is a tip of is nearer to the body than itself, or has come into it. Two polygons on one
/// floor are such a case: the tip of one lies on the line of the other's underside, and would go
/// along that for ever.
///
/// A tip of bisector b may touch sides of way out n where n . b <= 0: -n is then in the cone of its
/// own two ways out, or by half of its angle beside it. So is any that what it belongs to rests on
/// or slides along, tilted by round-off or not, and none that is behind it.
Outside in_front(const World& world, int body, const Vec2& point, const Tip& tip,
                 const Outside& out) {
  const std::vector<Vec2>& corners = at(world.bodies, body).corners;
  const double angle = at(world.angle, body);
  const Vec2 way = turned(tip.way, -angle);
  const double near = one_place(world, body, tip.body);
  if (out.distance > near && (tip.body < 0 || out.normal.dot(way) <= tip.most)) return out;
  Outside sides = outside_of_sides(corners, point, way, tip.most);
  if (out.distance <= near) return sides;
  // Two tips that lean over each other as they meet pass by below both: neither is in the other.
  const bool has_passed =
      sides.distance < -out.distance && overlap_by(world, body, tip.body, -sides.distance - near);
  return has_passed ? sides : out;
}

/// Whether a contact is of a sharp corner and a side.
bool is_on_side(const Contact& contact) {
  return contact.side >= 0 && contact.target == 0.0;
}

/// Of a point (m) from the body's core, or from a side of it, in the world's frame.
Outside outside_of_body(const World& world, int body, const Vec2& point, const Tip& tip, int side) {
  const BodyProperties& b = at(world.bodies, body);
  const Vec2 from = point - at(world.position, body);
  if (!is_polygon(b)) {
    const double distance = from.norm();
    return {distance, distance > 0.0 ? Vec2(from / distance) : Vec2(1.0, 0.0), true};
  }
  const double angle = at(world.angle, body);
  const Vec2 inside = turned(from, -angle);
  Outside out;
  if (side >= 0) {
    out = outside_of_side(b.corners, index(side), inside);
  } else {
    out = outside_of(b.corners, inside);
    if (tip.most > 0.0 || tip.body >= 0) out = in_front(world, body, inside, tip, out);
  }
  out.normal = turned(out.normal, angle);
  return out;
}

/// Of two discs, or a disc and a wall.
struct Apart {
  Vec2 way;               // m, from the centre of a to that of b, or to the wall
  double distance = 0.0;  // m, its length; below 0: a has gone through to the far side
  double gap = 0.0;       // m
};

/// Whether what is on the contact's far side now, `way` (m) from a to b, has come there through b
/// rather than past it. `radii` (m) of both in sum.
bool has_gone_through(const World& world, const Contact& contact, const Vec2& way, double radii) {
  if (contact.b < 0 && !is_end_of_cable(world, contact)) return true;  // of a wall
  const Vec2 way_before = (contact.gap + radii) * contact.normal;
  return distance_from_line(way_before, way, Vec2::Zero()) < radii;
}

Apart circles_apart(const World& world, const Contact& contact) {
  const Vec2& a = at(world.position, contact.a);
  Apart apart;
  double radii = at(world.bodies, contact.a).radius;
  if (contact.b >= 0) {
    apart.way = at(world.position, contact.b) - a;
    radii += at(world.bodies, contact.b).radius;
  } else {
    const Obstacle& obstacle = at(world.obstacles, contact.wall);
    apart.way = nearest_on_line(obstacle.a, obstacle.b, a) - a;
    radii += obstacle.radius;
  }
  const double length = apart.way.norm();
  apart.distance = length;
  if (apart.way.dot(contact.normal) < 0.0 && has_gone_through(world, contact, apart.way, radii)) {
    apart.distance = -length;
  }
  apart.gap = apart.distance - radii;
  return apart;
}

}  // namespace

bool may_change_gaps(const BodyProperties& body) {
  return can_move(body) || (is_polygon(body) && !is_static(body));
}

bool can_give(const World& world, const Contact& contact) {
  return may_change_gaps(at(world.bodies, contact.a)) ||
         (contact.b >= 0 && may_change_gaps(at(world.bodies, contact.b)));
}

bool only_turns_one(const World& world, const Contact& contact) {
  int turning = 0;
  for (const int touching : {contact.a, contact.b}) {
    if (touching < 0) continue;
    const BodyProperties& body = at(world.bodies, mover_of(world, touching));
    if (can_move(body)) return false;
    turning += is_static(body) ? 0 : 1;
  }
  return turning == 1;
}

bool is_end_of_cable(const World& world, const Contact& contact) {
  return contact.b < 0 && at(world.obstacles, contact.wall).cable >= 0;
}

namespace {

/// Where bodies are, or were (m, rad).
struct Places {
  const std::vector<Vec2>& position;
  const std::vector<double>& angle;
};

/// Of a contact that is not of two discs: whose point it is of, -1: a wall's end; and what that is
/// seen from, -1: a wall.
struct Parties {
  int owner = -1, other = -1;
};

Parties parties_of(const Contact& contact) {
  const bool of_a = contact.touch == Touch::point_of_a || contact.touch == Touch::circles;
  return of_a ? Parties{contact.a, contact.b} : Parties{contact.b, contact.a};
}

Vec2 place_of_point(const World& world, int body, int point, const Places& places) {
  const BodyProperties& b = at(world.bodies, body);
  const Vec2& centre = at(places.position, body);
  return is_polygon(b) ? Vec2(centre + turned(at(b.corners, point), at(places.angle, body)))
                       : centre;
}

/// Of the point with which a contact touches.
Vec2 place_of_touch(const World& world, const Contact& contact, const Places& places) {
  const int owner = parties_of(contact).owner;
  if (owner >= 0) return place_of_point(world, owner, contact.point, places);
  const Obstacle& wall = at(world.obstacles, contact.wall);
  return contact.point == 0 ? wall.a : wall.b;
}

Places places_now(const World& world) {
  return {world.position, world.angle};
}

}  // namespace

Vec2 place_of_point(const World& world, int body, int point) {
  return place_of_point(world, body, point, places_now(world));
}

Vec2 nearest_place(const World& world, const Contact& contact, int body) {
  const bool of_a = contact.touch == Touch::point_of_a;
  const int owner = parties_of(contact).owner;
  Vec2 point = place_of_point(world, owner, contact.point);
  if (body == owner) return point;
  const double way = contact.gap + rim_radius(at(world.bodies, contact.a)) +
                     rim_radius(at(world.bodies, contact.b));
  return point + (of_a ? way : -way) * contact.normal;
}

void measure(const World& world, Contact& contact) {
  if (contact.touch == Touch::piece) return measure_piece(world, contact);
  if (contact.touch != Touch::circles) {
    const Meeting meeting = meeting_of(world, contact);
    contact.gap = meeting.gap;
    contact.normal = meeting.normal;
    return;
  }
  const Apart apart = circles_apart(world, contact);
  contact.gap = apart.gap;
  if (apart.distance != 0.0) contact.normal = apart.way / apart.distance;
}

double gap_of(const World& world, const Contact& contact) {
  if (contact.touch == Touch::piece) return gap_of_piece(world, contact);
  // Nearest to what pieces meet as long as it is away from the rest of the outline.
  if (contact.away != 0 && is_left_to_pieces(world, contact)) return infinity;
  if (contact.touch != Touch::circles) return meeting_of(world, contact).gap;
  return circles_apart(world, contact).gap;
}

Meeting meeting_of(const World& world, const Contact& contact) {
  const bool of_a = contact.touch == Touch::point_of_a;
  const auto [owner, other] = parties_of(contact);
  const Vec2 point = place_of_touch(world, contact, places_now(world));
  double radius = 0.0, other_radius = 0.0;
  // What bears force on a side does so on its line past its end, until that has been found out, an
  // event of jumps.h.
  const int side = contact.touching && is_on_side(contact) ? contact.side : -1;
  Outside out;
  if (contact.touch == Touch::end_of_wall) {
    const Obstacle& obstacle = at(world.obstacles, contact.wall);
    radius = obstacle.radius;
    out = outside_of_body(world, other, point, tip_of_wall(obstacle, contact.point), side);
    other_radius = rim_radius(at(world.bodies, other));
  } else {
    radius = rim_radius(at(world.bodies, owner));
    if (other < 0) {
      const Obstacle& wall = at(world.obstacles, contact.wall);
      const Vec2& centre = at(world.position, owner);
      out = contact.touching || is_beside(wall, centre, point)
                ? outside_of_line(wall, centre, point)
                : outside_of_end(wall, point);
    } else {
      out = outside_of_body(world, other, point, tip_of(world, owner, contact.point), side);
      other_radius = rim_radius(at(world.bodies, other));
    }
  }
  Meeting meeting;
  meeting.gap = out.distance - radius - other_radius;
  meeting.normal = of_a ? Vec2(-out.normal) : out.normal;
  meeting.point = point - (radius + 0.5 * meeting.gap) * out.normal;
  if (out.round) meeting.apart = out.distance;
  if (radius + other_radius == 0.0) meeting.side = out.side;
  return meeting;
}

double on_straight(const World& world, const Contact& contact, const std::vector<Vec2>& position,
                   const std::vector<double>& angle) {
  if (contact.touch == Touch::piece || is_end_of_cable(world, contact)) return infinity;
  const int other = parties_of(contact).other;
  const Vec2 point = place_of_touch(world, contact, {position, angle});
  if (other < 0) {
    const Obstacle& wall = at(world.obstacles, contact.wall);
    return along_side(std::array{wall.a, wall.b}, 0, point);
  }
  const BodyProperties& outline = at(world.bodies, other);
  if (!is_polygon(outline)) return infinity;
  const Vec2 seen = turned(point - at(position, other), -at(angle, other));
  if (is_on_side(contact)) return along_side(outline.corners, index(contact.side), seen);
  return along_side(outline.corners, seen);
}

bool ends_beyond(const Contact& contact) {
  const bool of_wall = contact.touch == Touch::point_of_a && contact.b < 0;
  return of_wall || is_on_side(contact);
}

Vec2 relative_velocity(const World& world, const Contact& contact, const Vec2& place) {
  const auto velocity = [&](int body) {
    return Vec2(at(world.velocity, body) +
                at(world.angular_velocity, body) * left(place - at(world.position, body)));
  };
  const Vec2 of_b = contact.b >= 0 ? velocity(contact.b) : Vec2(Vec2::Zero());
  return of_b - velocity(contact.a);
}

namespace {

/// Unit, from a body's corner along the side of it which a contact there of this normal is on.
Vec2 side_from(const World& world, int body, int corner, const Vec2& normal) {
  const int corners = points_of(at(world.bodies, body));
  const Vec2 point = place_of_point(world, body, corner);
  const auto way_to = [&](int other) {
    return Vec2((place_of_point(world, body, other % corners) - point).normalized());
  };
  const Vec2 next = way_to(corner + 1), last = way_to(corner + corners - 1);
  return std::abs(next.dot(normal)) <= std::abs(last.dot(normal)) ? next : last;
}

/// Of two contacts of a pair at one place, of a's corner with b and of b's with a, how much rather
/// the second is the one that counts (m/s). Each asks for the pair to be apart along one way, and
/// one way is enough: so it is that along which they part faster, lest a corner that passes another
/// is stopped by the side that it comes off. `round_off` (m/s): of these speeds. Flat on each other
/// they part as fast along either: then the corner counts that comes on to its side.
double counts_rather(const World& world, const Contact& of_a, const Contact& of_b,
                     const Vec2& place, double round_off) {
  const Vec2 velocity = relative_velocity(world, of_a, place);
  const double faster = velocity.dot(of_b.normal - of_a.normal);
  if (std::abs(faster) > round_off) return faster;
  const Vec2 side_of_a = side_from(world, of_a.a, of_a.point, of_b.normal);
  if (of_a.b >= 0) {
    return velocity.dot(side_of_a + side_from(world, of_a.b, of_b.point, of_a.normal));
  }
  const Obstacle& wall = at(world.obstacles, of_a.wall);
  const Vec2 along = (wall.b - wall.a).normalized();
  return velocity.dot(side_of_a + (of_b.point == 0 ? along : Vec2(-along)));
}

/// The last contact is of a point of b or of a wall: leaves it out, or one of a corner of a at the
/// same place among those from `first` on, where the other counts rather, or, of bodies, both as
/// much: where corner meets corner, one of the two is enough.
void leave_out_repeated(const World& world, std::ptrdiff_t first, std::vector<Contact>& to) {
  const Contact last = to.back();
  const bool of_bodies = last.b >= 0;
  // Far above round-off, and nothing that turns a body by a force at the one corner or the other.
  const double radii =
      at(world.bodies, last.a).radius + (of_bodies ? at(world.bodies, last.b).radius : 0.0);
  const double same = 1e-9 * radii;  // m, within which places and gaps are
  const Vec2 place = place_of_touch(world, last, places_now(world));
  const auto end = to.end() - 1;
  const auto there = std::find_if(to.begin() + first, end, [&](const Contact& c) {
    return c.touch == Touch::point_of_a && c.gap <= last.gap + same &&
           (place_of_point(world, c.a, c.point) - place).norm() <= same;
  });
  if (there == end) return;
  const double round_off = one_place(world, last.a, last.b) / world.step_length;
  double rather = counts_rather(world, *there, last, place, round_off);
  if (of_bodies && std::abs(rather) <= round_off) {
    // Neither moves along its side. Corners that rest on each other bear a force along either way,
    // and along what is between; of such that lie flat one that is beyond its end has no way.
    constexpr double flat = 1e-6;  // rad
    if (std::abs(cross(there->normal, last.normal)) > flat) return;
    const auto left_over = [&world](const Contact& c) {
      return on_straight(world, c, world.position, world.angle);
    };
    rather = left_over(last) > left_over(*there) ? infinity : 0.0;
  }
  if (rather > round_off && last.gap <= there->gap + same) {
    to.erase(there);
  } else if (of_bodies || rather < -round_off) {
    to.pop_back();
  }
}

/// Whether a contact's point, within round-off of where the side that it is on ends, has come off
/// it: where it moves on along it. One that stays there, as a corner of a box does on another as
/// wide, is on it: beyond, a distance of round-off has a normal of round-off.
bool comes_off(const World& world, const Contact& contact) {
  const double near = one_place(world, contact.a, contact.b);
  const double left_over = on_straight(world, contact, world.position, world.angle);
  if (left_over > near) return false;
  if (left_over < -near) return true;
  const int other = parties_of(contact).other;
  const Vec2 begin = place_of_point(world, other, contact.side);
  const Vec2 end =
      place_of_point(world, other, (contact.side + 1) % points_of(at(world.bodies, other)));
  const Vec2 point = place_of_touch(world, contact, places_now(world));
  Vec2 out = (end - begin).normalized();
  if (out.dot(2.0 * point - begin - end) < 0.0) out = -out;
  // Of b less that of a, and the point is a's or b's (a wall's end stands).
  const double of_point = contact.touch == Touch::point_of_a ? -1.0 : 1.0;
  return of_point * relative_velocity(world, contact, point).dot(out) > near / world.step_length;
}

}  // namespace

void append_touches(const World& world, int a, int b, int wall, double most,
                    std::vector<Contact>& to) {
  const auto first = static_cast<std::ptrdiff_t>(to.size());
  Contact contact;
  contact.a = a;
  contact.b = b;
  contact.wall = wall;
  const auto append = [&](Touch touch, int point) {
    contact.touch = touch;
    contact.point = static_cast<std::int8_t>(point);
    const Meeting meeting = meeting_of(world, contact);
    if (meeting.gap > most) return;
    contact.gap = meeting.gap;
    contact.normal = meeting.normal;
    contact.side = static_cast<std::int8_t>(meeting.side);
    if (goes_past(world, one_place(world, a, b), contact)) return;
    if (contact.side >= 0 && comes_off(world, contact)) contact.side = -1;
    to.push_back(contact);
  };
  // Of a point of b or of a wall, after those of a.
  const auto append_other = [&](Touch touch, int point) {
    const std::size_t before = to.size();
    append(touch, point);
    if (to.size() > before) leave_out_repeated(world, first, to);
  };
  const BodyProperties& body = at(world.bodies, a);
  if (b < 0) {
    const Obstacle& obstacle = at(world.obstacles, wall);
    const bool is_point = obstacle.cable >= 0;
    // What is fast may come beside it, and through it, within a step.
    const bool is_fast = most > inner_radius(body);
    for (int k = 0; !is_point && k < points_of(body); ++k) {
      const Vec2 point = place_of_point(world, a, k);
      const bool may_come =
          is_fast && outside_of_end(obstacle, point).distance > 1e-6 * body.radius;
      if (may_come || is_beside(obstacle, at(world.position, a), point)) {
        append(Touch::point_of_a, k);
      }
    }
    append_other(Touch::end_of_wall, 0);
    if (!is_point) append_other(Touch::end_of_wall, 1);
    return;
  }
  const BodyProperties& other = at(world.bodies, b);
  if (is_polygon(other)) {
    for (int k = 0; k < points_of(body); ++k) append(Touch::point_of_a, k);
  }
  if (!is_polygon(body)) return;
  for (int k = 0; k < points_of(other); ++k) append_other(Touch::point_of_b, k);
}

double separation(const World& world, int a, int b) {
  double most = -infinity;
  if (is_polygon(at(world.bodies, a))) most = separation_by_sides(world, a, b);
  if (is_polygon(at(world.bodies, b))) most = std::max(most, separation_by_sides(world, b, a));
  // Apart, two cores are nearest where a corner of one is to a side of the other.
  if (most > 0.0) {
    most = std::min(distance_from_sides(world, a, b), distance_from_sides(world, b, a));
  }
  return most - rim_radius(at(world.bodies, a)) - rim_radius(at(world.bodies, b));
}

}  // namespace pinchlab
