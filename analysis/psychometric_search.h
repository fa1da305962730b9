// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The search for the best psychometric function. Inside of psychometric.cpp.

#include <gsl/gsl_vector.h>

#include <optional>
#include <vector>

#include "analysis/psychometric_likelihood.h"

namespace pinchlab::analysis {

/// What is searched for: a vector of free parameters without bounds.
///   0: threshold, 1: ln width, then spread, lapse and guess where they are free.
class Search {
 public:
  Search(const PsychometricModel& model, const std::vector<Points>& observers, bool random_effects);

  struct Result {
    std::vector<double> x;
    double minimum = 0.0;  ///< minus the log-likelihood
  };

  [[nodiscard]] Curve curve_of(const std::vector<double>& x) const;
  [[nodiscard]] double spread_of(const std::vector<double>& x) const;
  /// A width that the levels cannot tell from 0, or from a function that does not rise.
  [[nodiscard]] bool steep(double ln_width) const { return ln_width < least_ + 0.01; }
  /// Whether the likelihood is as high where the function is as steep as that.
  [[nodiscard]] bool rises_to_steep(const Result& best);
  [[nodiscard]] static bool flat(double ln_width) { return ln_width > most_ - 0.01; }
  [[nodiscard]] const std::vector<double>& modes() const { return modes_; }

  /// Minus the log-likelihood, with its gradient if `slope` is not null.
  double value(const std::vector<double>& x, std::vector<double>* slope = nullptr);

  /// From a start, with parameter `fixed` held (-1: none), by BFGS.
  Result minimise(std::vector<double> start, int fixed);

  /// The best of a grid of starts, polished.
  Result best();

 private:
  void leave_stationary_points(std::vector<double>& x) const;
  [[nodiscard]] std::vector<double> unpack(const gsl_vector* x) const;
  static double evaluate(const gsl_vector* x, void* self);
  static void both(const gsl_vector* x, void* self, double* value, gsl_vector* gradient);
  static void differentiate(const gsl_vector* x, void* self, gsl_vector* gradient);

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

/// The value of one parameter at which the best of all others lies `rise` above the minimum, to one
/// side; nothing if it is beyond `limit`.
std::optional<double> profile_bound(Search& search, const Search::Result& best, int index,
                                    double direction, double first_step, double limit, double rise);

}  // namespace pinchlab::analysis
