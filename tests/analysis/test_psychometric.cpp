// SPDX-License-Identifier: GPL-3.0-or-later
// Psychometric functions: against R, against a fine quadrature, and on studies of a known truth.
#include <cmath>

#include "analysis/threshold_report.h"
#include "analysis/threshold_study.h"
#include "base/input_error.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

using nlohmann::json;
using test::TemporaryFolder;

// The example data of psignifit's first demonstration (Schütt, Harmeling, Macke and Wichmann 2016):
// two-alternative forced choice, 90 trials at each level.
const std::vector<double> example_levels{.0010, .0015, .0020, .0025, .0030, .0035, .0040,
                                         .0045, .0050, .0060, .0070, .0080, .0100};
const std::vector<int> example_hits{45, 50, 44, 44, 52, 53, 62, 64, 76, 79, 88, 90, 90};

std::vector<Observer> example() {
  Observer observer;
  for (size_t i = 0; i < example_levels.size(); ++i)
    observer.cells.push_back({example_levels[i], 90, example_hits[i]});
  return {observer};
}

std::string example_csv() {
  std::string csv = "level,correct,trials\n";
  for (size_t i = 0; i < example_levels.size(); ++i)
    csv += fmt::format("{},{},90\n", example_levels[i], example_hits[i]);
  return csv;
}

void expect_digits(double value, double reference) {
  EXPECT_NEAR(value, reference, 2e-6 * std::abs(reference));
}

struct Reference {
  Shape shape;
  double threshold, width, deviance, slope;
};

// R 4.2: optim() on the same likelihood (thresholds, widths, deviances), and slopes of
// glm(cbind(hits, misses) ~ level, binomial(mafc.probit(2))), mafc.logit(2) and mafc.weib(2) with
// the logarithm of the level of package psyphy 0.2-3, whose deviances are the same.
class ExampleOfPsignifit : public testing::TestWithParam<Reference> {};

TEST_P(ExampleOfPsignifit, AgreesWithR) {
  const Reference& reference = GetParam();
  PsychometricModel model;
  model.shape = reference.shape;
  const PsychometricFit fit = fit_psychometric(model, example(), {.resamples = 0});
  expect_digits(fit.threshold.value, reference.threshold);
  expect_digits(fit.width.value, reference.width);
  expect_digits(fit.deviance.value, reference.deviance);
  expect_digits(fit.slope.value, reference.slope);
  EXPECT_LT(fit.lapse.value, 1e-6);
  EXPECT_FALSE(fit.spread);
  EXPECT_FALSE(fit.p_deviance);
  // The bounds lie where the profile says: nothing else was minimised over at these points.
  EXPECT_LT(fit.threshold_low.value, fit.threshold.value);
  EXPECT_GT(fit.threshold_high.value, fit.threshold.value);
}

INSTANTIATE_TEST_SUITE_P(
    Functions, ExampleOfPsignifit,
    testing::Values(Reference{Shape::normal, 4.64781686e-3, 4.65907198e-3, 5.93281305, 706.08643},
                    Reference{Shape::logistic, 4.63323308e-3, 4.81690380e-3, 7.09527732, 1222.5446},
                    Reference{Shape::weibull, 4.66591153e-3, 1.10863116, 5.74309079, 3.66883384}));

// The figures that psignifit's own test of this example holds (python-psignifit,
// tests/test_psignifit.py): the mode of a posterior with weak priors and room for overdispersion,
// which lies beside the maximum of the likelihood. Within 1 %, as psignifit compares its versions.
TEST(ExampleOfPsignifitItself, LiesBesideItsPosteriorMode) {
  PsychometricModel model;
  model.shape = Shape::normal;
  const PsychometricFit fit = fit_psychometric(model, example(), {.resamples = 0});
  EXPECT_NEAR(fit.threshold.value / 0.0046448472488663396, 1.0, 0.01);
  EXPECT_NEAR(fit.width.value / 0.004683837353547434, 1.0, 0.01);
  EXPECT_NEAR(fit.lapse.value, 1.0676339572811912e-07, 1e-4);
}

