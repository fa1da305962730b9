// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/psychometric_search.h"

#include <gsl/gsl_math.h>
#include <gsl/gsl_multimin.h>

#include <algorithm>
#include <cmath>

namespace pinchlab::analysis {

Search::Search(const PsychometricModel& model, const std::vector<Points>& observers,
               bool random_effects)
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

Curve Search::curve_of(const std::vector<double>& x) const {
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

double Search::spread_of(const std::vector<double>& x) const {
  return random_effects_ ? std::abs(x[2]) : 0.0;
}

double Search::value(const std::vector<double>& x, std::vector<double>* slope) {
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

Search::Result Search::minimise(std::vector<double> start, int fixed) {
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

Search::Result Search::best() {
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

bool Search::rises_to_steep(const Result& best) {
  constexpr double nothing = 1e-3;  // of a log-likelihood, whose intervals are cut at about 2
  std::vector<double> steepest = best.x;
  steepest[1] = least_;
  return minimise(steepest, 1).minimum <= best.minimum + nothing;
}

// At a spread, a lapse or a guess rate of 0 the gradient in its parameter is 0, minimum or not.
void Search::leave_stationary_points(std::vector<double>& x) const {
  if (random_effects_ && std::abs(x[2]) < 0.02) x[2] = 0.02;
  for (size_t i = random_effects_ ? 3 : 2; i < x.size(); ++i) {
    if (std::abs(std::sin(x[i])) < 0.1) x[i] = 0.1;
  }
}

std::vector<double> Search::unpack(const gsl_vector* x) const {
  std::vector<double> all = full_;
  size_t at = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    if (static_cast<int>(i) != fixed_) all[i] = gsl_vector_get(x, at++);
  }
  return all;
}

double Search::evaluate(const gsl_vector* x, void* self) {
  auto* search = static_cast<Search*>(self);
  return search->value(search->unpack(x));
}

void Search::both(const gsl_vector* x, void* self, double* value, gsl_vector* gradient) {
  auto* search = static_cast<Search*>(self);
  *value = search->value(search->unpack(x), &search->slope_);
  size_t at = 0;
  for (size_t i = 0; i < search->slope_.size(); ++i) {
    if (static_cast<int>(i) != search->fixed_) gsl_vector_set(gradient, at++, search->slope_[i]);
  }
}

void Search::differentiate(const gsl_vector* x, void* self, gsl_vector* gradient) {
  double ignored = 0.0;
  both(x, self, &ignored, gradient);
}

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

}  // namespace pinchlab::analysis
