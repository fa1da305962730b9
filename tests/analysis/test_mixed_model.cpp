// SPDX-License-Identifier: GPL-3.0-or-later
#include <gsl/gsl_randist.h>

#include <cmath>

#include "analysis/gsl_support.h"
#include "analysis/mixed_model.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

double minus_two_log_likelihood(double answers, double pinch, double eta) {
  return -2.0 * (pinch * eta - answers * std::log1p(std::exp(eta)));
}

// Without spread the model is a plain binomial one, for which Laplace is exact.
TEST(Laplace, IsTheBinomialDevianceWithoutRandomEffects) {
  const AnswersTable table = test::clustered_table();
  const MixedData data = mixed_data(table, table.groups.back());
  for (double intercept : {-2.0, 0.0, 1.0986}) {
    EXPECT_NEAR(laplace_deviance(data, {intercept, 0.0, 0.0}),
                minus_two_log_likelihood(128, 96, intercept), 1e-9);
  }
}

// The integral over u and v of one participant and one demonstration, by a fine grid.
TEST(Laplace, ApproachesTheIntegralAsAnswersGrow) {
  double error_before = 0.0;
  for (int answers : {100, 1000, 10000}) {
    const int pinch = answers * 7 / 10;
    MixedData data;
    data.demonstrations = 1;
    data.patterns.push_back(
        {{{0, static_cast<std::uint16_t>(answers), static_cast<std::uint16_t>(pinch)}}, 1.0});
    const MixedParameters parameters{0.4, 0.7, 0.5};
    // Only s = 0.7 u + 0.5 v enters the likelihood, and it is normal with this standard deviation.
    const double sd = std::hypot(0.7, 0.5);
    const double peak = minus_two_log_likelihood(answers, pinch, std::log(0.7 / 0.3));
    double integral = 0.0;
    const double h = 1e-4;
    for (int i = -80000; i <= 80000; ++i) {
      const double z = h * i;
      const double d = minus_two_log_likelihood(answers, pinch, 0.4 + sd * z);
      integral += h * std::exp(-0.5 * (d - peak) - 0.5 * z * z) / std::sqrt(2.0 * M_PI);
    }
    const double exact = peak - 2.0 * std::log(integral);
    const double error = std::abs(laplace_deviance(data, parameters) - exact);
    // Laplace's error falls with the number of answers: order 1.
    if (error_before > 0.0) {
      EXPECT_LT(error, error_before / 8.0);
    }
    EXPECT_LT(error, 1.0 / answers);
    error_before = error;
  }
}

// Tosses of a coin on which a simplex got stuck. There is no spread, so that the model is a plain
// binomial one, whose estimate and deviance are in closed form.
TEST(MixedModel, FindsThatThereIsNoSpread) {
  constexpr std::uint16_t tosses[] = {0x8482, 0x77a6, 0xa2f6, 0x1d23,
                                      0x3fcc, 0xd286, 0x0990, 0xd838};
  std::vector<std::string> rows;
  double pinch = 0;
  for (int i = 0; i < 128; ++i) {
    const bool is_pinch = ((tosses[i / 16] >> (15 - i % 16)) & 1) == 1;
    pinch += is_pinch ? 1 : 0;
    rows.push_back(fmt::format("p{:02},{},{}\n", i / 8, i % 8, is_pinch ? "pinch" : "cable"));
  }
  const AnswersTable table = test::table_of(test::tidy_csv(rows));
  const MixedModel model = fit_mixed_model(mixed_data(table, table.groups.back()), 0.05);
  ASSERT_TRUE(model.intercept) << model.intercept.why_not;
  EXPECT_EQ(model.sd_participant.value, 0.0);
  EXPECT_EQ(model.sd_demonstration.value, 0.0);
  const double odds = std::log(pinch / (128 - pinch));
  EXPECT_NEAR(model.intercept.value, odds, 1e-4);
  EXPECT_NEAR(model.deviance.value, minus_two_log_likelihood(128, pinch, odds), 1e-6);
}

// lme4 1.1 (glmer, nAGQ = 1) on the same data: 1.202326, 0, 0.668445, deviance 140.142656. Its
// optimiser stops a little above the minimum.
TEST(MixedModel, AgreesWithLme4OnTheClusteredDataSet) {
  const AnswersTable table = test::clustered_table();
  const MixedModel model = fit_mixed_model(mixed_data(table, table.groups.back()), 0.05);
  EXPECT_NEAR(model.intercept.value, 1.202326, 1e-3);
  EXPECT_EQ(model.sd_participant.value, 0.0);
  EXPECT_NEAR(model.sd_demonstration.value, 0.668445, 1e-3);
  EXPECT_LE(model.deviance.value, 140.142656 + 1e-5);
  EXPECT_NEAR(model.deviance.value, 140.142656, 1e-3);
  EXPECT_LT(model.intercept_low.value, model.intercept.value);
  EXPECT_GT(model.intercept_high.value, model.intercept.value);
  EXPECT_LT(model.p.value, 0.05);
  EXPECT_GT(model.intercept_low.value, 0.0);  // the interval and the test are one likelihood
}

