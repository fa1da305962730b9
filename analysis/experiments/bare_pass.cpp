// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/bare_pass.h"

#include <algorithm>

#include "sim/tangent.h"

namespace pinchlab::experiments {

BarePass::BarePass(const Scene& scene, const World& world) : step_length(world.step_length) {
  const CableState& cable = world.cables.front();
  compliance = 1.0 / (scene.cables.front().axial_stiffness * step_length * step_length);
  for (const Link& link : cable.links) {
    Body body{link.offset, Vec2::Zero(), 0.0, 0.0, 0.0, link.signed_radius()};
    if (link.body >= 0) {
      const auto b = static_cast<std::size_t>(link.body);
      const pinchlab::Body& given = scene.bodies[b];
      body.position = world.position[b];
      body.velocity = world.velocity[b];
      body.angular_velocity = world.angular_velocity[b];
      body.inverse_inertia = 1.0 / inertia_of(given);
      if (given.kind == BodyKind::free) body.inverse_mass = 1.0 / given.mass;
    }
    bodies.push_back(body);
  }
  for (std::size_t s = 1; s < cable.segments.size(); ++s) {
    rows.push_back({Vec2::Zero(), 0.0, cable.segments[s].rest_length, 0.0, 0.0, 0.0});
  }
}

// A segment's row is J = -dC/d(velocities), with C = L - l and
//   dC/dt = e.(v_B - v_A) + p_B om_B - p_A om_A
//   (J M^-1 J^T + compliance / a) impulse = C / (a h) + (1 - b/a) dC/dt
// where e is the segment's direction and p a body's signed radius. Neighbours share one body. a = 1
// and b = 0 without elasticity, else those of the simulator's rule (sim/solve/rows.cpp).
void BarePass::step() {
  const std::size_t count = rows.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Body &a = bodies[i], &b = bodies[i + 1];
    Row& row = rows[i];
    const Tangent tangent =
        common_tangent(a.position, a.signed_radius, b.position, b.signed_radius);
    row.direction = tangent.direction;
    row.length = tangent.length;
    row.diagonal = a.inverse_mass + a.inverse_inertia * a.signed_radius * a.signed_radius +
                   b.inverse_mass + b.inverse_inertia * b.signed_radius * b.signed_radius;
    double error = (row.length - row.rest_length) / step_length;
    double rate = row.direction.dot(b.velocity - a.velocity) +
                  b.signed_radius * b.angular_velocity - a.signed_radius * a.angular_velocity;
    if (compliance > 0.0) {
      const double own = compliance * row.rest_length;  // 1/kg
      const double damped = std::max(0.0, 1.0 - 4.0 * own / row.diagonal);
      const double before = 0.25 * (1.0 - damped), after = before + damped;
      row.diagonal += own / after;
      error /= after;
      rate *= 1.0 - before / after;
    }
    row.impulse = error + rate;
    if (i == 0) continue;
    Row& before = rows[i - 1];
    before.upper = -(a.inverse_mass * before.direction.dot(row.direction) +
                     a.inverse_inertia * a.signed_radius * a.signed_radius);
    const double factor = before.upper / before.diagonal;
    row.diagonal -= factor * before.upper;
    row.impulse -= factor * before.impulse;
  }
  for (std::size_t i = count; i-- > 0;) {
    Row& row = rows[i];
    if (i + 1 < count) row.impulse -= row.upper * rows[i + 1].impulse;
    row.impulse /= row.diagonal;
    Body &a = bodies[i], &b = bodies[i + 1];
    a.velocity += row.impulse * a.inverse_mass * row.direction;
    a.angular_velocity += row.impulse * a.inverse_inertia * a.signed_radius;
    b.velocity -= row.impulse * b.inverse_mass * row.direction;
    b.angular_velocity -= row.impulse * b.inverse_inertia * b.signed_radius;
  }
}

}  // namespace pinchlab::experiments
