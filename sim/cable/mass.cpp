// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/mass.h"

#include <Eigen/LU>
#include <algorithm>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/links.h"
#include "sim/compound.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

using Eigen::Vector3d;

/// Velocity of a place of a body (m/s).
Vec2 at_place(const Vector3d& velocity, const Vec2& z) {
  return velocity.head<2>() + velocity.z() * z;
}

/// What a force on a place of a body is to it (N, N, N m).
Vector3d on_body(const Vec2& force, const Vec2& z) {
  return {force.x(), force.y(), z.dot(force)};
}

int mover_or_world(const World& world, const Link& link) {
  return link.body >= 0 ? mover_of(world, link.body) : static_cast<int>(world.bodies.size());
}

/// Of the link's circle, from the centre of what it moves with (m).
Vec2 centre_of(const World& world, const Link& link) {
  if (link.body < 0) return link.offset;
  return link_centre(world, link) - at(world.position, mover_of(world, link.body));
}

MassedSpan span_of(const World& world, const CableState& cable, std::size_t i) {
  const Link& from = at(cable.links, previous_link(cable, static_cast<int>(i)));
  const Link& to = cable.links[i];
  const Segment& segment = cable.segments[i];
  MassedSpan span;
  span.a = mover_or_world(world, from);
  span.b = mover_or_world(world, to);
  span.p_a = from.signed_radius();
  span.p_b = to.signed_radius();
  span.centre_a = centre_of(world, from);
  span.centre_b = centre_of(world, to);
  span.direction = segment.direction;
  span.z_a = left(span.centre_a) + span.p_a * span.direction;
  span.z_b = left(span.centre_b) + span.p_b * span.direction;
  span.pinched = segment.pinched;
  span.distance = segment.pinched ? span.p_b - span.p_a : segment.length;
  span.material = std::max(segment.rest_length, 0.0);
  span.density = cable.density;
  return span;
}

/// On the circle z = left(c) + p e, with e turning from where the cable comes to where it goes.
MassedArc arc_of(const World& world, const CableState& cable, std::size_t i) {
  const Link& link = cable.links[i];
  const std::size_t leaving = (i + 1) % cable.links.size();
  const Vec2 turn = left(cable.segments[i].direction) - left(cable.segments[leaving].direction);
  MassedArc arc;
  arc.body = mover_or_world(world, link);
  arc.centre = centre_of(world, link);
  arc.mass = cable.density * link.radius * std::max(link.wrap, 0.0);
  const Vec2 about = cable.density * link.radius * link.radius * turn;  // the circle's own centre
  const Vec2 c = left(arc.centre);
  arc.first = arc.mass * c + about;
  arc.second = arc.mass * (c.squaredNorm() + link.radius * link.radius) + 2.0 * c.dot(about);
  return arc;
}

/// kg, of either end.
double end_mass(const MassedSpan& span) {
  return 0.5 * span.density * span.material;
}

/// rad/s of a span's direction.
double turning_of(const MassedSpan& span, const Vector3d& v_a, const Vector3d& v_b) {
  if (span.a == span.b) return v_a.z();
  if (span.distance == 0.0) return 0.0;
  const Vec2 d = at_place(v_b, left(span.centre_b)) - at_place(v_a, left(span.centre_a));
  const Vec2 across = span.pinched ? Vec2(-span.direction) : left(span.direction);
  return across.dot(d) / span.distance;
}

void add(Eigen::Matrix3d& to, double mass, const Vec2& first, double second) {
  to(0, 0) += mass;
  to(1, 1) += mass;
  to.topRightCorner<2, 1>() += first;
  to.bottomLeftCorner<1, 2>() += first.transpose();
  to(2, 2) += second;
}

void add(std::span<Eigen::Matrix3d> to, const MassedSpan& span) {
  const double mass = end_mass(span);
  add(at(to, span.a), mass, mass * span.z_a, mass * span.z_a.squaredNorm());
  add(at(to, span.b), mass, mass * span.z_b, mass * span.z_b.squaredNorm());
}

void add(std::span<Eigen::Matrix3d> to, const MassedArc& arc) {
  add(at(to, arc.body), arc.mass, arc.first, arc.second);
}

