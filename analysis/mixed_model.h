// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A mixed logistic model of all answers at once:
//   logit P(pinch) = intercept + sd_p u_participant + sd_d v_demonstration,   u, v ~ N(0, 1),
// by maximum likelihood with Laplace's approximation of the integral over u and v.

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "analysis/answers_table.h"
#include "analysis/estimate.h"

namespace pinchlab::analysis {

/// The answers of one participant to one demonstration.
struct Cell {
  std::uint16_t demonstration;  ///< 0 .. demonstrations - 1
  std::uint16_t answers;        ///< > 0
  std::uint16_t pinch;
  std::strong_ordering operator<=>(const Cell&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// Participants who answered alike are one pattern with a weight.
struct Pattern {
  std::vector<Cell> cells;
  double participants = 1.0;
};

struct MixedData {
  std::vector<Pattern> patterns;
  size_t demonstrations = 0;
};

MixedData mixed_data(const AnswersTable& table, const Group& group);

struct MixedParameters {
  double intercept = 0.0;
  double sd_participant = 0.0;
  double sd_demonstration = 0.0;
};

/// Minus twice the log-likelihood (Laplace; binomial coefficients left out). Exposed for tests.
double laplace_deviance(const MixedData& data, const MixedParameters& parameters);

struct MixedModel {
  Estimate intercept;  ///< log-odds of pinch for the average participant and demonstration
  Estimate intercept_low, intercept_high;  ///< profile-likelihood interval
  Estimate p;                 ///< likelihood-ratio test of intercept 0, chi-square, df 1
  Estimate sd_participant;    ///< log-odds; 0: on the boundary
  Estimate sd_demonstration;  ///< log-odds; 0: on the boundary
  Estimate mean_share;  ///< share of pinch over the population of participants and demonstrations
  Estimate deviance;
};

/// Fits the model, or gives the reason why it cannot be estimated.
MixedModel fit_mixed_model(const MixedData& data, double alpha);

}  // namespace pinchlab::analysis
