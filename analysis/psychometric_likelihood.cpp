// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/psychometric_likelihood.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_math.h>

#include <algorithm>
#include <array>
#include <cmath>

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

}  // namespace

double standard_width(Shape shape) {
  return standard_inverse(shape, 0.95) - standard_inverse(shape, 0.05);
}

double axis_of(Shape shape, double level) {
  return shape == Shape::weibull ? std::log(level) : level;
}

Axis::Axis(Shape of, const std::vector<Observer>& observers) : shape(of) {
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

double Axis::scaled(double level) const {
  return (axis_of(shape, level) - middle) / half;
}

double Axis::level(double t) const {
  return level_of(shape, middle + half * t);
}

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

Likelihood::Likelihood(const PsychometricModel& model)
    : shape_(model.shape),
      g_(standard_inverse(model.shape, model.threshold_at)),
      s_(standard_width(model.shape)) {}

double Likelihood::psi(const Curve& curve, double t) const {
  return curve.guess + (1.0 - curve.guess - curve.lapse) *
                           standard(shape_, g_ + s_ * (t - curve.threshold) / curve.width);
}

double Likelihood::minus_log(const Points& points, const Curve& curve, double shift) const {
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

Gradient Likelihood::gradient(const Points& points, const Curve& curve, double shift) const {
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

double Likelihood::integrated(const Points& points, const Curve& curve, double spread, double& mode,
                              Gradient* slope) const {
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
    exponent[q] = rule.node[q] * rule.node[q] - minus_log(points, curve, spread * u) - 0.5 * u * u;
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

double Likelihood::find_mode(const Points& points, const Curve& curve, double spread,
                             double& u) const {
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

double Likelihood::population_share(const Curve& curve, double spread, double t) const {
  if (spread == 0.0) return psi(curve, t);
  const Hermite<41>& rule = many_nodes();
  double sum = 0.0;
  for (size_t q = 0; q < rule.node.size(); ++q)
    sum += rule.weight[q] * psi(curve, t - M_SQRT2 * spread * rule.node[q]);
  return sum / std::sqrt(M_PI);
}

}  // namespace pinchlab::analysis
