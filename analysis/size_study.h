// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Simulated studies without any true preference: how often does each pooled test claim one?

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "analysis/clustered.h"

namespace pinchlab::analysis {

/// A design and how alike the answers of one participant are.
struct SizeCondition {
  int participants = 16;   ///< >= 2
  int demonstrations = 8;  ///< answers of each participant, >= 1
  double icc = 0.0;        ///< intraclass correlation, [0, 1): 0 makes all answers independent
};

/// One study: participant i prefers pinch with probability pi_i ~ Beta(a, a), a = (1/icc - 1)/2,
/// whose mean is 1/2 and which gives answers the intraclass correlation icc.
std::vector<Cluster> simulate_study(const SizeCondition& condition, gsl_rng* rng);

/// The pooled tests that are compared.
inline constexpr std::array<const char*, 6> pooled_test_names{
    "chi-square (naive)", "exact binomial (naive)", "Rao-Scott, chi-square", "Rao-Scott, F",
    "sign flip",          "cluster bootstrap"};

/// p-values of one study in the order of pooled_test_names. A test that has no p-value (no variance
/// between participants) does not reject: its p is 1.
std::array<double, 6> pooled_p_values(const std::vector<Cluster>& clusters, int resamples,
                                      gsl_rng* rng);

/// Share of `studies` simulated studies in which each test rejects at `alpha`. Study k draws from
/// the generator of (seed, k), so any single one can be repeated.
std::array<double, 6> false_positive_rates(const SizeCondition& condition, int studies,
                                           double alpha, int resamples, std::uint64_t seed);

}  // namespace pinchlab::analysis