// At a bound of the threshold, the best of the other parameters is 3.841 / 2 above the minimum.
TEST(Profile, BoundsAreWhereTheLikelihoodSaysThey) {
  PsychometricModel model;
  const PsychometricFit fit = fit_psychometric(model, example(), {.resamples = 0});
  const double best = psychometric_deviance(model, example(), fit.curve, 0.0);
  for (double bound : {fit.threshold_low.value, fit.threshold_high.value}) {
    double lowest = 1e300;
    for (int i = 0; i <= 400; ++i) {
      for (double lapse : {0.0, 0.0005, 0.001, 0.0015, 0.002, 0.003, 0.004, 0.006, 0.01}) {
        const Curve curve{bound, fit.curve.width * std::exp(0.002 * (i - 200)), 0.5, lapse};
        lowest = std::min(lowest, psychometric_deviance(model, example(), curve, 0.0));
      }
    }
    EXPECT_NEAR(lowest - best, 3.841459, 2e-3);
  }
}

// The integral over the participants' thresholds, by a fine grid.
TEST(RandomThresholds, QuadratureIsTheIntegral) {
  for (Shape shape : {Shape::logistic, Shape::normal, Shape::weibull}) {
    PsychometricModel model;
    model.shape = shape;
    const std::vector<Observer> observers{
        {"a", {{0.5, 10, 4}, {1.0, 10, 6}, {1.5, 10, 9}, {2.0, 10, 10}}}};
    const Curve curve{shape == Shape::weibull ? 0.1 : 1.2, 0.9, 0.5, 0.03};
    constexpr double spread = 0.3;
    double integral = 0.0;
    for (int i = -8000; i <= 8000; ++i) {
      const double z = 1e-3 * i;
      Curve moved = curve;
      moved.threshold += spread * z;
      integral +=
          1e-3 *
          std::exp(-0.5 * psychometric_deviance(model, observers, moved, 0.0) - 0.5 * z * z) /
          std::sqrt(2.0 * M_PI);
    }
    EXPECT_NEAR(psychometric_deviance(model, observers, curve, spread), -2.0 * std::log(integral),
                2e-4);
  }
}

TEST(Recovery, TruthIsFoundAndIntervalsHoldItAsOftenAsTheySay) {
  const ThresholdCondition one{Shape::logistic, 1, 7, 60, {0.1, 1.2, 0.5, 0.02}, 0.0};
  constexpr int studies = 400;
  const Recovery result = recovery(one, studies, {.resamples = 0, .seed = 7});
  const double limit = 3.0 * std::sqrt(0.05 * 0.95 / studies);
  EXPECT_EQ(result.not_estimable, 0);
  EXPECT_LT(result.without_slope, studies / 20);
  EXPECT_NEAR(result.bias, 0.0, 0.02);
  EXPECT_NEAR(result.threshold_coverage, 0.95, limit);
  EXPECT_NEAR(result.slope_coverage, 0.95, limit);
}

TEST(Recovery, ParticipantsAreRandomEffects) {
  const ThresholdCondition many{Shape::logistic, 12, 5, 12, {0.0, 1.0, 0.5, 0.02}, 0.3};
  const Recovery result = recovery(many, 60, {.resamples = 0, .seed = 8});
  EXPECT_NEAR(result.bias, 0.0, 4.0 * 0.12 / std::sqrt(60.0));
  EXPECT_NEAR(result.mean_spread, 0.3, 0.06);
  EXPECT_GE(result.threshold_coverage, 0.86);  // of 60
}

TEST(Fit, SameSeedSameNumbersAndGoodnessOfFit) {
  const PsychometricFit a = fit_psychometric({}, example(), {.resamples = 199, .seed = 3});
  const PsychometricFit b = fit_psychometric({}, example(), {.resamples = 199, .seed = 3});
  EXPECT_EQ(a.bootstrap_threshold_low.value, b.bootstrap_threshold_low.value);
  EXPECT_EQ(a.p_deviance.value, b.p_deviance.value);
  EXPECT_GT(a.p_deviance.value, 0.3);  // a deviance of 7.1 with about 11 degrees of freedom
  EXPECT_LT(a.bootstrap_threshold_low.value, a.threshold.value);
  // Answers that alternate between the levels are none of the function's.
  std::vector<Observer> zigzag = example();
  for (size_t i = 0; i < zigzag[0].cells.size(); ++i) zigzag[0].cells[i].hits = i % 2 ? 88 : 55;
  EXPECT_LE(fit_psychometric({}, zigzag, {.resamples = 199}).p_deviance.value, 0.01);
}

