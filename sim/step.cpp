// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step.h"

#include <algorithm>
#include <chrono>

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
  if (s.mobility.empty() || s.mobility_kick != k) {
    set_mobilities(scene, k, s.mobility);
    s.mobility_kick = k;
    s.velocity_free.assign(scene.bodies.size(), Vec2::Zero());
    s.angular_velocity_free.assign(scene.bodies.size(), 0.0);
  }
  if (world.configuration.diagnostics) {
    s.velocity_before = world.velocity;
    s.angular_velocity_before = world.angular_velocity;
  }
  for (const Part& part : s.parts.list) {
    if (part.asleep) continue;
    for (const int number : bodies_of(s.parts, part)) {
      const auto b = static_cast<std::size_t>(number);
      const Body& body = scene.bodies[b];
      const double linear = 0.5 * k * body.linear_drag, angular = 0.5 * k * body.angular_drag;
      if (can_move(body)) {
        Vec2 pull = k * scene.gravity;
        if (body.kind == BodyKind::rail) pull = body.rail_axis * body.rail_axis.dot(pull);
        s.velocity_free[b] = ((1.0 - linear) * world.velocity[b] + pull) / (1.0 + linear);
      }
      double& omega = s.angular_velocity_free[b];
      omega = body.driven_angular_velocity.value_or(world.angular_velocity[b]);
      if (body.driven_angular_velocity || (angular == 0.0 && body.torque == 0.0)) continue;
      omega = ((1.0 - angular) * omega + k * body.torque / disc_inertia(body)) / (1.0 + angular);
    }
  }
}

/// Positions, and the material that slides over bodies, with the velocities just found.
void move_bodies(World& world) {
  const double h = world.step_length;
  const Parts& parts = world.scratch.parts;
  for (const Part& part : parts.list) {
    if (part.asleep) continue;
    for (const int number : bodies_of(parts, part)) {
      const auto b = static_cast<std::size_t>(number);
      world.position[b] += h * world.velocity[b];
      world.angle[b] += h * world.angular_velocity[b];
    }
    if (!part.slides) continue;
    for (const int c : cables_of(parts, part)) {
      for (Link& link : world.cables[static_cast<std::size_t>(c)].links) {
        link.material -= h * link.slip_speed;
      }
    }
  }
}

bool all_asleep(const World& world) {
  const auto& parts = world.scratch.parts.list;
  return std::all_of(parts.begin(), parts.end(), [](const Part& part) { return part.asleep; });
}

void solve(const Scene& scene, World& world, int part, double kick) {
  switch (world.configuration.solver) {
    case Solver::direct:
      return solve_direct(scene, world, part, kick);
    case Solver::iterative:
      return solve_iterative(scene, world, part, kick);
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

/// Velocities that meet all constraints, part by part.
void solve_parts(const Scene& scene, World& world, Stopwatch& watch) {
  world.diagnostics.active_set_solves = 0;
  Parts& parts = world.scratch.parts;
  for (int p = 0; p < static_cast<int>(parts.list.size()); ++p) {
    Part& part = parts.list[static_cast<std::size_t>(p)];
    if (part.asleep) continue;
    make_segment_rows(scene, world, part, kick_length(world));
    watch.lap(Stage::init_segments);
    make_contact_rows(scene, world, part);
    watch.lap(Stage::init_contacts);
    solve(scene, world, p, kick_length(world));
    part.slides =
        !world.scratch.active_set.capstan.runs.empty() || part.contacts_begin != part.contacts_end;
    note_rest(scene, world, part);
    watch.lap(Stage::solve);
  }
  world.diagnostics.total_solves += world.diagnostics.active_set_solves;
}

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
  find_parts(scene, world);
  assign_contacts(world);
  watch.lap(Stage::configure_pinches);
}

StepStatus step(const Scene& scene, World& world, StageTimes* times) {
  if (all_asleep(world)) {
    ++world.step;
    return StepStatus::ok;
  }
  Stopwatch watch(times);
  apply_forces(scene, world);
  watch.lap(Stage::apply_forces);
  solve_parts(scene, world, watch);
  if (!check_finite(scene, world)) return StepStatus::not_finite;
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
  Stopwatch untimed(nullptr);
  solve_parts(scene, next, untimed);
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
