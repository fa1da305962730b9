// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/forces.h"

#include <algorithm>

#include "base/at.h"
#include "sim/solve/motors.h"
#include "sim/solve/rows.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// Whether the body only turns, at what angular velocity rows leave it.
bool coasts(const Body& given, const BodyProperties& body) {
  return body.kind == BodyKind::fixed_axle && !body.driven_angular_velocity &&
         given.motor.empty() && body.angular_drag == 0.0 && body.torque == 0.0;
}

/// What of a part's bodies lasts from step to step.
void make_system(const Scene& scene, const World& world, std::span<const int> bodies, double kick,
                 PartSystem& s) {
  s.mobility_changed = true;
  s.mobility_kick = kick;
  s.mobility.clear();
  s.mobile.clear();
  s.span_masses.clear();
  s.coasts.clear();
  s.extent_of_coasting = 0.0;
  for (const int b : bodies) {
    const BodyProperties& body = at(world.bodies, b);
    s.mobility.push_back(mobility_of(body, kick));
    s.mobile.push_back(is_mobile(body));
    s.coasts.push_back(coasts(at(scene.bodies, b), body));
    if (!s.coasts.back()) continue;
    s.extent_of_coasting =
        std::max(s.extent_of_coasting, at(world.position, b).cwiseAbs().maxCoeff());
  }
  s.mobility.emplace_back();  // nothing moves the world
  s.mobile.push_back(false);
  s.free_velocity.assign(s.mobility.size(), Eigen::Vector3d::Zero());
}

/// Velocity of a body after a kick of k seconds by forces alone.
///
/// dv/dt = f/m - c v with the drag on the mean of old and new: (1 + c k/2) v' = (1 - c k/2) v + k
/// f/m.
Eigen::Vector3d free_velocity(const Scene& scene, const BodyProperties& body, const Vec2& v,
                              double omega, double k) {
  const double linear = 0.5 * k * body.linear_drag, angular = 0.5 * k * body.angular_drag;
  Vec2 free = Vec2::Zero();
  if (can_move(body)) {
    Vec2 pull = k * scene.gravity;
    if (body.kind == BodyKind::rail) pull = body.rail_axis * body.rail_axis.dot(pull);
    free = ((1.0 - linear) * v + pull) / (1.0 + linear);
  }
  if (body.driven_angular_velocity) {
    omega = *body.driven_angular_velocity;
  } else if (angular != 0.0 || body.torque != 0.0) {
    omega = ((1.0 - angular) * omega + k * body.torque / inertia_of(body)) / (1.0 + angular);
  }
  return {free.x(), free.y(), omega};
}

/// The body with what its motor's table says for the interval: the angular velocity of the motion
/// that follows, or the torque of the kick, each the mean over its time. Both are exact integrals.
BodyProperties driven_now(const Body& body, const TimeSpan& t, BodyProperties now) {
  constexpr double instant = 1e-9;  // s: an instant's mean is the value at its time
  if (now.driven_angular_velocity) {
    const double length = t.length > 0.0 ? t.length : instant;
    now.driven_angular_velocity = mean_drive(body.motor, t.start, t.start + length);
  } else if (t.kick > 0.0) {
    now.torque = mean_drive(body.motor, t.start - t.lag, t.start - t.lag + t.kick);
  }
  return now;
}

}  // namespace

void apply_forces(const Scene& scene, const World& world, const TimeSpan& t, Workspace& work) {
  const double k = t.kick;
  for (const Part& part : work.parts.list) {
    if (part.asleep) continue;
    PartSystem& s = at(work.systems, part.system);
    const std::span<const int> bodies = bodies_of(work.parts, part);
    s.mobility_changed = false;
    if (s.mobility.empty() || s.mobility_kick != k) make_system(scene, world, bodies, k, s);
    s.extent = s.extent_of_coasting;
    s.motors.clear();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const auto b = index(bodies[i]);
      if (s.coasts[i]) {
        s.free_velocity[i] = {0.0, 0.0, world.angular_velocity[b]};
        continue;
      }
      const Body& given = scene.bodies[b];
      const Vec2& v = world.velocity[b];
      const double omega = world.angular_velocity[b];
      s.free_velocity[i] =
          given.motor.empty()
              ? free_velocity(scene, world.bodies[b], v, omega, k)
              : free_velocity(scene, driven_now(given, t, world.bodies[b]), v, omega, k);
      s.extent = std::max(s.extent, world.position[b].cwiseAbs().maxCoeff());
      if (world.bodies[b].driven_angular_velocity) {
        add_motor(world.bodies[b], static_cast<int>(i), s.free_velocity[i].z(), omega, k, s);
      }
    }
    drive(s);
    for (const int c : cables_of(work.parts, part)) {
      const CableState& cable = at(world.cables, c);
      const auto segments = static_cast<double>(cable.segments.size());
      s.extent = std::max(s.extent, cable.length * std::max(1.0, 0.1 * segments));
    }
    s.reach = within_reach * s.extent;
  }
}

}  // namespace pinchlab
