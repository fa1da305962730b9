// SPDX-License-Identifier: GPL-3.0-or-later
// Scales of three methods and more.
#include "analysis/scale_model.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>

#include <cmath>
#include <numbers>

#include "analysis/gsl_support.h"
#include "analysis/scale_tests.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

// Values with the first method at 0, as R gives them, and their standard errors.
std::vector<double> against_first(const ScaleFit& fit) {
  std::vector<double> values;
  for (size_t i = 1; i < fit.values.size(); ++i) values.push_back(fit.values[i] - fit.values[0]);
  return values;
}

std::vector<double> errors_against_first(const ScaleFit& fit, const Matrix& covariance) {
  std::vector<double> errors;
  for (size_t i = 1; i < fit.values.size(); ++i) {
    errors.push_back(
        std::sqrt(covariance.at(i, i) + covariance.at(0, 0) - 2 * covariance.at(i, 0)));
  }
  return errors;
}

void expect_near(const std::vector<double>& ours, const std::vector<double>& theirs,
                 double digits) {
  ASSERT_EQ(ours.size(), theirs.size());
  for (size_t i = 0; i < ours.size(); ++i)
    EXPECT_NEAR(ours[i], theirs[i], std::abs(theirs[i]) * digits) << i;
}

// Stigler's citations (Statistical Science 9 (1994) 94), `citations` of R's BradleyTerry2:
// Biometrika, Comm Statist, JASA, JRSS-B. Cited by others is a win.
const std::vector<PairChoices> citations = {{0, 0, 0, 1, 730, 33, 0},  {0, 0, 0, 2, 498, 320, 0},
                                            {0, 0, 0, 3, 221, 284, 0}, {0, 0, 1, 2, 68, 813, 0},
                                            {0, 0, 1, 3, 17, 276, 0},  {0, 0, 2, 3, 142, 325, 0}};

// Figures of BTm of BradleyTerry2 1.1-2 (R 4.2), the first three also printed in its documentation.
TEST(ScaleModel, AgreesWithBradleyTerry2OnCitations) {
  const ScaleFit fit = fit_scale(ScaleModel::bradley_terry, 4, citations);
  ASSERT_EQ(fit.why_not, "");
  expect_near(against_first(fit), {-2.949072496844, -0.479569769752, 0.268954055819}, 1e-9);
  expect_near(errors_against_first(fit, fit.covariance),
              {0.1025453353699, 0.0605887292396, 0.0708299651057}, 1e-6);
  EXPECT_NEAR(fit.deviance, 4.29338396989, 1e-9);
  EXPECT_EQ(fit.df, 3);
  EXPECT_EQ(fit.robust.size, 0U);
  EXPECT_NEAR(fit.values[0] + fit.values[1] + fit.values[2] + fit.values[3], 0.0, 1e-12);
}

TEST(ScaleModel, AgreesWithRsProbitOnCitations) {
  const ScaleFit fit = fit_scale(ScaleModel::thurstone, 4, citations);
  ASSERT_EQ(fit.why_not, "");
  std::vector<double> r = {-1.674693680578, -0.289913264107, 0.159117072930};
  for (double& value : r) value *= std::numbers::sqrt2;
  expect_near(against_first(fit), r, 1e-7);  // R's glm stops at a deviance of 1e-8
  EXPECT_NEAR(fit.deviance, 6.41197463551, 1e-8);
}