// Of 39 resamples alpha / 2 leaves the (40 alpha / 2)-th of either end in, and never none: at 0.05,
// and at less, the bounds are the smallest and the largest.
TEST(Fit, BootstrapBoundsAreOrderedResamples) {
  const auto bounds_at = [](double alpha) {
    const PsychometricFit fit =
        fit_psychometric({}, example(), {.alpha = alpha, .resamples = 39, .seed = 3});
    return std::pair(fit.bootstrap_threshold_low.value, fit.bootstrap_threshold_high.value);
  };
  const auto [low, high] = bounds_at(0.05);
  EXPECT_EQ(bounds_at(0.049), std::pair(low, high));
  EXPECT_EQ(bounds_at(0.01), std::pair(low, high));
  const auto [second, last_but_one] = bounds_at(0.1);
  EXPECT_GT(second, low);
  EXPECT_LT(last_but_one, high);
  EXPECT_EQ(bounds_at(0.149), std::pair(second, last_but_one));
}

TEST(Fit, ThresholdMayStandAtAnotherHeight) {
  PsychometricModel model;
  const PsychometricFit half = fit_psychometric(model, example(), {.resamples = 0});
  model.threshold_at = 0.8;
  const PsychometricFit higher = fit_psychometric(model, example(), {.resamples = 0});
  // logit(0.8) = ln 4 further up, in units of 1 / slope.
  EXPECT_NEAR(higher.threshold.value, half.threshold.value + std::log(4.0) / half.slope.value,
              1e-7);
  EXPECT_NEAR(higher.deviance.value, half.deviance.value, 1e-5);
}

TEST(Fit, FreeGuessesAreFoundWhereChoicesAreNotForced) {
  PsychometricModel model;
  model.guess = {true, 0.0, 0.5};
  Observer observer;
  const Curve truth{0.0, 1.0, 0.2, 0.0};
  for (int i = 0; i < 9; ++i) {
    const double level = -1.5 + 0.375 * i;
    observer.cells.push_back({level, 1000000, std::llround(1e6 * psi(model, truth, level))});
  }
  const PsychometricFit fit = fit_psychometric(model, {observer}, {.resamples = 0});
  EXPECT_NEAR(fit.guess.value, 0.2, 1e-3);
  EXPECT_NEAR(fit.threshold.value, 0.0, 1e-3);
  EXPECT_NEAR(fit.width.value, 1.0, 3e-3);
}

TEST(Fit, SaysWhatItCannotTell) {
  const auto fit = [](std::vector<LevelCell> cells) {
    return fit_psychometric({}, {{"", std::move(cells)}}, {.resamples = 0});
  };
  EXPECT_NE(fit({{1, 9, 5}, {2, 9, 9}}).threshold.why_not.find("three levels"), std::string::npos);
  EXPECT_NE(fit({{1, 9, 9}, {2, 9, 9}, {3, 9, 9}}).threshold.why_not.find("same"),
            std::string::npos);
  EXPECT_NE(fit({{1, 90, 85}, {2, 90, 70}, {3, 90, 50}}).threshold.why_not.find("falls"),
            std::string::npos);
  const PsychometricFit chance = fit({{1, 90, 45}, {2, 90, 45}, {3, 90, 45}});
  EXPECT_FALSE(chance.threshold_low && chance.threshold_high);
  // From guessing to certainty between two levels: a threshold there, and no slope.
  const PsychometricFit jump =
      fit({{1, 90, 45}, {2, 90, 45}, {3, 90, 45}, {4, 90, 90}, {5, 90, 90}, {6, 90, 90}});
  EXPECT_GE(jump.threshold.value, 3.0);
  EXPECT_LE(jump.threshold.value, 4.0);
  EXPECT_FALSE(jump.slope_high);
}

