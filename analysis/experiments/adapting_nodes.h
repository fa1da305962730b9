// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "analysis/experiments/experiment.h"

namespace pinchlab::experiments {

/// A motion of a cable of nodes, all of them always or as many as it needs.
struct Adapting {
  int pieces = 0;  ///< at most
  int steps_per_frame = 0;
  double tolerance = 0.0;  ///< m; 0: all of them always
  double mean = 0.0;       ///< pieces in a step
  double result =
      0.0;  ///< a fall's time, of sqrt(2 L / g); or metres off the finest; NaN: not finite
  double cost_s = 0.0;  ///< of processor time, the least of three runs
  int changes = 0;      ///< two pieces that become one, or one two
};

/// Error against time, of fixed numbers of nodes and such that adapt (demos/scenes/shape_scenes.h).
struct AdaptingNodes {
  std::vector<Adapting> falls;   ///< of a folded chain
  std::vector<Adapting> drawn;   ///< a cable that is drawn taut and let down
  std::vector<Adapting> lifted;  ///< a crane's load
};

AdaptingNodes measure_adapting_nodes();

void add_rows(const AdaptingNodes& nodes, Csv& csv);

/// Sections of the page.
std::string adapting_text(const AdaptingNodes& nodes);

}  // namespace pinchlab::experiments
