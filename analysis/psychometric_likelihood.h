// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The likelihood of a psychometric function and its derivatives, on an axis where the levels reach
// from -1 to 1. Inside of psychometric.cpp and its search.

#include <vector>

#include "analysis/psychometric_model.h"

namespace pinchlab::analysis {

/// s: the length of the interval from G = 0.05 to G = 0.95.
double standard_width(Shape shape);

/// The axis of t, where a function of this shape is one of location and width: ln for Weibull's.
double axis_of(Shape shape, double level);

/// The axis of t, moved and stretched so that the levels reach from -1 to 1.
struct Axis {
  Shape shape = Shape::logistic;
  double middle = 0.0, half = 1.0;

  Axis(Shape of, const std::vector<Observer>& observers);
  [[nodiscard]] double scaled(double level) const;
  [[nodiscard]] double level(double t) const;
};

/// A cell on the scaled axis.
struct Point {
  double t, trials, hits;
};
using Points = std::vector<Point>;

std::vector<Points> points_of(const Axis& axis, const std::vector<Observer>& observers);

/// Derivatives of minus the log-likelihood with respect to the curve and the spread.
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

/// The likelihood of a model with fixed constants.
class Likelihood {
 public:
  explicit Likelihood(const PsychometricModel& model);

  [[nodiscard]] double psi(const Curve& curve, double t) const;

  /// Minus the log-likelihood of one observer whose threshold is moved by `shift`.
  [[nodiscard]] double minus_log(const Points& points, const Curve& curve, double shift) const;

  /// Its derivatives; that of the spread is u times that of the threshold.
  [[nodiscard]] Gradient gradient(const Points& points, const Curve& curve, double shift) const;

  /// Minus the log of the integral over u ~ N(0, 1) of an observer's likelihood with threshold
  /// shifted by spread u (Liu and Pierce 1994): Gauss and Hermite's rule, moved to the mode and
  /// stretched by the expected curvature there. `mode` is the search's start and its result. The
  /// gradient is the mean of the likelihood's over u given the answers (Fisher's identity).
  double integrated(const Points& points, const Curve& curve, double spread, double& mode,
                    Gradient* slope = nullptr) const;

  /// Share of hits in the population at t, whose thresholds have this spread.
  [[nodiscard]] double population_share(const Curve& curve, double spread, double t) const;

 private:
  /// Fisher scoring with halving on minus_log + u^2 / 2; returns its curvature at the mode.
  double find_mode(const Points& points, const Curve& curve, double spread, double& u) const;

  Shape shape_;
  double g_, s_;
};

}  // namespace pinchlab::analysis
