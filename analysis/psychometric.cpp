// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/psychometric.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <thread>

#include "analysis/gsl_support.h"
#include "analysis/psychometric_search.h"

namespace pinchlab::analysis {

namespace {

// Deviance of the totals at each level from the curve of the population.
double level_deviance(const Likelihood& likelihood, const std::vector<Points>& observers,
                      const Curve& curve, double spread) {
  std::map<double, Point> totals;
  for (const Points& points : observers) {
    for (const Point& point : points) {
      Point& sum = totals.try_emplace(point.t, Point{point.t, 0.0, 0.0}).first->second;
      sum.trials += point.trials;
      sum.hits += point.hits;
    }
  }
  double deviance = 0.0;
  for (const auto& [t, sum] : totals) {
    const double p = likelihood.population_share(curve, spread, t);
    const double misses = sum.trials - sum.hits;
    if (sum.hits > 0.0) deviance += 2.0 * sum.hits * std::log(sum.hits / (sum.trials * p));
    if (misses > 0.0) deviance += 2.0 * misses * std::log(misses / (sum.trials * (1.0 - p)));
  }
  return deviance;
}

// Whether hits, by the line of least squares, fall with the level.
bool falls(const std::vector<Points>& observers) {
  double trials = 0.0, hits = 0.0, t = 0.0, both = 0.0;
  for (const Points& points : observers) {
    for (const Point& point : points) {
      trials += point.trials;
      hits += point.hits;
      t += point.trials * point.t;
      both += point.hits * point.t;
    }
  }
  return both * trials < hits * t;
}

// A study as the fit would have it.
std::vector<Points> simulate(const Likelihood& likelihood, const std::vector<Points>& design,
                             const Curve& curve, double spread, gsl_rng* rng) {
  std::vector<Points> study = design;
  for (Points& points : study) {
    const double shift = spread > 0.0 ? gsl_ran_gaussian(rng, spread) : 0.0;
    for (Point& point : points) {
      const double p = likelihood.psi(curve, point.t - shift);
      point.hits = gsl_ran_binomial(rng, p, static_cast<unsigned>(point.trials));
    }
  }
  return study;
}

struct Resample {
  double threshold = 0.0, width = 0.0, deviance = 0.0;
};

// Studies simulated from the fit and fitted again; number k draws from the generator of (seed, k)
// and lands in place k, whichever thread makes it.
std::vector<Resample> resample(const PsychometricModel& model, const std::vector<Points>& design,
                               bool random_effects, const Search::Result& best, const Curve& curve,
                               double spread, const PsychometricOptions& options) {
  const Likelihood likelihood(model);
  std::vector<Resample> all(static_cast<size_t>(options.resamples));
  std::atomic<size_t> next{0};
  const auto work = [&] {
    for (size_t k = next++; k < all.size(); k = next++) {
      const Rng rng = make_rng(RandomUse::bootstrap, options.seed, k);
      const std::vector<Points> study = simulate(likelihood, design, curve, spread, rng.get());
      Search search(model, study, random_effects);
      const Search::Result fit = search.minimise(best.x, -1);
      const Curve found = search.curve_of(fit.x);
      all[k] = {found.threshold, found.width,
                level_deviance(likelihood, study, found, search.spread_of(fit.x))};
    }
  };
  std::vector<std::jthread> threads;
  for (unsigned i = 1; !all.empty() && i < std::thread::hardware_concurrency(); ++i)
    threads.emplace_back(work);
  work();
  threads.clear();
  return all;
}

// The interval that leaves alpha / 2 of the values out on either side.
std::pair<double, double> percentiles(std::vector<double> values, double alpha) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  const auto k = static_cast<size_t>(std::floor((n + 1.0) * alpha / 2.0));
  const size_t rank = std::max<size_t>(1, k);
  return {values[rank - 1], values[values.size() - rank]};
}

PsychometricFit not_estimable(const std::string& reason) {
  PsychometricFit fit;
  const Estimate none = Estimate::none(reason);
  for (Estimate* value :
       {&fit.threshold, &fit.threshold_low, &fit.threshold_high, &fit.slope, &fit.slope_low,
        &fit.slope_high, &fit.width, &fit.guess, &fit.lapse, &fit.spread,
        &fit.bootstrap_threshold_low, &fit.bootstrap_threshold_high, &fit.bootstrap_slope_low,
        &fit.bootstrap_slope_high, &fit.deviance, &fit.p_deviance}) {
    *value = none;
  }
  return fit;
}

std::string why_not(const std::vector<Points>& observers) {
  std::map<double, bool> levels;
  double trials = 0.0, hits = 0.0;
  for (const Points& points : observers) {
    for (const Point& point : points) {
      levels[point.t] = true;
      trials += point.trials;
      hits += point.hits;
    }
  }
  if (levels.size() < 3) return "fewer than three levels";
  if (hits == 0.0 || hits == trials) return "every answer is the same";
  return "";
}

// The rise of minus the log-likelihood that bounds an interval: half a quantile of chi-square, df
// 1; with N participants whose thresholds are normal, N/2 ln(1 + t^2 / (N - 1)) with Student's t,
// which is exact for the mean of N normal values.
double rise_of(double alpha, size_t participants, bool random_effects) {
  if (!random_effects) return 0.5 * gsl_cdf_chisq_Qinv(alpha, 1.0);
  const auto n = static_cast<double>(participants);
  const double t = gsl_cdf_tdist_Qinv(alpha / 2.0, n - 1.0);
  return 0.5 * n * std::log1p(t * t / (n - 1.0));
}

// Fills in the intervals by profile likelihood.
void add_profiles(PsychometricFit& fit, Search& search, const Search::Result& best,
                  const PsychometricModel& model, const Axis& axis, double rise) {
  const auto threshold = [&](double direction) {
    const auto bound = profile_bound(search, best, 0, direction, 0.15, 5.0 * direction, rise);
    return bound ? Estimate(axis.level(*bound))
                 : Estimate::none("the answers do not bound the threshold on this side");
  };
  fit.threshold_low = threshold(-1.0);
  fit.threshold_high = threshold(1.0);
  // A wide function has a small slope.
  const auto slope = [&](double direction) {
    const auto bound = profile_bound(search, best, 1, direction, 0.4, 8.0 * direction, rise);
    return bound && !search.steep(*bound) && !Search::flat(*bound)
               ? Estimate(slope_of(model, axis.half * std::exp(*bound)))
               : Estimate::none("the answers do not bound the slope on this side");
  };
  fit.slope_low = slope(1.0);
  fit.slope_high = slope(-1.0);
}

void add_resamples(PsychometricFit& fit, const std::vector<Resample>& all,
                   const PsychometricModel& model, const Axis& axis, double alpha) {
  fit.resamples = static_cast<int>(all.size());
  if (all.empty()) {
    const Estimate none = Estimate::none("no resamples were asked for");
    fit.bootstrap_threshold_low = fit.bootstrap_threshold_high = none;
    fit.bootstrap_slope_low = fit.bootstrap_slope_high = fit.p_deviance = none;
    return;
  }
  std::vector<double> thresholds, slopes;
  int worse = 0;
  for (const Resample& one : all) {
    thresholds.push_back(axis.level(one.threshold));
    slopes.push_back(slope_of(model, axis.half * one.width));
    worse += one.deviance >= fit.deviance.value ? 1 : 0;
  }
  const auto [low, high] = percentiles(thresholds, alpha);
  fit.bootstrap_threshold_low = low;
  fit.bootstrap_threshold_high = high;
  const auto [slope_low, slope_high] = percentiles(slopes, alpha);
  fit.bootstrap_slope_low = slope_low;
  fit.bootstrap_slope_high = slope_high;
  fit.p_deviance = (1.0 + worse) / (1.0 + static_cast<double>(all.size()));
}

}  // namespace

