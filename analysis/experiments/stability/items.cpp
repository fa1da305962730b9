// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/stability/items.h"

#include <cmath>

namespace pinchlab::experiments::stability {

std::vector<Item> stability_items(bool quick) {
  return {mass_ratio(quick),  frames_and_steps(quick),
          pulleys(quick),     caught_loads(quick),
          jerks(quick),       windings(quick),
          stacks(quick),      cables_under_a_pinch(quick),
          closed_loop(quick), friction(quick),
          chatter(quick),     fast_bodies(quick),
          impacts(quick),     thin_cables(quick),
          corners(quick),     heavy_ropes(quick),
          folding(quick),     refinement(quick),
          long_swing(quick),  plain_joints_under_pinch(quick)};
}

std::vector<double> decades(double from, double to, int per_decade) {
  std::vector<double> values;
  const int count = static_cast<int>(std::lround((to - from) * per_decade));
  for (int i = 0; i <= count; ++i) {
    values.push_back(std::pow(10.0, from + static_cast<double>(i) / per_decade));
  }
  return values;
}

double energy_at_play(const Scene& scene, double height_m) {
  double energy = 0.0;
  for (const Body& body : scene.bodies) {
    if (body.kind != BodyKind::free && body.kind != BodyKind::rail) continue;
    energy += body.mass * (scene.gravity.norm() * height_m + 0.5 * body.velocity.squaredNorm());
  }
  return energy;
}

}  // namespace pinchlab::experiments::stability
