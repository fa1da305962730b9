// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Psychometric functions: how the share of hits (correct answers, or choices of the method under
// test) rises with the level of a graded stimulus,
//   psi(x) = guess + (1 - guess - lapse) G(g + s (t(x) - t(threshold)) / width),
// with G(threshold's argument) = threshold_at, G logistic, normal or Weibull's (t = ln, otherwise
// t(x) = x), and width the distance from G = 0.05 to G = 0.95 on the axis of t.

#include <cstdint>
#include <string>
#include <vector>

#include "base/rates.h"

namespace pinchlab::analysis {

enum class Shape : std::uint8_t { logistic, normal, weibull };

/// How a rate of guesses or lapses is treated.
struct Rate {
  bool free = false;   ///< estimated within [0, most]
  double value = 0.0;  ///< if it is not free
  double most = most_free_lapse;
};

struct PsychometricModel {
  Shape shape = Shape::logistic;
  Rate guess{false, 0.5, most_free_guess};
  Rate lapse{true, 0.0, most_free_lapse};
  double threshold_at = 0.5;  ///< value of G at the threshold, in (0, 1)
};

/// Answers at one level.
struct LevelCell {
  double level = 0.0;       ///< > 0 for Weibull's function
  std::int64_t trials = 0;  ///< > 0
  std::int64_t hits = 0;    ///< 0 .. trials
};

/// One participant; levels increase.
struct Observer {
  std::string name;
  std::vector<LevelCell> cells;
};

struct Curve {
  double threshold = 0.0;  ///< on the axis of t: ln(level) for Weibull's function
  double width = 1.0;      ///< > 0, on the axis of t
  double guess = 0.0;
  double lapse = 0.0;
};

}  // namespace pinchlab::analysis