// Agresti, Categorical Data Analysis (2002), 10.6; `baseball` of BradleyTerry2. Baltimore, Boston,
// Cleveland, Detroit, Milwaukee, New York, Toronto; home, away, wins at home, wins of the guests.
const std::vector<PairChoices> baseball = {
    {0, 0, 4, 3, 4, 3, 0}, {0, 0, 4, 6, 4, 2, 0}, {0, 0, 4, 5, 4, 3, 0}, {0, 0, 4, 1, 6, 1, 0},
    {0, 0, 4, 2, 4, 2, 0}, {0, 0, 4, 0, 6, 0, 0}, {0, 0, 3, 4, 3, 3, 0}, {0, 0, 3, 6, 4, 2, 0},
    {0, 0, 3, 5, 4, 3, 0}, {0, 0, 3, 1, 6, 0, 0}, {0, 0, 3, 2, 6, 1, 0}, {0, 0, 3, 0, 4, 3, 0},
    {0, 0, 6, 4, 2, 5, 0}, {0, 0, 6, 3, 4, 3, 0}, {0, 0, 6, 5, 2, 4, 0}, {0, 0, 6, 1, 4, 3, 0},
    {0, 0, 6, 2, 4, 2, 0}, {0, 0, 6, 0, 6, 0, 0}, {0, 0, 5, 4, 3, 3, 0}, {0, 0, 5, 3, 5, 1, 0},
    {0, 0, 5, 6, 2, 5, 0}, {0, 0, 5, 1, 4, 3, 0}, {0, 0, 5, 2, 4, 2, 0}, {0, 0, 5, 0, 6, 1, 0},
    {0, 0, 1, 4, 5, 1, 0}, {0, 0, 1, 3, 2, 5, 0}, {0, 0, 1, 6, 3, 3, 0}, {0, 0, 1, 5, 4, 2, 0},
    {0, 0, 1, 2, 5, 2, 0}, {0, 0, 1, 0, 6, 0, 0}, {0, 0, 2, 4, 2, 5, 0}, {0, 0, 2, 3, 3, 3, 0},
    {0, 0, 2, 6, 3, 4, 0}, {0, 0, 2, 5, 4, 3, 0}, {0, 0, 2, 1, 4, 2, 0}, {0, 0, 2, 0, 2, 4, 0},
    {0, 0, 0, 4, 2, 5, 0}, {0, 0, 0, 3, 1, 5, 0}, {0, 0, 0, 6, 1, 6, 0}, {0, 0, 0, 5, 2, 4, 0},
    {0, 0, 0, 1, 1, 6, 0}, {0, 0, 0, 2, 3, 4, 0}};

TEST(ScaleModel, AgreesWithBradleyTerry2OnBaseball) {
  const ScaleFit plain = fit_scale(ScaleModel::bradley_terry, 7, baseball);
  ASSERT_EQ(plain.why_not, "");
  expect_near(against_first(plain),
              {1.107697705372, 0.683852769153, 1.436408431806, 1.581355876655, 1.247617845135,
               1.294485123905},
              1e-8);
  EXPECT_NEAR(plain.deviance, 44.0534612286, 1e-8);
  EXPECT_EQ(plain.df, 36);
  const ScaleFit home = fit_scale(ScaleModel::bradley_terry, 7, baseball, true);
  ASSERT_EQ(home.why_not, "");
  expect_near(against_first(home),
              {1.143802653297, 0.704694456900, 1.475357213586, 1.619554993578, 1.281340403276,
               1.327110398072},
              1e-8);
  EXPECT_NEAR(home.side.value, 0.302260655528, 1e-9);
  EXPECT_NEAR(home.side_se.value, 0.130943642532, 1e-6);
  EXPECT_NEAR(home.deviance, 38.642852144, 1e-8);
}

