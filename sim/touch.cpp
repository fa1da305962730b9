// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/touch.h"

#include <algorithm>
#include <array>

#include "base/at.h"
#include "sim/lines.h"
#include "sim/outline.h"
#include "sim/tangent.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

/// Points with which a body may touch another: its corners, or its centre.
int points_of(const BodyProperties& body) {
  return is_polygon(body) ? static_cast<int>(body.corners.size()) : 1;
}

/// Of a point (m) from the body's core, in the world's frame.
Outside outside_of_body(const World& world, int body, const Vec2& point) {
  const BodyProperties& b = at(world.bodies, body);
  const Vec2 from = point - at(world.position, body);
  if (!is_polygon(b)) {
    const double distance = from.norm();
    return {distance, distance > 0.0 ? Vec2(from / distance) : Vec2(1.0, 0.0)};
  }
  const double angle = at(world.angle, body);
  Outside out = outside_of(b.corners, turned(from, -angle));
  out.normal = turned(out.normal, angle);
  return out;
}

/// Of a point from a wall's line, on the side of the body that the point belongs to.
Outside outside_of_wall(const Wall& wall, const Vec2& centre, const Vec2& point) {
  Vec2 normal = left((wall.b - wall.a).normalized());
  if (normal.dot(centre - wall.a) < 0.0) normal = -normal;
  return {normal.dot(point - wall.a), normal};
}

/// Whether the wall is beside the point, rather than before or behind it.
bool is_beside(const Wall& wall, const Vec2& point) {
  const Vec2 d = wall.b - wall.a;
  const double along = d.dot(point - wall.a);
  return along >= 0.0 && along <= d.squaredNorm();
}

/// Least over the points of `other` of how far they are in front of the body's side that parts the
/// two most.
double separation_by_sides(const World& world, int body, int other) {
  const std::vector<Vec2>& corners = at(world.bodies, body).corners;
  const double angle = at(world.angle, body);
  double most = -infinity;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2& here = corners[i];
    const Vec2& next = corners[(i + 1) % corners.size()];
    const Vec2 out = turned(-left((next - here).normalized()), angle);
    const Vec2 origin = at(world.position, body) + turned(here, angle);
    double least = infinity;
    for (int k = 0; k < points_of(at(world.bodies, other)); ++k) {
      least = std::min(least, out.dot(place_of_point(world, other, k) - origin));
    }
    most = std::max(most, least);
  }
  return most;
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

bool is_end_of_cable(const World& world, const Contact& contact) {
  return contact.b < 0 && at(world.obstacles, contact.wall).cable >= 0;
}

Vec2 place_of_point(const World& world, int body, int point) {
  const BodyProperties& b = at(world.bodies, body);
  const Vec2& centre = at(world.position, body);
  return is_polygon(b) ? Vec2(centre + turned(at(b.corners, point), at(world.angle, body)))
                       : centre;
}

Vec2 nearest_place(const World& world, const Contact& contact, int body) {
  const bool of_a = contact.touch == Touch::point_of_a;
  const int owner = of_a ? contact.a : contact.b;
  Vec2 point = place_of_point(world, owner, contact.point);
  if (body == owner) return point;
  const double way = contact.gap + rim_radius(at(world.bodies, contact.a)) +
                     rim_radius(at(world.bodies, contact.b));
  return point + (of_a ? way : -way) * contact.normal;
}

void measure(const World& world, Contact& contact) {
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
  if (contact.touch != Touch::circles) return meeting_of(world, contact).gap;
  return circles_apart(world, contact).gap;
}

Meeting meeting_of(const World& world, const Contact& contact) {
  const bool of_a = contact.touch == Touch::point_of_a;
  const int owner = of_a ? contact.a : contact.b;                   // of the point
  const int other = contact.touch == Touch::point_of_b ? contact.a  // the outline
                    : of_a                             ? contact.b
                                                       : contact.a;
  Vec2 point;
  double radius = 0.0, other_radius = 0.0;
  Outside out;
  if (contact.touch == Touch::end_of_wall) {
    const Obstacle& obstacle = at(world.obstacles, contact.wall);
    point = contact.point == 0 ? obstacle.a : obstacle.b;
    radius = obstacle.radius;
    out = outside_of_body(world, other, point);
    other_radius = rim_radius(at(world.bodies, other));
  } else {
    point = place_of_point(world, owner, contact.point);
    radius = rim_radius(at(world.bodies, owner));
    if (other < 0) {
      out = outside_of_wall(at(world.obstacles, contact.wall), at(world.position, owner), point);
    } else {
      out = outside_of_body(world, other, point);
      other_radius = rim_radius(at(world.bodies, other));
    }
  }
  Meeting meeting;
  meeting.gap = out.distance - radius - other_radius;
  meeting.normal = of_a ? Vec2(-out.normal) : out.normal;
  meeting.point = point - (radius + 0.5 * meeting.gap) * out.normal;
  return meeting;
}

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
    to.push_back(contact);
  };
  const BodyProperties& body = at(world.bodies, a);
  if (b < 0) {
    const Obstacle& obstacle = at(world.obstacles, wall);
    const bool is_point = obstacle.cable >= 0;
    for (int k = 0; !is_point && k < points_of(body); ++k) {
      if (is_beside(obstacle, place_of_point(world, a, k))) append(Touch::point_of_a, k);
    }
    append(Touch::end_of_wall, 0);
    if (!is_point) append(Touch::end_of_wall, 1);
    return;
  }
  const BodyProperties& other = at(world.bodies, b);
  if (is_polygon(other)) {
    for (int k = 0; k < points_of(body); ++k) append(Touch::point_of_a, k);
  }
  if (!is_polygon(body)) return;
  // Where corner meets corner, one of the two is enough.
  const auto of_a = static_cast<std::ptrdiff_t>(to.size());
  const double same = 1e-9 * (body.radius + other.radius);
  for (int k = 0; k < points_of(other); ++k) {
    const Vec2 point = place_of_point(world, b, k);
    const bool repeats = std::any_of(to.begin() + first, to.begin() + of_a, [&](const Contact& c) {
      return (place_of_point(world, a, c.point) - point).norm() <= same;
    });
    if (!repeats) append(Touch::point_of_b, k);
  }
}

double separation(const World& world, int a, int b) {
  double most = -infinity;
  if (is_polygon(at(world.bodies, a))) most = separation_by_sides(world, a, b);
  if (is_polygon(at(world.bodies, b))) most = std::max(most, separation_by_sides(world, b, a));
  return most - rim_radius(at(world.bodies, a)) - rim_radius(at(world.bodies, b));
}

}  // namespace pinchlab