void add_flow_forces(const MassedSpan& span, std::span<const Vector3d> v, std::span<Vector3d> to) {
  const Vector3d &v_a = at(v, span.a), &v_b = at(v, span.b);
  Vector3d &f_a = at(to, span.a), &f_b = at(to, span.b);
  const Vec2 u_a = at_place(v_a, span.z_a), u_b = at_place(v_b, span.z_b);
  const Vec2 n = left(span.direction);
  const double rho = span.density, turning = turning_of(span, v_a, v_b);
  const double mass = end_mass(span);
  const double growth =
      0.5 * rho * (span.p_a * (v_a.z() - turning) - span.p_b * (v_b.z() - turning));      // kg/s
  const double e_a = 0.5 * rho * u_a.squaredNorm(), e_b = 0.5 * rho * u_b.squaredNorm();  // J/m

  // A point mass whose place on the body moves, and what rims gain by the span's turning.
  const auto end = [&](const Vector3d& velocity, const Vec2& u, const Vec2& z, const Vec2& centre,
                       double p, double gains, Vector3d& force) {
    const Vec2 shift = -velocity.z() * centre + p * turning * n;  // dz/dt
    force -= on_body((growth + gains) * u, z) + mass * velocity.z() * on_body(shift, z);
    force.z() -= mass * p * turning * n.dot(u);
  };
  end(v_a, u_a, span.z_a, span.centre_a, span.p_a, rho * span.p_a * turning, f_a);
  end(v_b, u_b, span.z_b, span.centre_b, span.p_b, -rho * span.p_b * turning, f_b);

  // By the flow of material, whose kinetic energy is the mean of the ends'.
  const double mean = 0.5 * (e_a + e_b);
  f_a.z() += mean * span.p_a;
  f_b.z() -= mean * span.p_b;
  // By the direction: the flow to and from rims, and the ends' own places.
  const double about = mean * (span.p_b - span.p_a) + e_a * span.p_a - e_b * span.p_b +
                       mass * (span.p_a * v_a.z() * n.dot(u_a) + span.p_b * v_b.z() * n.dot(u_b));
  if (span.a == span.b) {
    f_a.z() += about;
  } else if (!span.pinched && span.distance > 0.0) {  // in a pinch both sides flow alike
    const Vec2 force = about / span.distance * n;
    f_b += on_body(force, left(span.centre_b));
    f_a -= on_body(force, left(span.centre_a));
  }
}

/// Changes the body's velocity as if a mass with velocity u had joined it at z, where its own mass, `carried`
/// with it, already has that mass.
void take_up(World& world, int body, const Eigen::Matrix3d& carried, double mass, const Vec2& z,
             const Vec2& u) {
  const BodyProperties& properties = at(world.bodies, body);
  Eigen::Matrix3d all = carried;
  add(all, properties.mass, Vec2::Zero(), inertia_of(properties));
  Vec2& v = at(world.velocity, body);
  double& omega = at(world.angular_velocity, body);
  const Vec2 own = v + omega * z;
  const Vector3d change = inverse_for(properties, all) * on_body(mass * (u - own), z);
  v += change.head<2>();
  omega += change.z();
}

Vec2 velocity_at(const World& world, int body, const Vec2& z) {
  if (index(body) == world.bodies.size()) return Vec2::Zero();
  return at(world.velocity, body) + at(world.angular_velocity, body) * z;
}

}  // namespace

void add_masses(const World& world, const CableState& cable, CableMasses& to) {
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    if (i >= first_segment(cable)) to.spans.push_back(span_of(world, cable, i));
    if (cable.links[i].orientation != 0) to.arcs.push_back(arc_of(world, cable, i));
  }
}

void add_carried(const CableMasses& masses, std::span<Eigen::Matrix3d> to) {
  for (const MassedSpan& span : masses.spans) add(to, span);
  for (const MassedArc& arc : masses.arcs) add(to, arc);
}

void find_carried(const World& world, std::vector<Eigen::Matrix3d>& carried) {
  carried.clear();
  for (const CableState& cable : world.cables) {
    if (!is_massed(cable)) continue;
    carried.resize(world.bodies.size() + 1, Eigen::Matrix3d::Zero());
    for (std::size_t i = 0; i < cable.links.size(); ++i) {
      if (i >= first_segment(cable)) add(carried, span_of(world, cable, i));
      if (cable.links[i].orientation != 0) add(carried, arc_of(world, cable, i));
    }
  }
}