// Six brands of pudding (Davidson 1970, table 3): R's glm of the log-linear form of his model.
TEST(ScaleModel, TiesAgreeWithRsLogLinearDavidsonModel) {
  const std::vector<PairChoices> pudding = {
      {0, 0, 0, 1, 19, 22, 16}, {0, 0, 0, 2, 16, 19, 12}, {0, 0, 1, 2, 19, 19, 10},
      {0, 0, 0, 3, 18, 23, 13}, {0, 0, 1, 3, 23, 19, 9},  {0, 0, 2, 3, 19, 20, 15},
      {0, 0, 0, 4, 13, 19, 18}, {0, 0, 1, 4, 16, 20, 12}, {0, 0, 2, 4, 16, 15, 17},
      {0, 0, 3, 4, 17, 14, 16}, {0, 0, 0, 5, 18, 21, 12}, {0, 0, 1, 5, 22, 20, 12},
      {0, 0, 2, 5, 13, 18, 10}, {0, 0, 3, 5, 14, 19, 18}, {0, 0, 4, 5, 11, 21, 12}};
  const ScaleFit fit = fit_scale(ScaleModel::bradley_terry, 6, pudding);
  ASSERT_EQ(fit.why_not, "");
  expect_near(against_first(fit),
              {0.220241900241, 0.152977704854, 0.175144908590, 0.133865226991, 0.377134895802},
              1e-9);
  expect_near(errors_against_first(fit, fit.covariance),
              {0.187216981622, 0.193518358125, 0.188211087234, 0.192704560790, 0.192406233636},
              1e-9);
  EXPECT_NEAR(std::log(fit.tie.value), -0.291927086248, 1e-9);
  EXPECT_NEAR(fit.deviance, 15.7704057795, 1e-8);
  // The same choices under Glenn and David's model give the same order.
  const ScaleFit normal = fit_scale(ScaleModel::thurstone, 6, pudding);
  ASSERT_EQ(normal.why_not, "");
  EXPECT_GT(normal.tie.value, 0.0);
  for (size_t i = 0; i < 6; ++i) {
    for (size_t j = 0; j < 6; ++j)
      EXPECT_EQ(fit.values[i] < fit.values[j], normal.values[i] < normal.values[j]);
  }
}

TEST(ScaleModel, SaysWhyThereIsNoScale) {
  const ScaleFit never =
      fit_scale(ScaleModel::bradley_terry, 3, {{0, 0, 0, 1, 5, 4, 0}, {0, 0, 0, 2, 5, 0, 0}});
  EXPECT_NE(never.why_not.find("never chosen"), std::string::npos);
  const ScaleFit parted =
      fit_scale(ScaleModel::bradley_terry, 4, {{0, 0, 0, 1, 5, 4, 0}, {0, 0, 2, 3, 5, 4, 0}});
  EXPECT_NE(parted.why_not.find("never compared"), std::string::npos) << parted.why_not;
  // Each pair in one order only, along a line: the sides are part of the methods' differences.
  const ScaleFit sides =
      fit_scale(ScaleModel::bradley_terry, 3, {{0, 0, 0, 1, 5, 4, 0}, {0, 0, 1, 2, 5, 3, 0}}, true);
  EXPECT_NE(sides.why_not.find("sides"), std::string::npos) << sides.why_not;
}

// A scale with ties is finite where a circle of choices has more wins than ties.
TEST(ScaleModel, TiesThatNoChoicesContradictHaveNoScale) {
  for (const ScaleModel model : {ScaleModel::bradley_terry, ScaleModel::thurstone}) {
    const auto why = [&](std::size_t methods, const std::vector<PairChoices>& choices) {
      return fit_scale(model, methods, choices).why_not;
    };
    const PairChoices win{0, 0, 0, 1, 5, 0, 0}, next{0, 0, 1, 2, 5, 0, 0};
    EXPECT_NE(why(2, {{0, 0, 0, 1, 0, 0, 7}}).find("contradict"), std::string::npos);
    EXPECT_NE(why(2, {{0, 0, 0, 1, 5, 0, 7}}).find("contradict"), std::string::npos);
    EXPECT_EQ(why(2, {{0, 0, 0, 1, 5, 1, 7}}), "");
    // Twice ahead of a tie it is finite, once it is not.
    EXPECT_EQ(why(3, {win, next, {0, 0, 0, 2, 0, 0, 7}}), "");
    EXPECT_NE(why(3, {win, {0, 0, 1, 2, 0, 0, 7}, {0, 0, 0, 2, 0, 0, 7}}).find("contradict"),
              std::string::npos);
  }
}

