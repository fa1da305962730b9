// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Simulated threshold studies of a known truth: is it recovered, and do the intervals hold it as
// often as they say?

#include <vector>

#include "analysis/gsl_support.h"
#include "analysis/psychometric.h"

namespace pinchlab::analysis {

/// A design and its truth, on levels from -1 to 1 (Weibull: exp of them).
struct ThresholdCondition {
  Shape shape = Shape::logistic;
  int participants = 1;  ///< >= 1
  int levels = 7;        ///< >= 3, evenly spaced
  int trials = 40;       ///< of each participant at each level
  Curve truth{0.0, 1.2, 0.5, 0.02};
  double spread = 0.0;  ///< of the participants' thresholds
};

/// One study: participants in order, hits drawn from psi.
std::vector<Observer> simulate_thresholds(const ThresholdCondition& condition, gsl_rng* rng);

/// What `studies` studies say of the truth.
struct Recovery {
  double bias = 0.0;              ///< mean threshold minus truth, on the axis of t
  double error = 0.0;             ///< root mean square of that
  double slope_bias = 0.0;        ///< mean of ln slope minus ln truth, where there is a slope
  double mean_spread = 0.0;       ///< mean estimate of the spread
  double threshold_coverage = 0;  ///< share of profile intervals that hold the true threshold
  double slope_coverage = 0;      ///< and the true slope; an interval open on one side reaches on
  double bootstrap_coverage = 0;  ///< percentile intervals of the threshold; 0 without resamples
  double misfit = 0;              ///< share of studies whose test of fit rejects at alpha
  int without_slope = 0;          ///< studies in which the function may as well jump
  int not_estimable = 0;          ///< studies without a threshold, left out of the rest
};

/// Study k draws from the generator of (seed, k); the same on any number of cores.
Recovery recovery(const ThresholdCondition& condition, int studies,
                  const PsychometricOptions& options);

}  // namespace pinchlab::analysis