// From 1/2 to 1 between two levels: the likelihood rises with the slope for ever, and is the same
// for every threshold between the two.
TEST(Fit, AJumpHasNoSlope) {
  const std::vector<Observer> totals = {{"", {{0.1, 20, 10}, {0.2, 20, 10}, {0.3, 20, 20}}}};
  const PsychometricFit jump = fit_psychometric({}, totals, {.resamples = 39});
  for (const Estimate& none : {jump.slope, jump.width, jump.slope_high, jump.bootstrap_slope_low,
                               jump.bootstrap_slope_high, jump.bootstrap_threshold_low}) {
    EXPECT_FALSE(none) << none.value;
  }
  EXPECT_NE(jump.slope.why_not.find("jump"), std::string::npos);
  EXPECT_NEAR(jump.threshold_low.value, 0.2, 0.01);
  EXPECT_NEAR(jump.threshold_high.value, 0.3, 0.01);
  EXPECT_GT(jump.slope_low.value, 1.0);
  // With levels on the way there is a slope.
  const std::vector<Observer> on_the_way = {
      {"", {{0.1, 40, 20}, {0.2, 40, 24}, {0.3, 40, 30}, {0.4, 40, 36}, {0.5, 40, 40}}}};
  const PsychometricFit gentle = fit_psychometric({}, on_the_way, {.resamples = 39});
  EXPECT_TRUE(gentle.slope && gentle.bootstrap_slope_high && gentle.bootstrap_threshold_high);
}

TEST(Levels, ReadsTrialsCountsAndChoices) {
  const TemporaryFolder folder;
  const auto counts = folder.write("counts.csv", example_csv());
  EXPECT_TRUE(has_levels(counts, {}));
  const LevelsTable table = read_levels({counts}, {});
  ASSERT_EQ(table.series.size(), 1U);
  ASSERT_EQ(table.series[0].observers.size(), 1U);
  EXPECT_EQ(table.series[0].observers[0].cells[8].hits, 76);
  const auto trials = folder.write(
      "trials.csv",
      "participant,demonstration,level,choice,kind,side\nb,10-x,2,pinch,main,left\n"
      "a,2-x,1,cable,main,left\na,2-x,1,pinch,main,right\na,2-x,3,pinch,training,left\n");
  const LevelsTable choices = read_levels({trials}, {});
  ASSERT_EQ(choices.series.size(), 2U);
  EXPECT_EQ(choices.series[0].name, "2-x");
  EXPECT_FALSE(choices.correct);
  ASSERT_EQ(choices.series[0].observers[0].cells.size(), 1U);
  EXPECT_EQ(choices.series[0].observers[0].cells[0].trials, 2);
  EXPECT_EQ(choices.series[0].observers[0].cells[0].hits, 1);
  EXPECT_FALSE(has_levels(folder.write("tidy.csv", "participant,demonstration,choice\n"), {}));
}

TEST(Levels, RefusesWhatCannotBe) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& csv, const char* what) {
    const auto file = folder.write("bad.csv", csv);
    try {
      read_levels({file}, {});
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
      return;
    }
    ADD_FAILURE() << csv;
  };
  refused("level,correct\n1,2\n", "bad.csv:2: correct `2` is not a whole number from 0 to 1");
  refused("level,correct\nnan,1\n", "level `nan`");
  refused("level,correct\n1e12,1\n", "level `1e12`");
  refused("level,correct,trials\n1,2,0\n", "trials `0`");
  refused("level,correct,trials\n1,3,2\n", "from 0 to 2");
  refused("level,choice\n1,both\n", "choice `both`");
  refused("level\n1\n", "either a column `correct`");
  refused("level,choice,correct\n1,pinch,1\n", "either a column `correct`");
  refused("level,correct,corect\n1,1,1\n", "unknown column `corect`");
  refused("level,level,correct\n1,1,1\n", "stands twice");
  refused("level,correct\n1\n", "1 fields, but the first line has 2");
  refused("level,correct,participant\n1,1, a\n", "bad participant");
  refused("level,correct,kind\n1,1,maim\n", "kind `maim`");
  refused("level,correct\n", "no answers");
  ReadOptions options;
  options.exclude_file = folder.write("x.csv", "participant,reason\nnobody,asked\n");
  EXPECT_THROW(read_levels({folder.write("ok.csv", "participant,level,correct\na,1,1\n")}, options),
               InputError);
}

TEST(Levels, NamesAndTotalsAreNotPutTogether) {
  const TemporaryFolder folder;
  const auto named = folder.write("named.csv", "participant,level,correct\na,1,1\nb,1,0\n");
  const auto totals = folder.write("totals.csv", "level,correct,trials\n1,60,90\n");
  EXPECT_NO_THROW(read_levels({named}, {}));
  EXPECT_NO_THROW(read_levels({totals}, {}));
  EXPECT_THROW(read_levels({named, totals}, {}), InputError);
}

