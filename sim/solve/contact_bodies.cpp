// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/contact_bodies.h"

#include <algorithm>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/compound.h"
#include "sim/pieces.h"
#include "sim/solve/rows.h"
#include "sim/tangent.h"
#include "sim/touch.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

/// What the row of a contact with a piece sees of an end of it, of which it has that share, where
/// the force along `e` acts `off` (m) to the right of the piece's line.
Eigen::Vector3d sight_of_end(const World& world, const Link& end, const Vec2& e, double off,
                             double share) {
  if (end.body < 0) return Eigen::Vector3d::Zero();
  const bool is_node = at(world.bodies, end.body).node;
  const double lever =
      is_node ? off : cross(link_centre(world, end) - pivot_of(world, end.body), e);
  return share * Eigen::Vector3d(e.x(), e.y(), lever);
}

/// The span that leaves a drum's layers, from one link of its cable to the next, and what turns it.
///
/// It is a tangent of its ends' circles, left(e) . (c_b - c_a) = p_b - p_a with e = (cos alpha, sin
/// alpha), and the signed radius of what fills changes by p' = slope (alpha' - om), so that
///     length alpha' = left(e) . (c_b' - c_a') - slope_a om_a + slope_b om_b,
///     length = L - slope_a + slope_b.
/// By that the radius of a drum in layers changes, R' = way orientation growth (alpha' - om).
struct LeavingSpan {
  int from = -1, to = -1;
  double slope_a = 0.0, slope_b = 0.0;  // m/rad
  double length = 0.0;                  // m
  Vec2 across = Vec2::Zero();           // left(e)
};

LeavingSpan leaving_span(const CableState& cable, int drum) {
  LeavingSpan span;
  const int after = next_link(cable, drum);
  span.to = at(cable.links, drum).layers.way > 0 ? after : drum;
  span.from = previous_link(cable, span.to);
  const Layers &a = at(cable.links, span.from).layers, &b = at(cable.links, span.to).layers;
  if (a.way > 0) span.slope_a = a.growth;
  if (b.way < 0) span.slope_b = -b.growth;
  const Segment& segment = at(cable.segments, span.to);
  // As of ropes with mass (mass.cpp): what is shorter has no room for a turn more or less.
  span.length = std::max(segment.length + span.slope_b - span.slope_a, 0.5 * segment.length);
  span.across = left(segment.direction);
  return span;
}

/// m/rad, of the radius of a drum in layers.
double growth_of(const Link& drum) {
  return drum.layers.way * drum.orientation * drum.layers.growth;
}

double turning_of(const World& world, const Link& link) {
  return link.body >= 0 ? at(world.angular_velocity, link.body) : 0.0;
}

/// The radius (m) of the layers that a contact presses, `later` s from now.
double radius_of_layers(const World& world, const Contact& contact, double later) {
  const CableState& cable = at(world.cables, contact.layers_cable);
  const int number = number_of_pressed_layers(world, contact);
  const Link& drum = at(cable.links, number);
  const LeavingSpan span = leaving_span(cable, number);
  double turning = 0.0;  // rad/s, of the span
  if (span.length > 0.0) {
    const Link &from = at(cable.links, span.from), &to = at(cable.links, span.to);
    turning = (span.across.dot(velocity_of(world, to) - velocity_of(world, from)) +
               span.slope_b * turning_of(world, to) - span.slope_a * turning_of(world, from)) /
              span.length;
  }
  return drum.radius + later * growth_of(drum) * (turning - turning_of(world, drum));
}

void set_third(PartSystem& s, int r, int place, const Eigen::Vector3d& j) {
  at(s.rows, r).has_third = true;
  at(s.rows, r).item = static_cast<int>(s.thirds.size());
  s.thirds.push_back({r, place, j, Eigen::Vector3d::Zero()});
}

}  // namespace

