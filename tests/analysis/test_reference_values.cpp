// SPDX-License-Identifier: GPL-3.0-or-later
// Values computed with R 4.6, to be met to six digits.
#include <cmath>

#include "analysis/effects.h"
#include "analysis/tests_2afc.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

// Six significant digits of a reference that is itself printed with six.
void expect_digits(double value, double reference) {
  EXPECT_NEAR(value, reference, 5.5e-6 * std::abs(reference)) << "reference " << reference;
}
// Six decimals.
void expect_decimals(double value, double reference) {
  EXPECT_NEAR(value, reference, 5.5e-7);
}

struct Reference {
  Counts counts;
  double chi_square, p, p_exact, cp_low, cp_high, wilson_low, wilson_high, h;
};

class ReferenceValues : public testing::TestWithParam<Reference> {};

TEST_P(ReferenceValues, AreMetToSixDigits) {
  const Reference& r = GetParam();
  const Row row = make_row("x", r.counts, 0.05);
  expect_digits(row.chi_square, r.chi_square);
  expect_digits(row.p_chi_square, r.p);
  expect_digits(row.p_exact, r.p_exact);
  expect_decimals(row.clopper_pearson.low, r.cp_low);
  expect_decimals(row.clopper_pearson.high, r.cp_high);
  expect_decimals(row.wilson.low, r.wilson_low);
  expect_decimals(row.wilson.high, r.wilson_high);
  expect_decimals(row.cohens_h, r.h);
}

std::string name_of(const testing::TestParamInfo<Reference>& info) {
  return fmt::format("Pinch{}Cable{}", info.param.counts.pinch, info.param.counts.cable);
}

INSTANTIATE_TEST_SUITE_P(
    R, ReferenceValues,
    testing::Values(
        Reference{
            {15, 1}, 12.25, 0.000465258, 0.000518799, .697679, .998419, .716713, .988881, 1.065436},
        Reference{{14, 2}, 9, 0.00269980, 0.00418091, .616524, .984486, .639772, .965023, 0.848062},
        Reference{
            {13, 3}, 6.25, 0.0124193, 0.0212708, .543543, .959526, .569911, .934084, 0.675132},
        Reference{{12, 4}, 4, 0.0455003, 0.0768127, .476229, .927338, .505017, .898179, 0.523599},
        Reference{{6, 10}, 1, 0.317311, 0.454498, .151984, .645654, .184812, .613590, -0.252680},
        Reference{{80, 16},
                  42.666667,
                  6.49090e-11,
                  2.07441e-11,
                  .743500,
                  .901627,
                  .746290,
                  .894726,
                  0.729728},
        Reference{
            {96, 32}, 32, 1.54173e-8, 1.28418e-8, .665786, .822291, .668444, .816987, 0.523599}),
    name_of);

// GSL's tails are NaN here, and its quantile never ended.
TEST(ReferenceValues, CountsInTheMillions) {
  const Row row = make_row("x", {1000000, 999000}, 0.05);
  expect_digits(row.p_exact, 0.479829805309);
  EXPECT_NEAR(row.clopper_pearson.low, 0.499556749866767, 1e-14);
  EXPECT_NEAR(row.clopper_pearson.high, 0.500943499533648, 1e-14);
  expect_digits(exact_binomial_p({1000700, 999300}), 0.322544564997);
  EXPECT_EQ(make_row("x", {1000000, 1000000}, 0.05).p_exact, 1.0);
  const Row most = make_row("x", {999999999, 1}, 0.05);
  EXPECT_GE(most.p_exact, 0.0);
  EXPECT_LT(most.clopper_pearson.low, most.share);
  EXPECT_GT(most.clopper_pearson.high, most.share);
}

TEST(Multiplicity, HolmAndBenjaminiHochbergOfTheThesis) {
  std::vector<double> p;
  p.reserve(test::thesis_cable.size());
  for (int cable : test::thesis_cable)
    p.push_back(make_row("x", {16 - cable, cable}, 0.05).p_chi_square);
  const std::vector<double> by_holm = holm(p);
  const std::vector<double> by_bh = benjamini_hochberg(p);
  const double reference_holm[] = {.00372207, .136501,  .0188986, .0745160,
                                   .0745160,  .0745160, .634621,  .634621};
  const double reference_bh[] = {.00372207, .0606670, .0107992, .0198709,
                                 .0198709,  .0198709, .317311,  .317311};
  for (size_t i = 0; i < p.size(); ++i) {
    expect_digits(by_holm[i], reference_holm[i]);
    expect_digits(by_bh[i], reference_bh[i]);
  }
}

TEST(Multiplicity, AdjustmentNeverLowersAPValueNorPassesOne) {
  const std::vector<double> p{0.9, 0.04, 0.04, 1.0, 0.0, 0.3};
  const std::vector<double> by_holm = holm(p);
  const std::vector<double> by_bh = benjamini_hochberg(p);
  for (size_t i = 0; i < p.size(); ++i) {
    EXPECT_GE(by_bh[i], p[i]);
    EXPECT_GE(by_holm[i], by_bh[i]);
    EXPECT_LE(by_holm[i], 1.0);
  }
  EXPECT_TRUE(holm({}).empty());
  EXPECT_EQ(holm(std::vector<double>{0.2})[0], 0.2);
}