TEST(MixedModel, RecoversWhatItWasSimulatedWith) {
  const Rng rng = make_rng(RandomUse::study, 12);
  constexpr int participants = 300;
  constexpr int demonstrations = 20;
  std::vector<double> v;
  v.reserve(demonstrations);
  for (int j = 0; j < demonstrations; ++j) v.push_back(gsl_ran_gaussian(rng.get(), 0.7));
  MixedData data;
  data.demonstrations = demonstrations;
  for (int i = 0; i < participants; ++i) {
    const double u = gsl_ran_gaussian(rng.get(), 1.0);
    Pattern pattern;
    for (int j = 0; j < demonstrations; ++j) {
      const double p = 1.0 / (1.0 + std::exp(-(0.5 + u + v[static_cast<size_t>(j)])));
      pattern.cells.push_back({static_cast<std::uint16_t>(j), 1,
                               static_cast<std::uint16_t>(gsl_ran_bernoulli(rng.get(), p))});
    }
    data.patterns.push_back(pattern);
  }
  const MixedModel model = fit_mixed_model(data, 0.05);
  EXPECT_LT(model.intercept_low.value, 0.5);
  EXPECT_GT(model.intercept_high.value, 0.5);
  EXPECT_NEAR(model.sd_participant.value, 1.0, 4.0 * 1.0 / std::sqrt(2.0 * participants) + 0.02);
  EXPECT_NEAR(model.sd_demonstration.value, 0.7, 4.0 * 0.7 / std::sqrt(2.0 * demonstrations));
}

TEST(MixedModel, PatternsOfParticipantsAreWeightedNotRepeated) {
  const AnswersTable table = test::clustered_table();
  const MixedData data = mixed_data(table, table.groups.back());
  MixedData spread;
  spread.demonstrations = data.demonstrations;
  for (const Pattern& pattern : data.patterns) {
    for (int i = 0; i < static_cast<int>(pattern.participants); ++i)
      spread.patterns.push_back({pattern.cells, 1.0});
  }
  const MixedParameters parameters{0.8, 0.6, 0.4};
  EXPECT_NEAR(laplace_deviance(data, parameters), laplace_deviance(spread, parameters), 1e-8);
}

TEST(MixedModel, SwappingTheMethodsFlipsTheIntercept) {
  const AnswersTable table = test::clustered_table();
  MixedData data = mixed_data(table, table.groups.back());
  const MixedModel model = fit_mixed_model(data, 0.05);
  for (Pattern& pattern : data.patterns) {
    for (Cell& cell : pattern.cells)
      cell.pinch = static_cast<std::uint16_t>(cell.answers - cell.pinch);
  }
  const MixedModel swapped = fit_mixed_model(data, 0.05);
  EXPECT_NEAR(model.intercept.value, -swapped.intercept.value, 1e-4);
  EXPECT_NEAR(model.intercept_low.value, -swapped.intercept_high.value, 1e-4);
  EXPECT_NEAR(model.p.value, swapped.p.value, 1e-6);
}

// Each of these was reported as a number once: intercepts of 4 to 37 log-odds, p down to 1e-7.
TEST(MixedModel, DivergentAndSeparatedFitsAreNotEstimable) {
  const auto fit = [](int participants, int demonstrations, auto pinch) {
    MixedData data;
    data.demonstrations = static_cast<size_t>(demonstrations);
    for (int i = 0; i < participants; ++i) {
      Pattern pattern;
      for (int j = 0; j < demonstrations; ++j) {
        pattern.cells.push_back(
            {static_cast<std::uint16_t>(j), 1, static_cast<std::uint16_t>(pinch(i, j) ? 1 : 0)});
      }
      data.patterns.push_back(pattern);
    }
    return fit_mixed_model(data, 0.05);
  };
  const auto refused = [](const MixedModel& model) {
    for (const Estimate* value :
         {&model.intercept, &model.intercept_low, &model.intercept_high, &model.p,
          &model.sd_participant, &model.sd_demonstration, &model.mean_share, &model.deviance}) {
      if (*value || value->why_not.empty()) return false;
    }
    return true;
  };
  EXPECT_TRUE(refused(fit(16, 8, [](int i, int) { return i < 10; })));  // unanimous participants
  EXPECT_TRUE(refused(fit(16, 8, [](int, int j) { return j < 5; })));   // unanimous demonstrations
  EXPECT_TRUE(refused(fit(8, 8, [](int i, int j) { return i + j < 9; })));
  EXPECT_TRUE(refused(fit(16, 8, [](int i, int j) { return i != 3 || j != 2; })));
  EXPECT_TRUE(refused(fit(2, 2, [](int i, int j) { return i > 0 || j > 0; })));
}

TEST(MixedModel, SaysWhyItCannotBeEstimated) {
  const auto reason = [](const std::string& rows) {
    const AnswersTable table = test::table_of("participant,demonstration,choice\n" + rows);
    return fit_mixed_model(mixed_data(table, table.groups.back()), 0.05).intercept.why_not;
  };
  EXPECT_NE(reason("a,1,pinch\na,2,cable\n").find("one participant"), std::string::npos);
  EXPECT_NE(reason("a,1,pinch\nb,1,cable\n").find("one demonstration"), std::string::npos);
  EXPECT_NE(reason("a,1,pinch\na,2,pinch\nb,1,pinch\nb,2,pinch\n").find("every answer is the same"),
            std::string::npos);
  const AnswersTable counts = test::table_of(test::thesis_counts_csv());
  EXPECT_NE(fit_mixed_model(mixed_data(counts, counts.groups.back()), 0.05)
                .intercept.why_not.find("counts"),
            std::string::npos);
}

}  // namespace
}  // namespace pinchlab::analysis
