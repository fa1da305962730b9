// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/adapting_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "analysis/experiments/step_cost.h"
#include "demos/scenes/shape_scenes.h"
#include "sim/cable/cable.h"
#include "sim/make_world.h"
#include "sim/step.h"

namespace pinchlab::experiments {

namespace {

constexpr double continuum = 0.847213;  // of sqrt(2 L / g): Calkin & March 1989
constexpr int repeats = 3;
constexpr double drawn_for = 5.0;  // s

double pieces_of(const World& world) {
  return static_cast<double>(
      std::count_if(world.cables.begin(), world.cables.end(),
                    [](const CableState& c) { return c.rod && !is_dormant(c); }));
}

Adapting fall(int pieces, double tolerance) {
  constexpr int steps_per_frame = 64;
  const Scene scene = build::folded_chain(pieces, steps_per_frame, tolerance);
  Adapting run{pieces, steps_per_frame, tolerance, 0.0, 0.0, infinity, 0};
  for (int repeat = 0; repeat < repeats; ++repeat) {
    World world = make_world(scene, Method::pinch);
    Workspace work;
    double sum = 0.0;
    const double before = cpu_seconds();
    while (world.step < 2 || world.velocity[0].y() < 0.0) {
      if (step(scene, world, work) != StepStatus::ok) throw std::runtime_error(world.failure);
      if (world.time() > 2.0) throw std::runtime_error("a folded chain does not stop falling");
      sum += pieces_of(world);
    }
    run.cost_s = std::min(run.cost_s, cpu_seconds() - before);
    run.mean = sum / static_cast<double>(world.step);
    run.result = world.time() / std::sqrt(2.0 / scene.gravity.norm());
    run.changes = static_cast<int>(world.diagnostics.node_changes);
  }
  return run;
}

/// Places of the ring, or of the load, at every frame.
using Course = std::vector<Vec2>;

/// Mean distance (m); NaN where one has not come to its end.
double apart(const Course& a, const Course& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).norm();
  return sum / static_cast<double>(a.size());
}

Course draw(int nodes, int steps_per_frame, double tolerance, Adapting& run) {
  const Scene scene = build::drawn_taut(nodes, steps_per_frame, tolerance);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  Course course;
  double sum = 0.0;
  const double before = cpu_seconds();
  const auto steps = std::lround(drawn_for * scene.frames_per_second * steps_per_frame);
  for (long i = 0; i < steps; ++i) {
    if (step(scene, world, work) != StepStatus::ok) break;
    sum += pieces_of(world);
    if ((i + 1) % steps_per_frame == 0) course.push_back(world.position[0]);
  }
  run = {nodes + 1,
         steps_per_frame,
         tolerance,
         sum / static_cast<double>(std::max<std::int64_t>(world.step, 1)),
         0.0,
         cpu_seconds() - before,
         static_cast<int>(world.diagnostics.node_changes)};
  return course;
}

/// Fixed numbers of nodes, and tolerances at the last of them. `off(nodes, steps_per_frame,
/// tolerance, run)` makes a run and tells how far it is off (m).
template <typename Off>
std::vector<Adapting> run_all(const std::vector<int>& numbers,
                              const std::vector<double>& tolerances, Off off) {
  std::vector<Adapting> runs;
  const auto add = [&](int nodes, int steps_per_frame, double tolerance) {
    Adapting run;
    double least = infinity;
    for (int repeat = 0; repeat < repeats; ++repeat) {
      run.result = off(nodes, steps_per_frame, tolerance, run);
      least = std::min(least, run.cost_s);
    }
    run.cost_s = least;
    runs.push_back(run);
  };
  for (const int steps : {4, 16}) {
    for (const int nodes : numbers) add(nodes, steps, 0.0);
    for (const double tolerance : tolerances) add(numbers.back(), steps, tolerance);
  }
  return runs;
}

std::vector<Adapting> draw_all() {
  Adapting first;
  const Course finest = draw(63, 64, 0.0, first);
  return run_all({7, 15, 31, 63}, {1e-3, 2e-3, 5e-3},
                 [&](int nodes, int steps_per_frame, double tolerance, Adapting& run) {
                   return apart(draw(nodes, steps_per_frame, tolerance, run), finest);
                 });
}

double spans_of(const CableState& rope) {
  return static_cast<double>(
      std::ranges::count_if(rope.segments, [](const Segment& span) { return span.length > 0.0; }));
}

Course lift(int nodes, int steps_per_frame, double tolerance, Adapting& run) {
  const Scene scene = build::crane(nodes, steps_per_frame, tolerance);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  Course course;
  double sum = 0.0;
  const double before = cpu_seconds();
  const auto steps = std::lround(drawn_for * scene.frames_per_second * steps_per_frame);
  for (long i = 0; i < steps; ++i) {
    if (step(scene, world, work) != StepStatus::ok) break;
    sum += spans_of(world.cables[0]);
    if ((i + 1) % steps_per_frame == 0) course.push_back(world.position[0]);
  }
  run = {nodes + 1,
         steps_per_frame,
         tolerance,
         sum / static_cast<double>(std::max<std::int64_t>(world.step, 1)),
         0.0,
         cpu_seconds() - before,
         static_cast<int>(world.diagnostics.node_changes)};
  return course;
}

std::vector<Adapting> lift_all() {
  Adapting first;
  const Course finest = lift(159, 32, 0.0, first);
  return run_all({10, 20, 40, 80}, {5e-4, 1e-3, 2e-3, 4e-3},
                 [&](int nodes, int steps_per_frame, double tolerance, Adapting& run) {
                   return apart(lift(nodes, steps_per_frame, tolerance, run), finest);
                 });
}

std::string tolerance_text(const Adapting& run) {
  return run.tolerance > 0.0 ? fmt::format("{:g}", 1e3 * run.tolerance) : "";
}

std::string table_of(const std::vector<Adapting>& runs, const std::string& result,
                     std::string (*text)(double)) {
  std::vector<std::vector<std::string>> rows;
  for (const Adapting& run : runs) {
    const bool ended = std::isfinite(run.result);
    rows.push_back(
        {fmt::format("{}", run.pieces), fmt::format("{}", run.steps_per_frame), tolerance_text(run),
         ended ? fmt::format("{:.1f}", run.mean) : "", fmt::format("{}", run.changes),
         ended ? text(run.result) : "a step is not finite", ended ? time_text(run.cost_s) : ""});
  }
  return markdown_table({"pieces at most", "steps a frame", "tolerance, mm", "pieces in a step",
                         "changes", result, "cost"},
                        rows);
}

void add_runs(const std::string& name, const std::string& result, const std::vector<Adapting>& runs,
              Csv& csv) {
  for (const Adapting& run : runs) {
    const std::string full = fmt::format("{}, {} steps a frame, tolerance {} m", name,
                                         run.steps_per_frame, run.tolerance);
    const std::int64_t size = run.pieces;
    csv.row({full, size, result, run.result});
    csv.row({full, size, std::string("mean_pieces"), run.mean});
    csv.row({full, size, std::string("cost_s"), run.cost_s});
  }
}

}  // namespace

