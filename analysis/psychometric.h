// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Fits psychometric functions to answers.

#include <cstdint>
#include <vector>

#include "analysis/estimate.h"
#include "analysis/psychometric_model.h"

namespace pinchlab::analysis {

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