void set_levers(const World& world, const Contact& contact, RowBodies& bodies) {
  Vec2 point = meeting_of(world, contact).point;
  if (contact.layers_cable >= 0) {  // on the centre line of the outermost
    const Link& drum = pressed_layers(world, contact);
    const double way = drum.body == contact.a ? 1.0 : -1.0;
    point = at(world.position, drum.body) + way * drum.radius * contact.normal;
  }
  bodies.ja.z() = cross(point - pivot_of(world, contact.a), bodies.ja.head<2>());
  if (contact.b < 0) return;
  bodies.jb.z() = cross(point - pivot_of(world, contact.b), bodies.jb.head<2>());
}

void add_seats(const World& world, const Contact& contact, RowBodies& bodies) {
  if (world.carried.empty()) return;
  bodies.ja.z() += cross(seat_of(world, contact.a), bodies.ja.head<2>());
  if (contact.b >= 0) bodies.jb.z() += cross(seat_of(world, contact.b), bodies.jb.head<2>());
}

void set_tangent_bodies(const World& world, const Contact& contact, const TimeSpan& interval,
                        RowBodies& bodies) {
  const Vec2 t = left(contact.normal);
  if (contact.touch != Touch::circles) {
    bodies.ja = {-t.x(), -t.y(), 0.0};
    bodies.jb = {t.x(), t.y(), 0.0};
    set_levers(world, contact, bodies);
    return;
  }
  const double radius_a = at(world.bodies, contact.a).radius;
  const double radius_b = contact.b >= 0 ? at(world.bodies, contact.b).radius : 0.0;
  const double radii = radius_a + radius_b;
  const double reach = (radii + contact.gap) / radii;
  double lever_a = radius_a * reach, lever_b = radius_b * reach;
  if (contact.layers_cable >= 0) {  // at the centre line of the outermost, in the interval's middle
    const Link& drum = pressed_layers(world, contact);
    const bool is_a = drum.body == contact.a;
    const double radius = radius_of_layers(world, contact, 0.5 * interval.length);
    const double other = radii + contact.gap - drum.radius;
    lever_a = is_a ? radius : other;
    lever_b = is_a ? other : radius;
  }
  bodies.ja = {-t.x(), -t.y(), -lever_a};
  bodies.jb = {t.x(), t.y(), -lever_b};
  add_seats(world, contact, bodies);
}

namespace {

/// Motion of a body, or of the world, as of what carries it.
struct Course {
  Vec2 pivot = Vec2::Zero(), velocity = Vec2::Zero();  // m, m/s
  double turning = 0.0;                                // rad/s

  Vec2 at(const Vec2& point) const { return velocity + turning * left(point - pivot); }
};

Course course_of(const World& world, int body) {
  if (body < 0) return {};
  const int mover = mover_of(world, body);
  return {pivot_of(world, body), at(world.velocity, mover), at(world.angular_velocity, mover)};
}

}  // namespace

// At constant velocities, with t = left(n) and P where the surfaces meet,
//     s  = t . (v_b + om_b left(P - x_b) - v_a - om_a left(P - x_a)),
//     s' = n . (om_b (P' - v_b) - om_a (P' - v_a)),
// since t . left(y) = n . y; and t' . (...) = 0, for what slides does so along t. P moves with the
// point of the one body, and turns about it as n does: with the other body's side, or, where both
// are round there, as the line from centre to centre.
double change_of_sliding(const World& world, const Contact& contact, double length) {
  if (contact.touch == Touch::circles || contact.touch == Touch::piece) return 0.0;
  const Course a = course_of(world, contact.a), b = course_of(world, contact.b);
  Vec2 point;
  Course of_point, of_outline = a;
  if (contact.touch == Touch::end_of_wall) {
    const Obstacle& wall = at(world.obstacles, contact.wall);
    point = contact.point == 0 ? wall.a : wall.b;
  } else {
    const bool of_a = contact.touch == Touch::point_of_a;
    point = place_of_point(world, of_a ? contact.a : contact.b, contact.point);
    of_point = of_a ? a : b;
    of_outline = of_a ? b : a;
  }
  const Meeting meeting = meeting_of(world, contact);
  const Vec2 from_point = meeting.point - point;
  double turning = of_outline.turning;  // rad/s, of n
  if (meeting.apart > 0.0) {
    const double off = from_point.norm();
    if (!(off > 0.0)) return 0.0;  // corner on corner, neither rounded
    const Vec2 way = from_point / off, other = point + meeting.apart * way;
    turning = left(way).dot(of_outline.at(other) - of_point.at(point)) / meeting.apart;
  }
  const Vec2 moves = of_point.at(point) + turning * left(from_point);
  const Vec2 sweep = b.turning * (moves - b.velocity) - a.turning * (moves - a.velocity);
  return 0.5 * length * contact.normal.dot(sweep);
}