// Kendall and Babington Smith (1940), their table of frequencies.
TEST(ScaleTests, CircularTriadsHaveThePublishedFrequencies) {
  EXPECT_EQ(triad_counts(3), (std::vector<double>{6, 2}));
  EXPECT_EQ(triad_counts(4), (std::vector<double>{24, 16, 24}));
  EXPECT_EQ(triad_counts(5), (std::vector<double>{120, 120, 240, 240, 280, 24}));
  EXPECT_EQ(triad_counts(6),
            (std::vector<double>{720, 960, 2240, 2880, 6240, 3648, 8640, 4800, 2640}));
}

// A dog's choices among six kinds of food (Kendall, Rank Correlation Methods; `circular` of R's
// eba).
TEST(ScaleTests, CountsTheDogsCircularTriads) {
  const int dog[6][6] = {{0, 1, 1, 0, 1, 1}, {0, 0, 0, 1, 1, 0}, {0, 1, 0, 1, 1, 1},
                         {1, 0, 0, 0, 0, 0}, {0, 0, 0, 1, 0, 1}, {0, 1, 0, 1, 0, 0}};
  std::vector<PairChoices> choices;
  for (std::uint16_t i = 0; i < 6; ++i) {
    for (std::uint16_t j = i + 1; j < 6; ++j) {
      choices.push_back({0, 0, i, j, dog[i][j], dog[j][i], 0});
    }
  }
  // Counted one by one, not by the wins.
  long triads = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      for (int k = 0; k < 6; ++k)
        triads += i < j && i < k && dog[i][j] == 1 && dog[j][k] == 1 && dog[k][i] == 1 ? 1 : 0;
    }
  }
  const Transitivity result = transitivity(6, 1, 1, choices);
  EXPECT_EQ(result.rounds, 1);
  EXPECT_EQ(result.triads, triads);
  EXPECT_NEAR(result.consistence.value, 1 - static_cast<double>(triads) / 8, 1e-12);
  double so_few = 0.0;
  const std::vector<double> all = triad_counts(6);
  for (long i = 0; i <= triads; ++i) so_few += all[static_cast<size_t>(i)] / 32768;
  EXPECT_NEAR(result.p.value, so_few, 1e-12);
}

// The score test of equal scales of a balanced design is the sum of squares of Durbin and of
// Bradley and Terry (1952): 4 sum (wins - mean)^2 / (n m) for n rounds of all pairs.
TEST(ScaleTests, EqualScaleIsDurbinsStatistic) {
  const std::vector<PairChoices> choices = {{0, 0, 0, 1, 12, 3, 0}, {0, 0, 0, 2, 13, 2, 0},
                                            {0, 0, 0, 3, 13, 2, 0}, {0, 0, 1, 2, 4, 11, 0},
                                            {0, 0, 1, 3, 12, 3, 0}, {0, 0, 2, 3, 10, 5, 0}};
  const double wins[] = {38, 19, 23, 10};
  double squares = 0.0;
  for (const double w : wins) squares += (w - 22.5) * (w - 22.5);
  const EqualScale result = equal_scale(4, choices, 1, 999);
  EXPECT_NEAR(result.score, 4 * squares / (15 * 4), 1e-9);
  EXPECT_EQ(result.df, 3);
  EXPECT_FALSE(result.p_sign_flip);
}

// Two pairs that nothing connects: each is a binomial score test of its own, (190 - 10)^2 / 200 and
// 0. Of methods that are tied with the others always, nothing is compared.
TEST(ScaleTests, PartsOfMethodsAreEachATest) {
  const EqualScale parts =
      equal_scale(4, {{0, 0, 0, 1, 190, 10, 0}, {0, 0, 2, 3, 100, 100, 0}}, 1, 99);
  EXPECT_NEAR(parts.score, 162.0, 1e-9);
  EXPECT_EQ(parts.df, 2);
  EXPECT_LT(parts.p_chi_square.value, 1e-30);
  const EqualScale tied = equal_scale(
      3, {{0, 0, 0, 1, 190, 10, 5}, {0, 0, 0, 2, 0, 0, 50}, {0, 0, 1, 2, 0, 0, 50}}, 1, 99);
  EXPECT_NEAR(tied.score, 162.0, 1e-9);
  EXPECT_EQ(tied.df, 1);
  const EqualScale nothing = equal_scale(2, {{0, 0, 0, 1, 0, 0, 50}}, 1, 99);
  EXPECT_FALSE(nothing.p_chi_square);
  EXPECT_FALSE(nothing.p_sign_flip);
}

