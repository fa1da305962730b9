// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/psychometric.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_multimin.h>
#include <gsl/gsl_randist.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <thread>

#include "analysis/gsl_support.h"

namespace pinchlab::analysis {

namespace {

// The standard function G, its derivative and its inverse.
double standard(Shape shape, double z) {
  switch (shape) {
    case Shape::logistic:
      return z >= 0.0 ? 1.0 / (1.0 + std::exp(-z)) : std::exp(z) / (1.0 + std::exp(z));
    case Shape::normal:
      return 0.5 * std::erfc(-z * M_SQRT1_2);
    case Shape::weibull:
      return -std::expm1(-std::exp(z));
  }
  return 0.0;
}

double standard_density(Shape shape, double z) {
  switch (shape) {
    case Shape::logistic: {
      const double e = std::exp(-std::abs(z));
      return e / ((1.0 + e) * (1.0 + e));
    }
    case Shape::normal:
      return std::exp(-0.5 * z * z) / std::sqrt(2.0 * M_PI);
    case Shape::weibull:
      return std::exp(z - std::exp(z));
  }
  return 0.0;
}

double standard_inverse(Shape shape, double p) {
  switch (shape) {
    case Shape::logistic:
      return std::log(p / (1.0 - p));
    case Shape::normal:
      return gsl_cdf_ugaussian_Pinv(p);
    case Shape::weibull:
      return std::log(-std::log1p(-p));
  }
  return 0.0;
}

// s: the length of the interval from G = 0.05 to G = 0.95.
double standard_width(Shape shape) {
  return standard_inverse(shape, 0.95) - standard_inverse(shape, 0.05);
}

double axis_of(Shape shape, double level) {
  return shape == Shape::weibull ? std::log(level) : level;
}
double level_of(Shape shape, double t) {
  return shape == Shape::weibull ? std::exp(t) : t;
}

// Nodes and weights of Gauss and Hermite for the weight exp(-z^2).
template <size_t n>
struct Hermite {
  std::array<double, n> node, weight;
  Hermite() {
    gsl_integration_fixed_workspace* rule =
        gsl_integration_fixed_alloc(gsl_integration_fixed_hermite, n, 0.0, 1.0, 0.0, 0.0);
    std::copy_n(gsl_integration_fixed_nodes(rule), n, node.begin());
    std::copy_n(gsl_integration_fixed_weights(rule), n, weight.begin());
    gsl_integration_fixed_free(rule);
  }
};
const Hermite<11>& few_nodes() {
  static const Hermite<11> rule;
  return rule;
}
const Hermite<41>& many_nodes() {
  static const Hermite<41> rule;
  return rule;
}

// The axis of t, moved and stretched so that the levels reach from -1 to 1.
struct Axis {
  Shape shape = Shape::logistic;
  double middle = 0.0, half = 1.0;

  Axis(Shape of, const std::vector<Observer>& observers) : shape(of) {
    double low = GSL_POSINF, high = GSL_NEGINF;
    for (const Observer& observer : observers) {
      for (const LevelCell& cell : observer.cells) {
        low = std::min(low, axis_of(shape, cell.level));
        high = std::max(high, axis_of(shape, cell.level));
      }
    }
    middle = 0.5 * (low + high);
    if (high > low) half = 0.5 * (high - low);
  }
  [[nodiscard]] double scaled(double level) const {
    return (axis_of(shape, level) - middle) / half;
  }
  [[nodiscard]] double level(double t) const { return level_of(shape, middle + half * t); }
};

// A cell on the scaled axis.
struct Point {
  double t, trials, hits;
};
using Points = std::vector<Point>;

std::vector<Points> points_of(const Axis& axis, const std::vector<Observer>& observers) {
  std::vector<Points> all;
  for (const Observer& observer : observers) {
    Points points;
    for (const LevelCell& cell : observer.cells) {
      points.push_back({axis.scaled(cell.level), static_cast<double>(cell.trials),
                        static_cast<double>(cell.hits)});
    }
    all.push_back(std::move(points));
  }
  return all;
}

// Derivatives of minus the log-likelihood with respect to the curve and the spread.
struct Gradient {
  double threshold = 0.0, ln_width = 0.0, spread = 0.0, lapse = 0.0, guess = 0.0;
  void add(double weight, const Gradient& other) {
    threshold += weight * other.threshold;
    ln_width += weight * other.ln_width;
    spread += weight * other.spread;
    lapse += weight * other.lapse;
    guess += weight * other.guess;
  }
};

// The likelihood of a model with fixed constants.
class Likelihood {
 public:
  explicit Likelihood(const PsychometricModel& model)
      : shape_(model.shape),
        g_(standard_inverse(model.shape, model.threshold_at)),
        s_(standard_width(model.shape)) {}

