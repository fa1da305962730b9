// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Charts with logarithmic axes whose curves are named at their right ends.

#include <string>
#include <vector>

#include "analysis/experiments/experiment.h"

namespace pinchlab::experiments {

struct CurvePoint {
  double x = 0.0;
  Spread y;
};

struct Curve {
  std::string label;  ///< written at the curve's right end
  int style = 1;      ///< line style of figure_preamble
  bool dashed = false;
  bool spread = false;             ///< a band from the first to the ninth decile
  std::vector<CurvePoint> points;  ///< by x; what is not positive is left out
};

struct Panel {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
  double label_room = 8.0;  ///< the x axis goes on by this factor to make room for the labels
};

enum class Scale { own, common };  ///< y axes of the panels

/// Gnuplot commands for panels side by side in a figure of this height.
std::string charts(const std::vector<Panel>& panels, int height_px, Scale scale = Scale::own);

}  // namespace pinchlab::experiments