double psi(const PsychometricModel& model, const Curve& curve, double level) {
  return Likelihood(model).psi(curve, axis_of(model.shape, level));
}

double slope_of(const PsychometricModel& model, double width) {
  return standard_width(model.shape) / width;
}

double population_psi(const PsychometricModel& model, const Curve& curve, double spread,
                      double level) {
  return Likelihood(model).population_share(curve, spread, axis_of(model.shape, level));
}

double psychometric_deviance(const PsychometricModel& model, const std::vector<Observer>& observers,
                             const Curve& curve, double spread) {
  const Likelihood likelihood(model);
  double sum = 0.0;
  for (const Observer& observer : observers) {
    Points points;
    for (const LevelCell& cell : observer.cells) {
      points.push_back({axis_of(model.shape, cell.level), static_cast<double>(cell.trials),
                        static_cast<double>(cell.hits)});
    }
    double mode = 0.0;
    sum += likelihood.integrated(points, curve, spread, mode);
  }
  return 2.0 * sum;
}

PsychometricFit fit_psychometric(const PsychometricModel& model,
                                 const std::vector<Observer>& observers,
                                 const PsychometricOptions& options) {
  const GslErrorsOff guard;
  const Axis axis(model.shape, observers);
  const std::vector<Points> points = points_of(axis, observers);
  const std::string reason = why_not(points);
  if (!reason.empty()) return not_estimable(reason);
  const bool random_effects = observers.size() > 1;
  Search search(model, points, random_effects);
  const Search::Result best = search.best();
  if (Search::flat(best.x[1]) || std::abs(best.x[0]) > 5.0)
    return not_estimable(falls(points) ? "the share of hits falls with the level, where it must "
                                         "rise; number the levels the other way round"
                                       : "the share of hits does not rise with the level");
  const Curve curve = search.curve_of(best.x);
  double spread = search.spread_of(best.x);
  if (spread < 1e-3 * curve.width) spread = 0.0;
  PsychometricFit fit;
  fit.curve = {axis.middle + axis.half * curve.threshold, axis.half * curve.width, curve.guess,
               curve.lapse};
  fit.threshold = axis.level(curve.threshold);
  fit.guess = curve.guess;
  fit.lapse = curve.lapse;
  fit.spread =
      random_effects ? Estimate(axis.half * spread) : Estimate::none("one participant, or totals");
  if (random_effects) {
    search.value(best.x);  // leaves the participants' modes at the best fit
    for (double mode : search.modes())
      fit.participant_thresholds.push_back(axis.level(curve.threshold + spread * mode));
  }
  add_profiles(fit, search, best, model, axis,
               rise_of(options.alpha, observers.size(), random_effects));
  fit.width = fit.curve.width;
  fit.slope = slope_of(model, fit.curve.width);
  const bool is_steep = search.steep(best.x[1]);
  const bool jumps = is_steep || search.rises_to_steep(best);
  if (jumps) {
    fit.width = fit.slope = Estimate::none(fmt::format(
        "the share of hits {} from one level to the next; levels between them would tell",
        is_steep ? "jumps" : "may as well jump"));
  }
  fit.deviance = level_deviance(Likelihood(model), points, curve, spread);
  add_resamples(fit, resample(model, points, random_effects, best, curve, spread, options), model,
                axis, options.alpha);
  // Studies simulated from one of many curves that fit as well do not tell of the others.
  if (jumps) fit.bootstrap_slope_low = fit.bootstrap_slope_high = fit.slope;
  if (jumps && spread == 0.0)
    fit.bootstrap_threshold_low = fit.bootstrap_threshold_high = fit.slope;
  return fit;
}

}  // namespace pinchlab::analysis