  [[nodiscard]] double psi(const Curve& curve, double t) const {
    return curve.guess + (1.0 - curve.guess - curve.lapse) *
                             standard(shape_, g_ + s_ * (t - curve.threshold) / curve.width);
  }

  // Minus the log-likelihood of one observer whose threshold is moved by `shift`.
  [[nodiscard]] double minus_log(const Points& points, const Curve& curve, double shift) const {
    constexpr double tiny = 1e-300;
    double sum = 0.0;
    for (const Point& point : points) {
      const double p = psi(curve, point.t - shift);
      if (point.hits > 0.0) sum -= point.hits * std::log(std::max(tiny, p));
      const double misses = point.trials - point.hits;
      if (misses > 0.0) sum -= misses * std::log(std::max(tiny, 1.0 - p));
    }
    return sum;
  }

  // Its derivatives; that of the spread is u times that of the threshold.
  [[nodiscard]] Gradient gradient(const Points& points, const Curve& curve, double shift) const {
    Gradient sum;
    const double height = 1.0 - curve.guess - curve.lapse;
    for (const Point& point : points) {
      const double z = s_ * (point.t - shift - curve.threshold) / curve.width;
      const double g = standard(shape_, g_ + z);
      const double density = height * standard_density(shape_, g_ + z);
      const double p = std::clamp(curve.guess + height * g, 1e-300, 1.0 - 1e-16);
      const double score = (point.trials - point.hits) / (1.0 - p) - point.hits / p;
      sum.threshold -= score * density * s_ / curve.width;
      sum.ln_width -= score * density * z;
      sum.lapse -= score * g;
      sum.guess += score * (1.0 - g);
    }
    return sum;
  }

  // Minus the log of the integral over u ~ N(0, 1) of an observer's likelihood with threshold
  // shifted by spread u (Liu and Pierce 1994): Gauss and Hermite's rule, moved to the mode and
  // stretched by the expected curvature there. `mode` is the search's start and its result. The
  // gradient is the mean of the likelihood's over u given the answers (Fisher's identity).
  double integrated(const Points& points, const Curve& curve, double spread, double& mode,
                    Gradient* slope = nullptr) const {
    if (spread == 0.0) {
      if (slope) slope->add(1.0, gradient(points, curve, 0.0));
      return minus_log(points, curve, 0.0);
    }
    const double curvature = find_mode(points, curve, spread, mode);
    const double scale = M_SQRT2 / std::sqrt(curvature);
    const Hermite<11>& rule = few_nodes();
    std::array<double, 11> exponent{};
    for (size_t q = 0; q < rule.node.size(); ++q) {
      const double u = mode + scale * rule.node[q];
      exponent[q] =
          rule.node[q] * rule.node[q] - minus_log(points, curve, spread * u) - 0.5 * u * u;
    }
    const double largest = *std::max_element(exponent.begin(), exponent.end());
    double sum = 0.0;
    for (size_t q = 0; q < rule.node.size(); ++q)
      sum += rule.weight[q] * std::exp(exponent[q] - largest);
    for (size_t q = 0; slope && q < rule.node.size(); ++q) {
      const double weight = rule.weight[q] * std::exp(exponent[q] - largest) / sum;
      if (weight < 1e-12) continue;
      const double u = mode + scale * rule.node[q];
      Gradient at = gradient(points, curve, spread * u);
      at.spread = u * at.threshold;
      slope->add(weight, at);
    }
    return -(largest + std::log(sum * scale) - 0.5 * std::log(2.0 * M_PI));
  }

