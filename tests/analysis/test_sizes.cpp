// SPDX-License-Identifier: GPL-3.0-or-later
// 10,000 simulated studies a design: tests that take the participant as the unit hold their size.
#include <cmath>

#include "analysis/size_study.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

constexpr int studies = 10000;
constexpr double alpha = 0.05;

class PooledTestSize : public testing::TestWithParam<SizeCondition> {};

TEST_P(PooledTestSize, CorrectedTestsHoldItAndTheNaiveOneDoesNot) {
  const SizeCondition& condition = GetParam();
  const auto rates = false_positive_rates(condition, studies, alpha, 199, 11);
  // Three standard errors of a rate that is exactly alpha.
  const double limit = alpha + 3.0 * std::sqrt(alpha * (1.0 - alpha) / studies);
  EXPECT_LE(rates[3], limit) << pooled_test_names[3];
  EXPECT_LE(rates[4], limit) << pooled_test_names[4];
  EXPECT_LE(rates[5], limit) << pooled_test_names[5];
  // None of them holds it by never rejecting.
  for (size_t test : {3U, 4U, 5U}) EXPECT_GE(rates[test], 0.02) << pooled_test_names[test];
  // Chi-square as the reference of Rao and Scott's statistic is for many participants.
  EXPECT_LE(rates[2], condition.participants >= 64 ? limit : 0.075);
  if (condition.icc == 0.0) {
    EXPECT_LE(rates[0], limit);
  } else {
    // With ICC r the naive statistic is inflated by 1 + (K - 1) r.
    const double inflation = 1.0 + (condition.demonstrations - 1) * condition.icc;
    const double expected = std::erfc(1.959964 / std::sqrt(2.0 * inflation));
    EXPECT_NEAR(rates[0], expected, 0.03);
    EXPECT_GT(rates[0], 2.0 * alpha);
  }
}

std::string name_of(const testing::TestParamInfo<SizeCondition>& info) {
  return fmt::format("Participants{}IccPercent{}", info.param.participants,
                     std::lround(100.0 * info.param.icc));
}

INSTANTIATE_TEST_SUITE_P(Designs, PooledTestSize,
                         testing::Values(SizeCondition{16, 8, 0.0}, SizeCondition{16, 8, 0.3},
                                         SizeCondition{64, 8, 0.1}),
                         name_of);

TEST(SimulateStudy, HasTheCorrelationAskedFor) {
  const Rng rng = make_rng(RandomUse::study, 2);
  const auto clusters = simulate_study({20000, 8, 0.25}, rng.get());
  EXPECT_NEAR(rao_scott(clusters).icc.value, 0.25, 0.015);
}

}  // namespace
}  // namespace pinchlab::analysis
