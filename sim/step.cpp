// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step.h"

#include <algorithm>
#include <chrono>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/detect/pinch.h"
#include "sim/detect/span_hits.h"
#include "sim/diagnostics.h"
#include "sim/solve/active_set.h"
#include "sim/solve/light_bodies.h"
#include "sim/solve/rows.h"
#include "sim/solve/solution.h"
#include "sim/thesis/all_pairs.h"
#include "sim/thesis/gauss_seidel.h"

namespace pinchlab {

namespace {

/// Velocity kick of forces alone. Positions are at the step's start, velocities half a step before;
/// the first kick, from velocities at time 0, is half as long. That makes semi-implicit Euler a
/// leapfrog.
double kick_length(const World& world) {
  return world.step == 0 ? 0.5 * world.step_length : world.step_length;
}

/// What of a part's bodies lasts from step to step.
void make_system(const World& world, std::span<const int> bodies, double kick, PartSystem& s) {
  s.mobility_changed = true;
  s.mobility_kick = kick;
  s.mobility.clear();
  s.mobile.clear();
  s.span_masses.clear();
  for (const int b : bodies) {
    s.mobility.push_back(mobility_of(at(world.bodies, b), kick));
    s.mobile.push_back(is_mobile(at(world.bodies, b)));
  }
  s.mobility.emplace_back();  // nothing moves the world
  s.mobile.push_back(false);
  s.free_velocity.assign(s.mobility.size(), Eigen::Vector3d::Zero());
}

/// The body with what its motor's table says for this step: the angular velocity of the motion that
/// follows, or the torque of the kick, each the mean over its time. Both are exact integrals.
BodyProperties driven_now(const Body& body, const World& world, BodyProperties now) {
  const double t = world.time(), h = world.step_length, k = kick_length(world);
  if (now.driven_angular_velocity) {
    now.driven_angular_velocity = mean_drive(body.motor, t, t + h);
  } else {
    now.torque = mean_drive(body.motor, t + 0.5 * h - k, t + 0.5 * h);
  }
  return now;
}

/// A body whose motor's table goes on is not at rest.
void keep_motors_awake(const Scene& scene, std::span<const int> bodies, World& world) {
  for (const int b : bodies) {
    const std::vector<MotorPoint>& motor = at(scene.bodies, b).motor;
    if (!motor.empty() && world.time() <= motor.back().time) at(world.still_steps, b) = 0;
  }
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
    omega = ((1.0 - angular) * omega + k * body.torque / disc_inertia(body)) / (1.0 + angular);
  }
  return {free.x(), free.y(), omega};
}

/// Free velocities of all bodies that are awake, in their parts' systems.
void apply_forces(const Scene& scene, const World& world, Workspace& work) {
  const double k = kick_length(world);
  for (const Part& part : work.parts.list) {
    if (part.asleep) continue;
    PartSystem& s = at(work.systems, part.system);
    const std::span<const int> bodies = bodies_of(work.parts, part);
    s.mobility_changed = false;
    if (s.mobility.empty() || s.mobility_kick != k) make_system(world, bodies, k, s);
    s.extent = 0.0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const auto b = index(bodies[i]);
      const Body& given = scene.bodies[b];
      const Vec2& v = world.velocity[b];
      const double omega = world.angular_velocity[b];
      s.free_velocity[i] =
          given.motor.empty()
              ? free_velocity(scene, world.bodies[b], v, omega, k)
              : free_velocity(scene, driven_now(given, world, world.bodies[b]), v, omega, k);
      s.extent = std::max(s.extent, world.position[b].cwiseAbs().maxCoeff());
    }
    for (const int c : cables_of(work.parts, part)) {
      const CableState& cable = at(world.cables, c);
      const auto segments = static_cast<double>(cable.segments.size());
      s.extent = std::max(s.extent, cable.length * std::max(1.0, 0.1 * segments));
    }
  }
}

/// Positions, and the material that slides over bodies, with the velocities just found.
void move_bodies(const Parts& parts, World& world) {
  const double h = world.step_length;
  for (const Part& part : parts.list) {
    if (part.asleep) continue;
    for (const int number : bodies_of(parts, part)) {
      const auto b = index(number);
      world.position[b] += h * world.velocity[b];
      world.angle[b] += h * world.angular_velocity[b];
    }
    if (!part.slides) continue;
    for (const int c : cables_of(parts, part)) {
      for (Link& link : at(world.cables, c).links) link.material -= h * link.slip_speed;
    }
  }
}

bool all_asleep(const Parts& parts) {
  return std::all_of(parts.list.begin(), parts.list.end(),
                     [](const Part& part) { return part.asleep; });
}