 private:
  // Fisher scoring with halving on minus_log + u^2 / 2; returns its curvature at the mode.
  double find_mode(const Points& points, const Curve& curve, double spread, double& u) const {
    const auto objective = [&](double at) {
      return minus_log(points, curve, spread * at) + 0.5 * at * at;
    };
    double value = objective(u);
    double curvature = 1.0;
    for (int iteration = 0; iteration < 50; ++iteration) {
      double gradient = u;
      curvature = 1.0;
      const double factor = (1.0 - curve.guess - curve.lapse) * s_ / curve.width * spread;
      for (const Point& point : points) {
        const double z = g_ + s_ * (point.t - spread * u - curve.threshold) / curve.width;
        const double slope = factor * standard_density(shape_, z);  // -d psi / du
        const double p = std::clamp(psi(curve, point.t - spread * u), 1e-12, 1.0 - 1e-12);
        gradient += slope * (point.hits / p - (point.trials - point.hits) / (1.0 - p));
        curvature += slope * slope * point.trials / (p * (1.0 - p));
      }
      double step = -gradient / curvature;
      if (std::abs(step) < 1e-9) break;
      bool better = false;
      for (int halving = 0; halving < 20 && !better; ++halving, step *= 0.5) {
        const double trial = objective(u + step);
        if (trial > value) continue;
        value = trial;
        u += step;
        better = true;
      }
      if (!better) break;
    }
    return curvature;
  }

  Shape shape_;
  double g_, s_;
};

// What is searched for: a vector of free parameters without bounds.
//   0: threshold, 1: ln width, then spread, lapse and guess where they are free.
class Search {
 public:
  Search(const PsychometricModel& model, const std::vector<Points>& observers, bool random_effects)
      : model_(model),
        likelihood_(model),
        observers_(observers),
        modes_(observers.size(), 0.0),
        random_effects_(random_effects) {
    std::vector<double> levels;
    for (const Points& points : observers) {
      for (const Point& point : points) levels.push_back(point.t);
    }
    std::sort(levels.begin(), levels.end());
    double finest = 2.0;
    for (size_t i = 1; i < levels.size(); ++i) {
      const double gap = levels[i] - levels[i - 1];
      if (gap > 1e-9) finest = std::min(finest, gap);
    }
    least_ = std::log(0.1 * finest);
  }

  struct Result {
    std::vector<double> x;
    double minimum = 0.0;  // minus the log-likelihood
  };

  [[nodiscard]] Curve curve_of(const std::vector<double>& x) const {
    size_t at = random_effects_ ? 3 : 2;
    Curve curve{x[0], std::exp(std::clamp(x[1], least_, most_)), model_.guess.value,
                model_.lapse.value};
    // A rate within [0, most] is most sin^2 of a free number.
    const auto rate = [&](const Rate& r) {
      const double sine = std::sin(x[at++]);
      return r.most * sine * sine;
    };
    if (model_.lapse.free) curve.lapse = rate(model_.lapse);
    if (model_.guess.free) curve.guess = rate(model_.guess);
    return curve;
  }
  [[nodiscard]] double spread_of(const std::vector<double>& x) const {
    return random_effects_ ? std::abs(x[2]) : 0.0;
  }
  // A width that the levels cannot tell from 0, or from a function that does not rise.
  [[nodiscard]] bool steep(double ln_width) const { return ln_width < least_ + 0.01; }
  [[nodiscard]] static bool flat(double ln_width) { return ln_width > most_ - 0.01; }
  [[nodiscard]] const std::vector<double>& modes() const { return modes_; }