TEST(ScaleTests, StochasticTransitivity) {
  // a over b .6, b over c .7, a over c .65: weak and moderate hold, strong does not.
  Transitivity result = transitivity(
      3, 0, 1, {{0, 0, 0, 1, 60, 40, 0}, {0, 0, 1, 2, 70, 30, 0}, {0, 0, 0, 2, 65, 35, 0}});
  EXPECT_EQ(result.triples, 1);
  EXPECT_EQ(result.weak, 0);
  EXPECT_EQ(result.moderate, 0);
  EXPECT_EQ(result.strong, 1);
  result = transitivity(
      3, 0, 1, {{0, 0, 0, 1, 60, 40, 0}, {0, 0, 1, 2, 70, 30, 0}, {0, 0, 0, 2, 35, 65, 0}});
  EXPECT_EQ(result.weak, 1);
}

// Participants with scales of their own about a common one: four methods, `demonstrations` rounds
// of all pairs.
std::vector<PairChoices> simulated(std::uint64_t seed, int participants, int demonstrations,
                                   const std::vector<double>& truth, double spread,
                                   double side = 0.0) {
  const Rng rng = make_rng(RandomUse::study, seed);
  std::vector<PairChoices> choices;
  for (int p = 0; p < participants; ++p) {
    std::vector<double> own = truth;
    for (double& value : own) value += gsl_ran_gaussian(rng.get(), spread);
    for (int d = 0; d < demonstrations; ++d) {
      for (std::uint16_t i = 0; i < truth.size(); ++i) {
        for (std::uint16_t j = i + 1; j < truth.size(); ++j) {
          const bool turned = gsl_rng_uniform_int(rng.get(), 2) == 1;
          const std::uint16_t left = turned ? j : i, right = turned ? i : j;
          const bool is_left =
              gsl_rng_uniform(rng.get()) < 1 / (1 + std::exp(-(own[left] - own[right] + side)));
          choices.push_back({static_cast<std::uint32_t>(p), static_cast<std::uint16_t>(d), left,
                             right, is_left ? 1 : 0, is_left ? 0 : 1, 0});
        }
      }
    }
  }
  return choices;
}

// 1000 studies of 40 participants whose scales differ: the robust interval of a difference holds
// the truth of the population (the average choice, found from very many participants), the one that
// takes answers as independent does not.
TEST(ScaleModel, RobustIntervalsHoldTheTruth) {
  const std::vector<double> truth = {0.6, 0.2, -0.1, -0.7};
  const double spread = 0.6;
  const ScaleFit population =
      fit_scale(ScaleModel::bradley_terry, 4, simulated(1, 40000, 1, truth, spread));
  const double difference = population.values[0] - population.values[3];
  int robust = 0, naive = 0;
  const double t = gsl_cdf_tdist_Qinv(0.025, 39);
  constexpr int studies = 1000;
  for (int i = 0; i < studies; ++i) {
    const ScaleFit fit =
        fit_scale(ScaleModel::bradley_terry, 4,
                  simulated(static_cast<std::uint64_t>(100 + i), 40, 4, truth, spread));
    const auto error = [&](const Matrix& c) {
      return std::sqrt(c.at(0, 0) + c.at(3, 3) - 2 * c.at(0, 3));
    };
    const double off = std::abs(fit.values[0] - fit.values[3] - difference);
    robust += off <= t * error(fit.robust) ? 1 : 0;
    naive += off <= 1.96 * error(fit.covariance) ? 1 : 0;
  }
  RecordProperty("robust_coverage_percent", robust / 10);
  EXPECT_GE(robust, 930);
  EXPECT_LE(robust, 970);
  EXPECT_LT(naive, 880);
}

