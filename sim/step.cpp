// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step.h"

#include <chrono>
#include <cmath>

#include "sim/active_set.h"
#include "sim/all_pairs.h"
#include "sim/cable.h"
#include "sim/diagnostics.h"
#include "sim/gauss_seidel.h"
#include "sim/pinch.h"
#include "sim/span_hits.h"

namespace pinchlab {

namespace {

/// Velocity kick of forces alone. Positions are at the step's start, velocities half a step before;
/// the first kick, from velocities at time 0, is half as long. That makes semi-implicit Euler a
/// leapfrog.
double kick_length(const World& world) {
  return world.step == 0 ? 0.5 * world.step_length : world.step_length;
}

// dv/dt = f/m - c v with the drag on the mean of old and new: (1 + c k/2) v' = (1 - c k/2) v + k
// f/m.
void apply_forces(const Scene& scene, World& world) {
  const double k = kick_length(world);
  Scratch& s = world.scratch;
  set_mobilities(scene, k, s.mobility);
  s.velocity_before = world.velocity;
  s.angular_velocity_before = world.angular_velocity;
  s.velocity_free.resize(scene.bodies.size());
  s.angular_velocity_free.resize(scene.bodies.size());
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    const double linear = 0.5 * k * body.linear_drag, angular = 0.5 * k * body.angular_drag;
    Vec2 v = Vec2::Zero();
    double omega = 0.0;
    if (body.kind == BodyKind::free || body.kind == BodyKind::rail) {
      Vec2 pull = k * scene.gravity;
      if (body.kind == BodyKind::rail) pull = body.rail_axis * body.rail_axis.dot(pull);
      v = ((1.0 - linear) * world.velocity[b] + pull) / (1.0 + linear);
    }
    if (body.driven_angular_velocity) {
      omega = *body.driven_angular_velocity;
    } else if (body.kind != BodyKind::fixed) {
      omega = ((1.0 - angular) * world.angular_velocity[b] + k * body.torque / disc_inertia(body)) /
              (1.0 + angular);
    }
    s.velocity_free[b] = v;
    s.angular_velocity_free[b] = omega;
  }
}

/// Positions, and the material that slides over bodies, with the velocities just found.
void move_bodies(World& world) {
  const double h = world.step_length;
  for (std::size_t b = 0; b < world.position.size(); ++b) {
    world.position[b] += h * world.velocity[b];
    world.angle[b] += h * world.angular_velocity[b];
  }
  if (world.scratch.active_set.capstan.runs.empty() && world.contacts.empty()) return;
  for (CableState& cable : world.cables) {
    for (Link& link : cable.links) link.material -= h * link.slip_speed;
  }
}

/// Below this nothing moves (m/s, and rad/s times radius): far above round-off, and a nanometre a
/// second.
constexpr double rest_speed = 1e-9;
/// After this long (s) at rest a scene stays at rest: all its forces are constant.
constexpr double rest_time = 0.5;

bool is_resting(const World& world) {
  return static_cast<double>(world.resting_steps) * world.step_length >= rest_time;
}

void note_rest(const Scene& scene, World& world) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (world.velocity[b].cwiseAbs().maxCoeff() > rest_speed ||
        std::abs(world.angular_velocity[b]) * scene.bodies[b].radius > rest_speed) {
      world.resting_steps = 0;
      return;
    }
  }
  ++world.resting_steps;
}

void solve(const Scene& scene, World& world, double kick) {
  switch (world.configuration.solver) {
    case Solver::direct:
      return solve_direct(scene, world, kick);
    case Solver::iterative:
      return solve_iterative(scene, world, kick);
  }
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

}  // namespace

void detect(const Scene& scene, World& world, StageTimes* times) {
  Stopwatch watch(times);
  update_segments(world);
  watch.lap(Stage::update_segments);
  remove_links(world);
  watch.lap(Stage::remove_links);
  const bool sweep = world.configuration.detection == Detection::sweep;
  (sweep ? find_body_pairs : find_all_body_pairs)(scene, world);
  watch.lap(Stage::broad_phase);
  (sweep ? find_span_pairs : find_all_span_pairs)(scene, world);
  add_hit_links(scene, world);
  watch.lap(Stage::intersect_segments);
  find_contacts(scene, world);
  watch.lap(Stage::find_contacts);
  configure_pinches(scene, world);
  watch.lap(Stage::configure_pinches);
}

StepStatus step(const Scene& scene, World& world, StageTimes* times) {
  if (is_resting(world)) {
    ++world.step;
    return StepStatus::ok;
  }
  Stopwatch watch(times);
  apply_forces(scene, world);
  watch.lap(Stage::apply_forces);
  world.scratch.rows.clear();
  make_segment_rows(scene, world, kick_length(world));
  watch.lap(Stage::init_segments);
  make_contact_rows(scene, world);
  watch.lap(Stage::init_contacts);
  solve(scene, world, kick_length(world));
  watch.lap(Stage::solve);
  if (!check_finite(scene, world)) return StepStatus::not_finite;
  note_rest(scene, world);
  if (world.configuration.diagnostics) measure_energy(scene, world);
  watch.lap(Stage::diagnose);
  move_bodies(world);
  ++world.step;
  watch.lap(Stage::move_bodies);
  detect(scene, world, times);
  watch = Stopwatch(times);
  if (world.configuration.diagnostics) measure_cables(scene, world);
  watch.lap(Stage::diagnose);
  return StepStatus::ok;
}

Velocities velocities_now(const Scene& scene, const World& world) {
  if (world.step == 0) return {world.velocity, world.angular_velocity};
  World next = world;
  apply_forces(scene, next);
  next.scratch.rows.clear();
  make_segment_rows(scene, next, kick_length(next));
  make_contact_rows(scene, next);
  solve(scene, next, kick_length(next));
  Velocities now{world.velocity, world.angular_velocity};
  for (std::size_t b = 0; b < now.linear.size(); ++b) {
    now.linear[b] = 0.5 * (world.velocity[b] + next.velocity[b]);
    now.angular[b] = 0.5 * (world.angular_velocity[b] + next.angular_velocity[b]);
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