  // Minus the log-likelihood, with its gradient if `slope` is not null.
  double value(const std::vector<double>& x, std::vector<double>* slope = nullptr) {
    const Curve curve = curve_of(x);
    Gradient gradient;
    double sum = 0.0;
    for (size_t i = 0; i < observers_.size(); ++i) {
      sum += likelihood_.integrated(observers_[i], curve, spread_of(x), modes_[i],
                                    slope ? &gradient : nullptr);
    }
    // Walls far outside of what the levels can tell.
    constexpr double steepness = 1e3;
    const double under = std::min(0.0, x[1] - least_), over = std::max(0.0, x[1] - most_);
    const double left = std::min(0.0, x[0] + 7.0), right = std::max(0.0, x[0] - 7.0);
    const double wide = std::max(0.0, spread_of(x) - 6.0);
    sum += steepness * (under * under + over * over + left * left + right * right + wide * wide);
    if (slope) {
      const bool inside = under == 0.0 && over == 0.0;
      slope->assign({gradient.threshold + 2.0 * steepness * (left + right),
                     (inside ? gradient.ln_width : 0.0) + 2.0 * steepness * (under + over)});
      if (random_effects_) {
        slope->push_back((gradient.spread + 2.0 * steepness * wide) * (x[2] < 0.0 ? -1.0 : 1.0));
      }
      const auto rate = [&](const Rate& r, double by_rate) {
        slope->push_back(by_rate * r.most * std::sin(2.0 * x[slope->size()]));
      };
      if (model_.lapse.free) rate(model_.lapse, gradient.lapse);
      if (model_.guess.free) rate(model_.guess, gradient.guess);
    }
    return sum;
  }

  // From a start, with parameter `fixed` held (-1: none), by BFGS.
  Result minimise(std::vector<double> start, int fixed) {
    leave_stationary_points(start);
    fixed_ = fixed;
    full_ = start;
    const size_t n = start.size() - (fixed >= 0 ? 1U : 0U);
    gsl_vector* x = gsl_vector_alloc(n);
    for (size_t i = 0, at = 0; i < start.size(); ++i) {
      if (static_cast<int>(i) != fixed) gsl_vector_set(x, at++, start[i]);
    }
    gsl_multimin_function_fdf function{&Search::evaluate, &Search::differentiate, &Search::both, n,
                                       this};
    gsl_multimin_fdfminimizer* search =
        gsl_multimin_fdfminimizer_alloc(gsl_multimin_fdfminimizer_vector_bfgs2, n);
    gsl_multimin_fdfminimizer_set(search, &function, x, 0.05, 0.1);
    for (int iteration = 0; iteration < 200; ++iteration) {
      if (gsl_multimin_fdfminimizer_iterate(search) != GSL_SUCCESS) break;
      if (gsl_multimin_test_gradient(search->gradient, 1e-4) == GSL_SUCCESS) break;
    }
    Result result{unpack(gsl_multimin_fdfminimizer_x(search)),
                  gsl_multimin_fdfminimizer_minimum(search)};
    gsl_multimin_fdfminimizer_free(search);
    gsl_vector_free(x);
    return result;
  }

  // The best of a grid of starts, polished.
  Result best() {
    Result first{{}, GSL_POSINF};
    for (double place : {-0.8, -0.4, 0.0, 0.4, 0.8}) {
      for (double width : {0.3, 1.0, 3.0}) {
        std::vector<double> x{place, std::log(width)};
        if (random_effects_) x.push_back(0.2);
        if (model_.lapse.free) x.push_back(std::asin(std::sqrt(0.2)));
        if (model_.guess.free) x.push_back(std::asin(std::sqrt(0.2)));
        const double minimum = value(x);
        if (minimum < first.minimum) first = {x, minimum};
      }
    }
    return minimise(minimise(first.x, -1).x, -1);
  }

 private:
  // At a spread, a lapse or a guess rate of 0 the gradient in its parameter is 0, minimum or not.
  void leave_stationary_points(std::vector<double>& x) const {
    if (random_effects_ && std::abs(x[2]) < 0.02) x[2] = 0.02;
    for (size_t i = random_effects_ ? 3 : 2; i < x.size(); ++i) {
      if (std::abs(std::sin(x[i])) < 0.1) x[i] = 0.1;
    }
  }
  [[nodiscard]] std::vector<double> unpack(const gsl_vector* x) const {
    std::vector<double> all = full_;
    size_t at = 0;
    for (size_t i = 0; i < all.size(); ++i) {
      if (static_cast<int>(i) != fixed_) all[i] = gsl_vector_get(x, at++);
    }
    return all;
  }
  static double evaluate(const gsl_vector* x, void* self) {
    auto* search = static_cast<Search*>(self);
    return search->value(search->unpack(x));
  }
  static void both(const gsl_vector* x, void* self, double* value, gsl_vector* gradient) {
    auto* search = static_cast<Search*>(self);
    *value = search->value(search->unpack(x), &search->slope_);
    size_t at = 0;
    for (size_t i = 0; i < search->slope_.size(); ++i) {
      if (static_cast<int>(i) != search->fixed_) gsl_vector_set(gradient, at++, search->slope_[i]);
    }
  }
  static void differentiate(const gsl_vector* x, void* self, gsl_vector* gradient) {
    double ignored = 0.0;
    both(x, self, &ignored, gradient);
  }

