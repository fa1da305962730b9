// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/threshold_study.h"

#include <gsl/gsl_randist.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pinchlab::analysis {

std::vector<Observer> simulate_thresholds(const ThresholdCondition& condition, gsl_rng* rng) {
  PsychometricModel model;
  model.shape = condition.shape;
  std::vector<Observer> observers;
  for (int i = 0; i < condition.participants; ++i) {
    Observer observer{std::to_string(i + 1), {}};
    Curve curve = condition.truth;
    if (condition.spread > 0.0) curve.threshold += gsl_ran_gaussian(rng, condition.spread);
    for (int j = 0; j < condition.levels; ++j) {
      const double t = -1.0 + 2.0 * j / (condition.levels - 1);
      const double level = condition.shape == Shape::weibull ? std::exp(t) : t;
      const unsigned hits =
          gsl_ran_binomial(rng, psi(model, curve, level), static_cast<unsigned>(condition.trials));
      observer.cells.push_back({level, condition.trials, hits});
    }
    observers.push_back(std::move(observer));
  }
  return observers;
}

Recovery recovery(const ThresholdCondition& condition, int studies,
                  const PsychometricOptions& options) {
  PsychometricModel model;
  model.shape = condition.shape;
  model.guess.value = condition.truth.guess;
  const double truth = condition.truth.threshold;
  const double true_slope = slope_of(model, condition.truth.width);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto axis = [&](const Estimate& level, double otherwise) {
    if (!level) return otherwise;
    return condition.shape == Shape::weibull ? std::log(level.value) : level.value;
  };
  const auto holds = [](double low, double value, double high) {
    return low <= value && value <= high ? 1.0 : 0.0;
  };
  Recovery sum;
  for (int study = 0; study < studies; ++study) {
    const Rng rng = make_rng(RandomUse::study, options.seed, static_cast<std::uint64_t>(study));
    const PsychometricFit fit =
        fit_psychometric(model, simulate_thresholds(condition, rng.get()), options);
    if (!fit.threshold) {
      ++sum.not_estimable;
      continue;
    }
    const double off = axis(fit.threshold, 0.0) - truth;
    sum.bias += off;
    sum.error += off * off;
    sum.without_slope += fit.slope ? 0 : 1;
    sum.slope_bias += fit.slope ? std::log(fit.slope.value / true_slope) : 0.0;
    sum.mean_spread += fit.spread ? fit.spread.value : 0.0;
    sum.threshold_coverage +=
        holds(axis(fit.threshold_low, -infinity), truth, axis(fit.threshold_high, infinity));
    sum.slope_coverage += holds(fit.slope_low ? fit.slope_low.value : 0.0, true_slope,
                                fit.slope_high ? fit.slope_high.value : infinity);
    if (fit.p_deviance) {
      sum.bootstrap_coverage += holds(axis(fit.bootstrap_threshold_low, -infinity), truth,
                                      axis(fit.bootstrap_threshold_high, infinity));
      sum.misfit += fit.p_deviance.value <= options.alpha ? 1.0 : 0.0;
    }
  }
  const int estimable = studies - sum.not_estimable;
  for (double* value : {&sum.bias, &sum.error, &sum.mean_spread, &sum.threshold_coverage,
                        &sum.slope_coverage, &sum.bootstrap_coverage, &sum.misfit}) {
    *value /= std::max(1, estimable);
  }
  sum.slope_bias /= std::max(1, estimable - sum.without_slope);
  sum.error = std::sqrt(sum.error);
  return sum;
}

}  // namespace pinchlab::analysis