class Stopwatch {
 public:
  explicit Stopwatch(StageTimes* times) : times_(times) {
    if (times_) last_ = Clock::now();
  }
  void lap(Stage stage) {
    if (!times_) return;
    const auto now = Clock::now();
    times_->seconds[static_cast<std::size_t>(stage)] +=
        std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  StageTimes* times_;
  Clock::time_point last_;
};

/// Velocities of a part's bodies that meet all of its constraints, in its system; whether the
/// states settled.
bool solve_part(const Scene& scene, const World& world, Workspace& work, const Part& part,
                Stopwatch& watch) {
  PartSystem& s = at(work.systems, part.system);
  const double kick = kick_length(world);
  work.solve.step_length = world.step_length;
  steady_light_bodies(world, work.parts, part, kick, s);
  make_segment_rows(scene, world, work.parts, part, kick, s);
  watch.lap(Stage::init_segments);
  make_contact_rows(scene, world, work.parts, part, s, work.solve);
  watch.lap(Stage::init_contacts);
  if (world.configuration.solver == Solver::direct) {
    return solve_direct(world, work.parts, part, s, work.solve);
  }
  solve_iterative(world, work.parts, part, s, work.solve, work.sweeps);
  return true;
}

void solve_parts(const Scene& scene, World& world, Workspace& work, Stopwatch& watch) {
  Diagnostics& d = world.diagnostics;
  d.active_set_solves = 0;
  for (Part& part : work.parts.list) {
    if (part.asleep) continue;
    if (!solve_part(scene, world, work, part, watch)) ++d.fallbacks;
    const PartSystem& s = at(work.systems, part.system);
    store_solution(work.parts, part, at(work.systems, part.system), work.solve.capstan,
                   kick_length(world), world);
    if (world.configuration.solver == Solver::iterative && !s.rows.empty()) {
      store_middles(s, work.solve, work.sweeps, world);
    }
    part.slides = !work.solve.capstan.runs.empty() || part.contacts_begin != part.contacts_end;
    d.active_set_solves = std::max(d.active_set_solves, work.solve.solves);
    note_rest(work.parts, part, world);
    keep_motors_awake(scene, bodies_of(work.parts, part), world);
    watch.lap(Stage::solve);
  }
  d.total_solves += d.active_set_solves;
}

void note_velocities(const World& world, Workspace& work) {
  work.velocity_before = world.velocity;
  work.angular_velocity_before = world.angular_velocity;
}

}  // namespace

void detect(const Scene& scene, World& world, Workspace& work, StageTimes* times) {
  Stopwatch watch(times);
  update_segments(world, work);
  watch.lap(Stage::update_segments);
  remove_links(world, work);
  watch.lap(Stage::remove_links);
  const bool sweep = world.configuration.detection == Detection::sweep;
  (sweep ? find_body_pairs : find_all_body_pairs)(scene, world, work);
  watch.lap(Stage::broad_phase);
  (sweep ? find_span_pairs : find_all_span_pairs)(world, work);
  add_hit_links(world, work);
  watch.lap(Stage::intersect_segments);
  find_contacts(scene, world, work);
  watch.lap(Stage::find_contacts);
  configure_pinches(world, work);
  find_parts(world, work);
  assign_contacts(world, work);
  watch.lap(Stage::configure_pinches);
}

StepStatus step(const Scene& scene, World& world, Workspace& work, StageTimes* times) {
  fit(world, work);
  if (all_asleep(work.parts)) {
    ++world.step;
    mark(world, work);
    return StepStatus::ok;
  }
  Stopwatch watch(times);
  if (world.configuration.diagnostics) note_velocities(world, work);
  apply_forces(scene, world, work);
  watch.lap(Stage::apply_forces);
  solve_parts(scene, world, work, watch);
  if (!check_finite(scene, world)) return StepStatus::not_finite;
  if (world.configuration.diagnostics) measure_energy(scene, world, work);
  watch.lap(Stage::diagnose);
  move_bodies(work.parts, world);
  ++world.step;
  watch.lap(Stage::move_bodies);
  detect(scene, world, work, times);
  watch = Stopwatch(times);
  if (world.configuration.diagnostics) measure_cables(scene, world);
  mark(world, work);
  watch.lap(Stage::diagnose);
  return StepStatus::ok;
}

Velocities velocities_now(const Scene& scene, const World& world, Workspace& work) {
  Velocities now{world.velocity, world.angular_velocity};
  if (world.step == 0) return now;
  fit(world, work);
  Stopwatch untimed(nullptr);
  apply_forces(scene, world, work);
  for (const Part& part : work.parts.list) {
    if (part.asleep) continue;
    solve_part(scene, world, work, part, untimed);
    const PartSystem& s = at(work.systems, part.system);
    const std::span<const int> bodies = bodies_of(work.parts, part);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      Vec2& linear = at(now.linear, bodies[i]);
      double& angular = at(now.angular, bodies[i]);
      linear = 0.5 * (linear + s.velocity[i].head<2>());
      angular = 0.5 * (angular + s.velocity[i].z());
    }
  }
  return now;
}

const char* to_string(Stage stage) {
  constexpr const char* names[] = {"apply_forces",  "init_segments",     "init_contacts",
                                   "solve",         "move_bodies",       "update_segments",
                                   "remove_links",  "broad_phase",       "intersect_segments",
                                   "find_contacts", "configure_pinches", "diagnose"};
  static_assert(std::size(names) == static_cast<std::size_t>(Stage::count));
  return names[static_cast<std::size_t>(stage)];
}

}  // namespace pinchlab