  static constexpr double most_ = 4.1;  // ln of thirty times the range of the levels
  PsychometricModel model_;
  Likelihood likelihood_;
  const std::vector<Points>& observers_;
  std::vector<double> modes_;
  bool random_effects_;
  double least_ = 0.0;  // ln of a tenth of the finest gap between levels
  int fixed_ = -1;
  std::vector<double> full_, slope_;
};

// The value of one parameter at which the best of all others lies `rise` above the minimum, to one
// side; nothing if it is beyond `limit`.
std::optional<double> profile_bound(Search& search, const Search::Result& best, int index,
                                    double direction, double first_step, double limit,
                                    double rise) {
  const auto i = static_cast<size_t>(index);
  Search::Result inner = best;
  const auto at = [&](double value, const Search::Result& near) {
    std::vector<double> start = near.x;
    start[i] = value;
    return search.minimise(start, index);
  };
  double step = first_step;
  Search::Result outer;
  while (true) {
    const double value = inner.x[i] + direction * step;
    if ((value - limit) * direction > 0.0) return std::nullopt;
    outer = at(value, inner);
    if (outer.minimum - best.minimum >= rise) break;
    inner = outer;
    step *= 1.6;
  }
  // The profile is nearly a parabola: its root is nearly linear in the root of the rise (regula
  // falsi, Illinois).
  const auto excess = [&](const Search::Result& r) {
    return std::sqrt(std::max(0.0, r.minimum - best.minimum)) - std::sqrt(rise);
  };
  double a = inner.x[i], fa = excess(inner), b = outer.x[i], fb = excess(outer);
  for (int iteration = 0; iteration < 40 && std::abs(b - a) > 1e-6 * first_step; ++iteration) {
    const double middle = (a * fb - b * fa) / (fb - fa);
    const Search::Result r = at(middle, inner);
    const double f = excess(r);
    if (std::abs(f) < 1e-5) return middle;
    if (f * fb < 0.0) {
      a = b, fa = fb;
    } else {
      fa *= 0.5;
    }
    b = middle, fb = f;
  }
  return b;
}

// Share of hits in the population at t.
double population_share(const Likelihood& likelihood, const Curve& curve, double spread, double t) {
  if (spread == 0.0) return likelihood.psi(curve, t);
  const Hermite<41>& rule = many_nodes();
  double sum = 0.0;
  for (size_t q = 0; q < rule.node.size(); ++q)
    sum += rule.weight[q] * likelihood.psi(curve, t - M_SQRT2 * spread * rule.node[q]);
  return sum / std::sqrt(M_PI);
}

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
    const double p = population_share(likelihood, curve, spread, t);
    const double misses = sum.trials - sum.hits;
    if (sum.hits > 0.0) deviance += 2.0 * sum.hits * std::log(sum.hits / (sum.trials * p));
    if (misses > 0.0) deviance += 2.0 * misses * std::log(misses / (sum.trials * (1.0 - p)));
  }
  return deviance;
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
  return population_share(Likelihood(model), curve, spread, axis_of(model.shape, level));
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
    return not_estimable("the share of hits does not rise with the level");
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
  if (search.steep(best.x[1])) {
    fit.width = fit.slope = Estimate::none(
        "the share of hits jumps from one level to the next; levels between them would tell");
  }
  fit.deviance = level_deviance(Likelihood(model), points, curve, spread);
  add_resamples(fit, resample(model, points, random_effects, best, curve, spread, options), model,
                axis, options.alpha);
  return fit;
}

}  // namespace pinchlab::analysis
