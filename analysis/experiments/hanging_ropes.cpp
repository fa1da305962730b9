// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/hanging_ropes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/experiments/step_cost.h"
#include "demos/scenes/shape_scenes.h"
#include "sim/diagnostics.h"
#include "sim/make_world.h"
#include "sim/step.h"

namespace pinchlab::experiments {

namespace {

constexpr int frames = 90, repeats = 3;
constexpr int finest = 190;  // nodes: pieces must be longer than the cable is wide

struct Outcome {
  HangingRope run;
  double height = 0.0;  // m, of the light weight at the end
};

Outcome hoist(int nodes, int steps_per_frame) {
  const Scene scene = build::sagging_hoist(nodes, steps_per_frame);
  Configuration configuration = Method::pinch;
  configuration.diagnostics = true;
  Outcome outcome;
  outcome.run.nodes = std::max(scene.cables[0].nodes, 0);
  outcome.run.chosen = nodes == automatic_nodes;
  outcome.run.steps_per_frame = steps_per_frame;
  outcome.run.cost_s = infinity;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    World world = make_world(scene, configuration);
    Workspace work;
    double start = 0.0;
    const double before = cpu_seconds();
    for (int i = 0; i < frames * steps_per_frame; ++i) {
      if (step(scene, world, work) != StepStatus::ok) throw std::runtime_error(world.failure);
      if (i == 0) start = world.diagnostics.energy;
    }
    outcome.run.cost_s = std::min(outcome.run.cost_s, cpu_seconds() - before);
    const Diagnostics& d = world.diagnostics;
    outcome.height = world.position[0].y();
    outcome.run.energy_lost = (start - d.energy) / kinetic_energy(world);
    outcome.run.intervals = static_cast<double>(d.intervals) / static_cast<double>(world.step);
    outcome.run.changes = static_cast<int>(d.node_changes);
  }
  return outcome;
}

}  // namespace

std::vector<HangingRope> measure_hanging_ropes() {
  const double exact = hoist(finest, 4).height;
  std::vector<HangingRope> ropes;
  for (const auto& [nodes, steps] : {std::pair(0, 4),
                                     {10, 4},
                                     {20, 4},
                                     {40, 1},
                                     {40, 4},
                                     {40, 16},
                                     {80, 4},
                                     {automatic_nodes, 1},
                                     {automatic_nodes, 4},
                                     {automatic_nodes, 16}}) {
    Outcome outcome = hoist(nodes, steps);
    outcome.run.error_m = std::abs(outcome.height - exact);
    ropes.push_back(outcome.run);
  }
  return ropes;
}

void add_rows(const std::vector<HangingRope>& ropes, Csv& csv) {
  for (const HangingRope& r : ropes) {
    const std::string name = fmt::format("hoist with a rope that sags, {} a frame{}",
                                         r.steps_per_frame, r.chosen ? ", nodes chosen" : "");
    const std::int64_t n = r.nodes;
    csv.row({name, n, std::string("error_m"), r.error_m});
    csv.row({name, n, std::string("energy_lost"), r.energy_lost});
    csv.row({name, n, std::string("cost_s"), r.cost_s});
  }
}

std::string hanging_ropes_text(const std::vector<HangingRope>& ropes) {
  std::vector<std::vector<std::string>> rows;
  rows.reserve(ropes.size());
  for (const HangingRope& r : ropes) {
    rows.push_back(
        {r.nodes == 0 ? "straight" : fmt::format("{}{}", r.nodes, r.chosen ? " (chosen)" : ""),
         fmt::format("{}", r.steps_per_frame), fmt::format("{:.1e}", r.error_m),
         fmt::format("{:.1e}", r.energy_lost), fmt::format("{}", r.changes),
         fmt::format("{:.1f}", r.intervals), time_text(r.cost_s / (frames / 60.0))});
  }
  return fmt::format(
      "## A rope that hangs between pulleys\n\nWeights of 6 and 7 kg on a rope of 1.5 kg/m over "
      "two pulleys 4 m apart, from rest: how far the light one is from where it is with {} nodes, "
      "after {} s, and what energy is lost at rims, which take nodes in and give them off, as a "
      "share of the kinetic energy. *Chosen* are as many nodes as the steps can follow.\n\n{}\n",
      finest, frames / 60.0,
      markdown_table({"nodes", "steps a frame", "error, m", "energy lost", "changes",
                      "intervals in a step", "a second costs"},
                     rows));
}

}  // namespace pinchlab::experiments
