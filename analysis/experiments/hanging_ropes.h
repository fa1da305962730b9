// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "analysis/experiments/experiment.h"

namespace pinchlab::experiments {

/// A run of a hoist whose heavy rope sags between its pulleys (build::sagging_hoist).
struct HangingRope {
  int nodes = 0;        ///< none: the rope is straight
  bool chosen = false;  ///< by the program
  int steps_per_frame = 0;
  double error_m = 0.0;      ///< of the light weight's place at the end
  double energy_lost = 0.0;  ///< as a share of the kinetic energy at the end
  double intervals = 0.0;    ///< in a step
  int changes = 0;           ///< nodes taken in by rims and given off
  double cost_s = 0.0;       ///< of processor time, the least of three runs
};

std::vector<HangingRope> measure_hanging_ropes();

void add_rows(const std::vector<HangingRope>& ropes, Csv& csv);

/// Section of the page.
std::string hanging_ropes_text(const std::vector<HangingRope>& ropes);

}  // namespace pinchlab::experiments
