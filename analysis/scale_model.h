// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One scale for three and more methods from choices between two of them. With d = v_i - v_j (+ s
// where i stands on the left):
//   Bradley and Terry (Biometrika 39 (1952) 324): P(i over j) = 1 / (1 + e^-d); with ties Davidson
//     (J. Am. Stat. Assoc. 65 (1970) 317): P(i), P(j), P(tie) as e^(d/2) : e^(-d/2) : nu;
//   Thurstone's case V (Psychological Review 34 (1927) 273): P(i over j) = Phi(d / sqrt 2); with
//     ties Glenn and David (Biometrics 16 (1960) 86): P(i) = Phi(d / sqrt 2 - tau).

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/estimate.h"

namespace pinchlab::analysis {

enum class ScaleModel : std::uint8_t { bradley_terry, thurstone };

/// Choices of one participant (or of all, if not known whose they are) between two methods.
struct PairChoices {
  std::uint32_t participant = 0;
  std::uint16_t demonstration = 0;
  std::uint16_t left = 0, right = 0;  ///< methods, not the same
  std::int64_t left_wins = 0, right_wins = 0, ties = 0;
  [[nodiscard]] std::int64_t total() const { return left_wins + right_wins + ties; }
};

/// A square matrix, row by row.
struct Matrix {
  std::size_t size = 0;
  std::vector<double> values;
  Matrix() = default;
  explicit Matrix(std::size_t n) : size(n), values(n * n) {}
  double& at(std::size_t i, std::size_t j) { return values[i * size + j]; }
  [[nodiscard]] double at(std::size_t i, std::size_t j) const { return values[i * size + j]; }
};

/// Inverse of a symmetric positive definite matrix; size 0 if it is not one.
Matrix inverse(const Matrix& matrix);

/// What is left of a variance between participants, as a share of that of independent answers,
/// where they do not differ at all: round-off, which must not pass for a variance.
constexpr double roundoff_share = 1e-10;

struct ScaleFit {
  std::string why_not = "not computed";  ///< empty: the fit holds
  std::vector<double> values;            ///< of the methods; their sum is 0
  Matrix covariance;                     ///< of `values`, if all answers are independent
  Matrix robust;  ///< the same if only participants are; size 0 where there are fewer than two
  std::size_t clusters = 0;  ///< participants
  Estimate side, side_se;    ///< of the left, on the scale; robust where there are participants,
                             ///< no error where these do not differ
  Estimate tie;              ///< nu or tau, where there are ties
  double log_likelihood = 0.0;
  double deviance = 0.0;  ///< against shares of each pair (left and right told apart) of their own
  double df = 0.0;        ///< of it
  [[nodiscard]] const Matrix& read() const { return robust.size > 0 ? robust : covariance; }
};

/// Maximum likelihood by Fisher's scoring. The robust covariance is the cluster sandwich with
/// N / (N - 1) (Liang and Zeger, Biometrika 73 (1986) 13). There is no finite scale, and `why_not`
/// says between whom, where some methods never lost to the others (Ford, Am. Math. Monthly 64
/// (1957) 28). `with_side` adds s.
ScaleFit fit_scale(ScaleModel model, std::size_t methods, const std::vector<PairChoices>& choices,
                   bool with_side = false);

/// P(left), P(right), P(tie) under a fit; `with_ties` as in the fitted choices.
struct Outcomes {
  double left = 0.5, right = 0.5, tie = 0.0;
};
Outcomes outcomes(ScaleModel model, const ScaleFit& fit, std::size_t left, std::size_t right);

}  // namespace pinchlab::analysis