TEST(Heterogeneity, OfTheThesis) {
  std::vector<Counts> counts;
  counts.reserve(test::thesis_cable.size());
  for (int cable : test::thesis_cable) counts.push_back({16 - cable, cable});
  const Heterogeneity all = heterogeneity(counts);
  expect_digits(all.chi_square.value, 56.0 / 3.0);
  EXPECT_EQ(all.df.value, 7.0);
  EXPECT_NEAR(all.p.value, 0.0093, 5e-5);
  const Heterogeneity clipping = heterogeneity(std::span(counts).first(6));
  expect_digits(clipping.chi_square.value, 2.4);
  EXPECT_EQ(clipping.df.value, 5.0);
  EXPECT_NEAR(clipping.p.value, 0.79, 5e-3);
}

// The test of 16 answers rejects from 12 of 16 on, where its true size is 0.077 and not 0.05.
TEST(ChiSquare, TrueSizeAtSixteenAnswersIsTooLarge) {
  double size = 0.0;
  for (int k = 0; k <= 16; ++k) {
    if (chi_square_p(chi_square_half({k, 16 - k}), 1.0) < 0.05)
      size += std::exp(std::lgamma(17.0) - std::lgamma(k + 1.0) - std::lgamma(17.0 - k)) / 65536.0;
  }
  EXPECT_NEAR(size, 0.077, 5e-4);
}

// The uniform prior's Bayes factor has a closed form: 2^n / ((n + 1) (n choose k)).
TEST(BayesFactor, ClosedForm) {
  EXPECT_NEAR(std::exp(log_bayes_factor({15, 1})), 65536.0 / (17.0 * 16.0), 1e-9);
  EXPECT_NEAR(std::exp(log_bayes_factor({1, 1})), 4.0 / 6.0, 1e-12);
  EXPECT_TRUE(std::isfinite(log_bayes_factor({1000000, 0})));
}

TEST(Row, SwappingTheMethodsMirrorsEverything) {
  for (const Counts& counts :
       {Counts{15, 1}, Counts{0, 7}, Counts{8, 8}, Counts{123456, 120000}, Counts{1, 0}}) {
    const Row row = make_row("x", counts, 0.05);
    const Row mirror = make_row("x", {counts.cable, counts.pinch}, 0.05);
    EXPECT_EQ(row.chi_square, mirror.chi_square);
    EXPECT_EQ(row.p_exact, mirror.p_exact);
    EXPECT_NEAR(row.cohens_h, -mirror.cohens_h, 1e-14);
    EXPECT_NEAR(row.wilson.low, 1.0 - mirror.wilson.high, 1e-14);
    EXPECT_NEAR(row.clopper_pearson.low, 1.0 - mirror.clopper_pearson.high, 1e-12);
    EXPECT_NEAR(row.log_bayes_factor, mirror.log_bayes_factor, 1e-9);
  }
}

// Where every answer is the same an interval ends at exactly 0 or 1, and nothing has a last bit
// that depends on which method is called which: 16 of 16 once ended at 1 - 2^-53, 12 JOD up.
TEST(Row, SwappingTheMethodsMirrorsIntervalsAndScalesToTheBit) {
  for (int n = 1; n <= 60; ++n) {
    for (int k = 0; k <= n; ++k) {
      SCOPED_TRACE(fmt::format("{} of {}", k, n));
      const Row row = make_row("x", {k, n - k}, 0.05), mirror = make_row("x", {n - k, k}, 0.05);
      const auto expect_mirrored = [k, n](const Interval& interval, const Interval& other) {
        EXPECT_EQ(interval.low, 1.0 - other.high);
        EXPECT_EQ(interval.high, 1.0 - other.low);
        EXPECT_EQ(interval.low == 0.0, k == 0);
        EXPECT_EQ(interval.high == 1.0, k == n);
      };
      expect_mirrored(row.wilson, mirror.wilson);
      expect_mirrored(row.clopper_pearson, mirror.clopper_pearson);
      EXPECT_EQ(row.cohens_h, -mirror.cohens_h);
      EXPECT_EQ(row.log_bayes_factor, mirror.log_bayes_factor);
      const ScaleValue a = scale_value(row.counts, row.wilson.low, row.wilson.high);
      const ScaleValue b = scale_value(mirror.counts, mirror.wilson.low, mirror.wilson.high);
      EXPECT_EQ(bool(a.jod), 0 < k && k < n);
      EXPECT_EQ(bool(a.jod_low), k > 0);
      EXPECT_EQ(bool(a.jod_high), k < n);
      EXPECT_EQ(a.bradley_terry_log_odds.value, -b.bradley_terry_log_odds.value);
      EXPECT_EQ(a.thurstone_d.value, -b.thurstone_d.value);
      EXPECT_EQ(a.jod.value, -b.jod.value);
      EXPECT_EQ(a.jod_low.value, -b.jod_high.value);
    }
  }
}

TEST(Row, IntervalsHoldTheShareAndStayInTheUnitInterval) {
  for (int n = 1; n <= 60; ++n) {
    for (int k = 0; k <= n; ++k) {
      const Row row = make_row("x", {k, n - k}, 0.05);
      for (const Interval& interval : {row.wilson, row.clopper_pearson}) {
        EXPECT_GE(interval.low, 0.0);
        EXPECT_LE(interval.high, 1.0);
        EXPECT_LE(interval.low, row.share + 1e-15);
        EXPECT_GE(interval.high, row.share - 1e-15);
      }
      // The exact test and Clopper-Pearson's interval are one inversion of each other.
      const bool outside = row.clopper_pearson.low > 0.5 || row.clopper_pearson.high < 0.5;
      EXPECT_EQ(row.p_exact < 0.05, outside) << k << " of " << n;
    }
  }
}

}  // namespace
}  // namespace pinchlab::analysis