AdaptingNodes measure_adapting_nodes() {
  AdaptingNodes nodes;
  for (const int pieces : {8, 16, 32, 64, 128}) nodes.falls.push_back(fall(pieces, 0.0));
  for (const double tolerance : {1e-3, 2e-3}) nodes.falls.push_back(fall(64, tolerance));
  for (const double tolerance : {2.5e-4, 5e-4, 1e-3}) nodes.falls.push_back(fall(128, tolerance));
  nodes.drawn = draw_all();
  nodes.lifted = lift_all();
  return nodes;
}

void add_rows(const AdaptingNodes& nodes, Csv& csv) {
  add_runs("adapting folded chain", "fall_time", nodes.falls, csv);
  add_runs("cable drawn taut", "mean_distance_m", nodes.drawn, csv);
  add_runs("crane", "mean_distance_m", nodes.lifted, csv);
}

std::string adapting_text(const AdaptingNodes& nodes) {
  const auto in_mm = [](double off) { return fmt::format("{:.2f}", 1e3 * off); };
  return fmt::format(
      "## Nodes that come and go\n\nError against time, of fixed numbers of nodes and such that "
      "adapt (`node_tolerance_m`).\n\nThe folded chain's fall:\n\n{}\n"
      "A cable of 1.25 m hangs from a post; a winch draws its other end taut, to 2 kN, and lets it "
      "down, in 5 s: how far that end is off the same of 64 pieces at 64 steps a frame, in the "
      "mean.\n\n{}\n"
      "A winch sets a load of 50 kg on the floor by a rope of 0.8 kg/m over a sheave, pays out "
      "0.5 m more, so that the rope hangs, and lifts the load again, in 5 s: how far the load is "
      "off the same with 159 nodes at 32 steps a frame, in the mean. Beside rims and ends pieces "
      "stay the finest; the motor's jerks leave waves on the rope, which keep nodes.\n\n{}\n",
      table_of(nodes.falls, "time, of sqrt(2 L / g)",
               [](double time) {
                 return fmt::format("{:.5f} ({:+.2f} %)", time, 100.0 * (time / continuum - 1.0));
               }),
      table_of(nodes.drawn, "off, mm", in_mm), table_of(nodes.lifted, "off, mm", in_mm));
}

}  // namespace pinchlab::experiments