void add_growth_of_layers(const World& world, const Parts& parts, const Contact& contact,
                          PartSystem& s, int r) {
  const CableState& cable = at(world.cables, contact.layers_cable);
  const int number = number_of_pressed_layers(world, contact);
  const Link& drum = at(cable.links, number);
  const auto add = [&](int body, const Eigen::Vector3d& j) {
    const int place = place_of(parts, s, body);
    if (place == s.ground()) return;
    RowBodies& bodies = at(s.bodies, r);
    if (place == bodies.a) {
      bodies.ja += j;
    } else if (place == bodies.b) {
      bodies.jb += j;
    } else {
      set_third(s, r, place, j);
    }
  };
  const double growth = growth_of(drum);
  add(drum.body, {0.0, 0.0, growth});
  const LeavingSpan span = leaving_span(cable, number);
  if (!(span.length > 0.0)) return;
  const double share = -growth / span.length;
  const auto add_end = [&](int link, double sign, double slope) {
    const Link& end = at(cable.links, link);
    Eigen::Vector3d j = sight_of_end(world, end, span.across, 0.0, sign * share);
    j.z() += share * slope;
    add(end.body, j);
  };
  add_end(span.from, -1.0, -span.slope_a);
  add_end(span.to, 1.0, span.slope_b);
}

void set_bodies_at_piece(const World& world, const Parts& parts, const Contact& contact, bool along,
                         PartSystem& s, int r) {
  const Foot foot = foot_of(world, contact);
  const CableState& piece = at(world.cables, foot.cable);
  const int touching = body_at_piece(world, contact);
  const Vec2 e = along ? left(foot.way) : foot.way;
  const double reach = 1.0 + foot.gap / (foot.radius + piece.half_width);
  RowBodies& bodies = at(s.bodies, r);
  bodies.a = place_of(parts, s, touching);
  if (touching >= 0) {
    const double about = cross(foot.place - pivot_of(world, touching), -e);
    bodies.ja = {-e.x(), -e.y(), about - (along ? reach * foot.radius : 0.0)};
  }
  const double off = along ? -reach * piece.half_width : 0.0;
  const Link &tail = piece.links[0], &head = piece.links[1];
  const Eigen::Vector3d of_tail = sight_of_end(world, tail, e, off, 1.0 - foot.share);
  const Eigen::Vector3d of_head = sight_of_end(world, head, e, off, foot.share);
  const int at_tail = place_of(parts, s, tail.body), at_head = place_of(parts, s, head.body);
  const bool is_one = at_tail == at_head || at_head == s.ground();
  bodies.b = is_one || at_tail != s.ground() ? at_tail : at_head;
  bodies.jb = at_tail == s.ground() ? of_head : of_tail;
  if (at_tail == at_head) bodies.jb = of_tail + of_head;
  if (!is_one && at_tail != s.ground()) {
    set_third(s, r, at_head, of_head);
  }
  at(s.responses, r).a = bodies.a;
  at(s.responses, r).b = bodies.b;
}

}  // namespace pinchlab