void find_flow_forces(const CableMasses& masses, std::span<const Vector3d> velocities,
                      std::span<Vector3d> to) {
  std::fill(to.begin(), to.end(), Vector3d::Zero());
  for (const MassedSpan& span : masses.spans) add_flow_forces(span, velocities, to);
  for (const MassedArc& arc : masses.arcs) {  // it turns about a circle that turns about the body
    const double square = at(velocities, arc.body).z() * at(velocities, arc.body).z();
    at(to, arc.body) += square * Vector3d(arc.mass * arc.centre.x(), arc.mass * arc.centre.y(),
                                          arc.centre.dot(arc.first));
  }
}

double potential_energy(const World& world, const CableState& cable, const Vec2& gravity) {
  double energy = 0.0;
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    const Segment& span = cable.segments[i];
    if (i >= first_segment(cable)) {
      const double mass = 0.5 * cable.density * std::max(span.rest_length, 0.0);
      energy -= mass * gravity.dot(span.tail + span.head);
    }
    if (cable.links[i].orientation == 0) continue;
    const MassedArc arc = arc_of(world, cable, i);  // z = left(x)
    energy -= gravity.dot(arc.mass * at(world.position, arc.body) - left(arc.first));
  }
  return energy;
}

Eigen::Matrix3d inverse_for(const BodyProperties& body, const Eigen::Matrix3d& matrix) {
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> ways(3, 0);
  const auto add_way = [&ways](const Vector3d& way) {
    ways.conservativeResize(3, ways.cols() + 1);
    ways.rightCols<1>() = way;
  };
  if (body.kind == BodyKind::free) {
    add_way(Vector3d::UnitX());
    add_way(Vector3d::UnitY());
  } else if (body.kind == BodyKind::rail) {
    const Vec2 along = body.rail_axis.normalized();
    add_way({along.x(), along.y(), 0.0});
  }
  if (body.kind != BodyKind::fixed && !body.driven_angular_velocity) add_way(Vector3d::UnitZ());
  if (ways.cols() == 0) return Eigen::Matrix3d::Zero();
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> there =
      ways.transpose() * matrix * ways;
  return ways * there.inverse() * ways.transpose();
}

void meet_body(World& world, CableState& cable, std::size_t segment, int body, int corner,
               int orientation) {
  if (!is_massed(cable)) {
    insert_link(world, cable, segment, body, corner, orientation);
    return;
  }
  const MassedSpan before = span_of(world, cable, segment);
  const Vec2 u_a = velocity_at(world, before.a, before.z_a);
  const Vec2 u_b = velocity_at(world, before.b, before.z_b);
  const std::size_t position = segment == 0 ? cable.links.size() : segment;
  insert_link(world, cable, segment, body, corner, orientation);
  const int mover = mover_of(world, body);
  if (!is_mobile(at(world.bodies, mover))) return;
  const MassedSpan first = span_of(world, cable, position);
  const MassedSpan second = span_of(world, cable, segment == 0 ? 0 : position + 1);
  const double both = first.material + second.material;
  if (!(both > 0.0)) return;
  // Each neighbour has given up its share of the part that it is no longer at.
  const Vec2 u = (second.material * u_a + first.material * u_b) / both;
  std::vector<Eigen::Matrix3d> carried;
  find_carried(world, carried);
  take_up(world, mover, at(carried, mover), 0.5 * cable.density * both, first.z_b, u);
}

void leave_body(World& world, CableState& cable, int link) {
  if (!is_massed(cable)) {
    remove_link(world, cable, link);
    return;
  }
  const MassedSpan first = span_of(world, cable, index(link));
  const MassedSpan second = span_of(world, cable, index(next_link(cable, link)));
  const Vec2 u = velocity_at(world, first.b, first.z_b);
  remove_link(world, cable, link);
  std::vector<Eigen::Matrix3d> carried;
  find_carried(world, carried);
  const auto give = [&](int to, const Vec2& z, double material) {
    if (index(to) == world.bodies.size() || !is_mobile(at(world.bodies, to))) return;
    take_up(world, to, at(carried, to), 0.5 * cable.density * material, z, u);
  };
  give(first.a, first.z_a, second.material);
  give(second.b, second.z_b, first.material);
}

}  // namespace pinchlab