TEST(ThresholdReport, SaysWhatItTookParticipantsFor) {
  const TemporaryFolder folder;
  const auto methods = [&](const std::string& csv) {
    const LevelsTable table = read_levels({folder.write("a.csv", csv)}, {});
    const ThresholdReport report = analyse_thresholds(table, {}, {.resamples = 0});
    write_threshold_report(report, table, folder.path() / "out", false);
    return test::read_text(folder.path() / "out" / "report.md");
  };
  std::string one = "level,correct,trials\n", two = "participant,level,correct,trials\n";
  for (int level = 1; level <= 5; ++level) {
    one += fmt::format("{},{},40\n", level, 18 + 4 * level);
    two += fmt::format("a,{0},{1},40\nb,{0},{1},40\n", level, 18 + 4 * level);
  }
  const std::string own = "Participants have their own thresholds", chi = "cut-off of chi-square";
  EXPECT_EQ(methods(one).find(own), std::string::npos);
  EXPECT_NE(methods(one).find(chi), std::string::npos);
  EXPECT_NE(methods(two).find(own), std::string::npos);
  EXPECT_EQ(methods(two).find(chi), std::string::npos);
  // Totals are of who knows how many.
  EXPECT_NE(methods(one).find("| all answers | – | 200 |"), std::string::npos) << methods(one);
  EXPECT_NE(methods(two).find("| all answers | 2 | 400 |"), std::string::npos) << methods(two);
}

TEST(ThresholdReport, PointsToNoIntervalThatIsNotThere) {
  const TemporaryFolder folder;
  const LevelsTable table =
      read_levels({folder.write("a.csv", "level,correct,trials\n1,5,10\n2,8,10\n3,10,10\n")}, {});
  ThresholdReport report = analyse_thresholds(table, {}, {.resamples = 0});
  PsychometricFit& fit = report.fits[0];
  ASSERT_TRUE(fit.threshold);
  fit.slope = Estimate::none("it jumps");
  fit.threshold_low = 1.5;
  EXPECT_NE(threshold_words(report, table).find("Take its interval: it jumps"), std::string::npos);
  fit.threshold_low = fit.threshold_high = Estimate::none("it is flat");
  EXPECT_NE(threshold_words(report, table).find("Do not rely on it: it jumps"), std::string::npos);
}

TEST(ThresholdReport, WritesEveryFileAndEveryReason) {
  const TemporaryFolder folder;
  const LevelsTable table = read_levels(
      {folder.write(
          "a.csv", "demonstration,level,correct,trials\nflat <b>,1,5,9\nflat <b>,2,9,9\n" +
                       [] {
                         std::string rows;
                         for (size_t i = 0; i < example_levels.size(); ++i)
                           rows +=
                               fmt::format("good,{},{},90\n", example_levels[i], example_hits[i]);
                         return rows;
                       }())},
      {});
  const ThresholdReport report = analyse_thresholds(table, {}, {.resamples = 39});
  const auto written = write_threshold_report(report, table, folder.path() / "out", true);
  for (const std::string& name : written)
    EXPECT_GT(test::fs::file_size(folder.path() / "out" / name), 0U) << name;
  const json document = json::parse(test::read_text(folder.path() / "out/report.json"));
  EXPECT_TRUE(document["series"][0]["threshold"].is_null());
  EXPECT_NE(document["series"][0]["threshold_reason"].get<std::string>().find("three levels"),
            std::string::npos);
  EXPECT_NEAR(document["series"][1]["threshold"].get<double>(), 4.633233e-3, 1e-8);
  const std::string html = test::read_text(folder.path() / "out/report.html");
  EXPECT_EQ(html.find("flat <b>"), std::string::npos);
  EXPECT_NE(threshold_words(report, table).find("75 % of the answers are correct"),
            std::string::npos);
  PsychometricModel weibull;
  weibull.shape = Shape::weibull;
  const LevelsTable zero =
      read_levels({folder.write("z.csv", "level,correct\n0,1\n1,1\n2,0\n")}, {});
  EXPECT_THROW(analyse_thresholds(zero, weibull, {.resamples = 0}), InputError);
}

}  // namespace
}  // namespace pinchlab::analysis