// Without any difference between methods, at participants who differ much, and the test that takes
// answers as independent beside it.
TEST(ScaleTests, SignFlipsKeepTheirLevel) {
  int flips = 0, chi_square = 0, demonstrations = 0;
  constexpr int studies = 400;
  for (int i = 0; i < studies; ++i) {
    const std::vector<PairChoices> choices =
        simulated(static_cast<std::uint64_t>(9000 + i), 24, 4, {0, 0, 0}, 0.8);
    const EqualScale result = equal_scale(3, choices, 1, 499);
    flips += result.p_sign_flip.value <= 0.05 ? 1 : 0;
    chi_square += result.p_chi_square.value <= 0.05 ? 1 : 0;
    const ScaleFit fit = fit_scale(ScaleModel::bradley_terry, 3, choices);
    demonstrations +=
        scale_difference(ScaleModel::bradley_terry, fit, 3, 4, choices, 1, 199).p.value <= 0.05;
  }
  // Binomial limits of 0.05 at 400: 8 to 34 (p = 1e-3 on each side).
  EXPECT_GE(flips, 8);
  EXPECT_LE(flips, 34);
  EXPECT_GE(demonstrations, 8);
  EXPECT_LE(demonstrations, 34);
  EXPECT_GT(chi_square, 60);
}

TEST(ScaleTests, FindsDemonstrationsThatDiffer) {
  std::vector<PairChoices> choices = simulated(5, 24, 2, {0.8, 0, -0.8}, 0.3);
  for (PairChoices& pair : choices) {
    if (pair.demonstration == 1) std::swap(pair.left_wins, pair.right_wins);
  }
  const ScaleFit fit = fit_scale(ScaleModel::bradley_terry, 3, choices);
  EXPECT_LT(scale_difference(ScaleModel::bradley_terry, fit, 3, 2, choices, 1, 999).p.value, 0.01);
}

TEST(ScaleTests, FindsWhoChoosesTheOtherWayRound) {
  std::vector<PairChoices> choices = simulated(6, 20, 4, {1.2, 0.4, -0.4, -1.2}, 0.2);
  for (PairChoices& pair : choices) {
    if (pair.participant == 7) std::swap(pair.left_wins, pair.right_wins);
  }
  int far_out = 0;
  for (const ObserverFit& fit : observer_fits(ScaleModel::bradley_terry, 4, 20, choices)) {
    far_out += fit.is_far_out ? 1 : 0;
    EXPECT_TRUE(fit.participant != 7 || fit.is_far_out);
  }
  EXPECT_LE(far_out, 2);
}

// A scale of others who never saw a tie says nothing of how likely one is.
TEST(Observers, TiesOfOneParticipantAreHeldAgainstNobody) {
  std::vector<PairChoices> choices = simulated(6, 20, 4, {1.2, 0.4, -0.4, -1.2}, 0.0);
  for (PairChoices& pair : choices) {
    if (pair.participant == 7) pair = {7, pair.demonstration, pair.left, pair.right, 0, 0, 1};
  }
  for (const ScaleModel model : {ScaleModel::bradley_terry, ScaleModel::thurstone}) {
    for (const ObserverFit& fit : observer_fits(model, 4, 20, choices)) {
      EXPECT_EQ(fit.log_likelihood.why_not, fit.participant != 7
                                                ? ""
                                                : "the other participants gave no ties, by which "
                                                  "to tell how likely those of this one are");
      EXPECT_TRUE(fit.participant != 7 || !fit.is_far_out);
    }
  }
}

TEST(ScaleModel, FindsTheSide) {
  const ScaleFit fit =
      fit_scale(ScaleModel::bradley_terry, 3, simulated(8, 400, 2, {0.5, 0, -0.5}, 0.0, 0.4), true);
  EXPECT_NEAR(fit.side.value, 0.4, 3 * fit.side_se.value);
  EXPECT_LT(fit.side_se.value, 0.06);
}

}  // namespace
}  // namespace pinchlab::analysis
