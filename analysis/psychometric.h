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

#include "analysis/estimate.h"

namespace pinchlab::analysis {

enum class Shape : std::uint8_t { logistic, normal, weibull };

/// How a rate of guesses or lapses is treated.
struct Rate {
  bool free = false;   ///< estimated within [0, most]
  double value = 0.0;  ///< if it is not free
  double most = 0.1;
};

struct PsychometricModel {
  Shape shape = Shape::logistic;
  Rate guess{false, 0.5, 0.5};
  Rate lapse{true, 0.0, 0.1};  ///< 0.1: who misses more often than that is not watching
  double threshold_at = 0.5;   ///< value of G at the threshold, in (0, 1)
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

/// psi(level).
double psi(const PsychometricModel& model, const Curve& curve, double level);

/// The slope parameter s / width: the logistic function's beta, 1 / sigma of the normal one,
/// Weibull's exponent.
double slope_of(const PsychometricModel& model, double width);

struct PsychometricFit {
  Estimate threshold, threshold_low, threshold_high;  ///< a level; profile-likelihood interval
  Estimate slope, slope_low, slope_high;              ///< s / width; profile-likelihood interval
  Estimate width;                                     ///< from G = 0.05 to 0.95 on the axis of t
  Estimate guess, lapse;
  Estimate spread;  ///< standard deviation of the participants' thresholds on the axis of t
  Estimate bootstrap_threshold_low, bootstrap_threshold_high;  ///< parametric, percentiles
  Estimate bootstrap_slope_low, bootstrap_slope_high;
  Estimate deviance;    ///< of the levels' totals against the curve of the population
  Estimate p_deviance;  ///< share of simulated studies from the fit that fit worse
  int resamples = 0;    ///< simulated studies that the last six come from
  Curve curve;          ///< of the average participant
  std::vector<double> participant_thresholds;  ///< levels, conditional modes; empty without spread
};

struct PsychometricOptions {
  double alpha = 0.05;
  int resamples = 399;  ///< 0: no bootstrap and no test of fit
  std::uint64_t seed = 1;
};

/// Fits one function to all observers by maximum likelihood. With two observers or more each has an
/// own threshold, normally distributed on the axis of t (adaptive Gauss-Hermite quadrature). The
/// same input gives the same numbers on any number of cores.
PsychometricFit fit_psychometric(const PsychometricModel& model,
                                 const std::vector<Observer>& observers,
                                 const PsychometricOptions& options);

/// Share of hits in the population at a level: psi averaged over the participants' thresholds.
double population_psi(const PsychometricModel& model, const Curve& curve, double spread,
                      double level);

/// Minus the log-likelihood of observers (binomial coefficients left out). Exposed for tests.
double psychometric_deviance(const PsychometricModel& model, const std::vector<Observer>& observers,
                             const Curve& curve, double spread);

}  // namespace pinchlab::analysis
