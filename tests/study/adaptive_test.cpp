// SPDX-License-Identifier: GPL-3.0-or-later
// Levels that follow from the answers: the method, and a study that uses it.
#include "study/adaptive.h"

#include <gsl/gsl_rng.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>

#include "base/answer_file.h"
#include "base/input_error.h"
#include "base/read_file.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::vector<double> even_levels(int count) {
  std::vector<double> levels;
  for (int i = 0; i < count; ++i) levels.push_back(0.05 + 0.25 * i / (count - 1));
  return levels;
}

// One whose hits follow the function that the method assumes.
std::vector<GradedAnswer> run(const std::vector<double>& levels, double threshold, double width,
                              int trials, gsl_rng* rng) {
  std::vector<GradedAnswer> answers;
  for (int i = 0; i < trials; ++i) {
    const double level = next_level(levels, answers);
    const double hit =
        0.5 + 0.46 / (1 + std::exp(-2 * std::log(19.0) * (level - threshold) / width));
    answers.push_back({level, gsl_rng_uniform(rng) < hit});
  }
  return answers;
}

using Random = std::unique_ptr<gsl_rng, void (*)(gsl_rng*)>;
Random random(unsigned seed) {
  Random rng(gsl_rng_alloc(gsl_rng_mt19937), &gsl_rng_free);
  gsl_rng_set(rng.get(), seed);
  return rng;
}

TEST(Adaptive, TheFirstLevelLiesWithinAndLevelsFollowTheAnswers) {
  const std::vector<double> levels = even_levels(11);
  const double first = next_level(levels, {});
  EXPECT_GT(first, levels.front());
  std::vector<GradedAnswer> hits, misses;
  for (int i = 0; i < 6; ++i) {
    hits.push_back({first, true});
    misses.push_back({first, false});
  }
  EXPECT_LT(next_level(levels, hits), first);
  EXPECT_GE(next_level(levels, misses), first);
  EXPECT_LT(estimate_threshold(levels, hits).mean, estimate_threshold(levels, misses).mean);
}

TEST(Adaptive, TheOrderOfLevelsAndOfAnswersDoesNotMatter) {
  std::vector<double> levels = even_levels(7);
  std::vector<GradedAnswer> answers = run(levels, 0.17, 0.1, 12, random(3).get());
  const double next = next_level(levels, answers);
  std::ranges::reverse(levels);
  EXPECT_EQ(next_level(levels, answers), next);
  std::ranges::reverse(answers);
  EXPECT_EQ(next_level(levels, answers), next);
}

// Of truths drawn from what the method holds possible the posterior is right: the square of its
// mean's error is its variance on average, and the error nothing; more trials make both less.
TEST(Adaptive, FindsTheThresholdAsWellAsItSays) {
  const std::vector<double> levels = even_levels(11);
  double before = 1;
  for (const int trials : {3, 12}) {
    const Random rng = random(17);
    double errors = 0, squares = 0, excess = 0, excess_squares = 0;
    constexpr int people = 150;
    for (int i = 0; i < people; ++i) {
      const double threshold = -0.0125 + 0.375 * gsl_rng_uniform(rng.get());
      const double width = 0.0125 * std::pow(40.0, gsl_rng_uniform(rng.get()));
      const ThresholdEstimate found =
          estimate_threshold(levels, run(levels, threshold, width, trials, rng.get()));
      const double error = found.mean - threshold;
      const double over = error * error - found.deviation * found.deviation;
      errors += error;
      squares += error * error;
      excess += over;
      excess_squares += over * over;
    }
    EXPECT_LT(std::abs(errors), 4 * std::sqrt(squares)) << trials;  // four standard errors
    EXPECT_LT(std::abs(excess), 4 * std::sqrt(excess_squares)) << trials;
    EXPECT_LT(squares, before) << trials;
    before = squares;
  }
}

// ---- A study.

json study_document(int trials) {
  json clips = json::array();
  for (const double level : even_levels(6)) {
    const std::string name = "squeeze-" + std::to_string(std::lround(1000 * level));
    clips.push_back(
        {{"level", level}, {"left", name + "-left.mp4"}, {"right", name + "-right.mp4"}});
  }
  return {{"format", "pinchlab-study 1"},
          {"series", {{{"name", "squeeze"}, {"clips", clips}}}},
          {"adaptive_trials", trials}};
}

DeskOptions adaptive_desk(const fs::path& folder, int trials = 10) {
  const json document = study_document(trials);
  fs::create_directories(folder / "clips");
  for (const json& clip : document["series"][0]["clips"]) {
    for (const char* side : {"left", "right"}) {
      const std::string name = clip[side];
      write_text(folder / "clips" / name, name);
    }
  }
  DeskOptions options;
  options.config = parse_config(document, "study.json");
  options.clips = open_clips(folder / "clips", options.config);
  options.answers = folder / "answers";
  options.seed = 7;
  return options;
}

std::string id_of(const std::string& token) {
  return token.substr(0, token.find('.'));
}

void answer_one(Desk& desk, const std::string& token, std::size_t i, const char* choice = "left") {
  desk.show(token, i);
  desk.answer(token, parse_answer(answer_body(i, choice)));
}

std::vector<std::optional<double>> chosen_levels(Desk& desk, const std::string& token) {
  std::vector<std::optional<double>> levels;
  for (const PlannedTrial& trial : desk.plan_of(id_of(token)).second) levels.push_back(trial.level);
  return levels;
}

TEST(Adaptive, AClipCanBeHadOnlyOnceTheAnswersBeforeAreThere) {
  Desk desk(adaptive_desk(scratch_folder()));
  const std::string token = desk.start("", "browser");
  const Progress progress = desk.progress(token);
  EXPECT_TRUE(progress.is_adaptive);
  ASSERT_EQ(progress.trials.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    for (std::size_t j = 0; j < 10; ++j) {
      EXPECT_EQ(desk.clip(progress.trials[j].media, Encoding::mp4) != nullptr, j <= i) << i << j;
    }
    EXPECT_EQ(refused([&] { desk.answer(token, parse_answer(answer_body(i + 1))); }), 409);
    answer_one(desk, token, i);
    desk.answer(token, parse_answer(answer_body(i)));  // sent again: changes nothing
  }
  const auto levels = chosen_levels(desk, token);
  EXPECT_TRUE(std::ranges::all_of(levels, [](const auto& level) { return level.has_value(); }));
  EXPECT_EQ(levels.front(), next_level(levels_of(desk.config(), "squeeze"), {}));
  desk.save(token, {});
}

TEST(Adaptive, TheSameAnswersGiveTheSameLevelsAlsoAfterARestart) {
  const fs::path folder = scratch_folder();
  const auto choice = [](std::size_t i) { return i % 3 == 0 ? "right" : "left"; };
  std::vector<std::optional<double>> straight;
  {
    Desk desk(adaptive_desk(folder));
    const std::string token = desk.start("", "browser");
    for (std::size_t i = 0; i < 10; ++i) answer_one(desk, token, i, choice(i));
    straight = chosen_levels(desk, token);
  }
  fs::remove_all(folder / "answers");
  std::string token;
  for (std::size_t i = 0; i < 10; ++i) {  // a new server for each trial
    Desk desk(adaptive_desk(folder));
    if (i == 0) token = desk.start("", "browser");
    const Progress progress = desk.progress(token);
    EXPECT_EQ(progress.next, i);
    EXPECT_NE(desk.clip(progress.trials[i].media, Encoding::mp4), nullptr);
    answer_one(desk, token, i, choice(i));
    if (i == 9) {
      EXPECT_EQ(chosen_levels(desk, token), straight);
    }
  }
}

TEST(Adaptive, SidesAreBalancedInEveryEight) {
  PlanOptions options = plan_options(adaptive_desk(scratch_folder(), 40).config);
  for (std::uint64_t number = 0; number < 200; ++number) {
    const std::vector<PlannedTrial> plan = make_plan(3, number, options);
    ASSERT_EQ(plan.size(), 40U);
    int left = 0, run = 0;
    for (std::size_t i = 0; i < plan.size(); ++i) {
      EXPECT_TRUE(is_open(plan[i]));
      run = i > 0 && plan[i].pinch == plan[i - 1].pinch ? run + 1 : 1;
      EXPECT_LE(run, 3);
      left += plan[i].pinch == Side::left ? 1 : 0;
      if (i % 8 == 7) {
        EXPECT_EQ(2 * left, static_cast<int>(i) + 1);
      }
    }
    if (number % 2 == 1) {
      const std::vector<PlannedTrial> other = make_plan(3, number - 1, options);
      for (std::size_t i = 0; i < plan.size(); ++i) EXPECT_NE(plan[i].pinch, other[i].pinch);
    }
  }
}

TEST(Adaptive, SeriesTakeTurns) {
  json document = study_document(5);
  document["series"].push_back(document["series"][0]);
  document["series"][1]["name"] = "grip";
  const Config config = parse_config(document, "study.json");
  const std::vector<PlannedTrial> plan = make_plan(1, 0, plan_options(config));
  ASSERT_EQ(plan.size(), 10U);
  for (std::size_t i = 0; i < plan.size(); i += 2) {
    EXPECT_NE(plan[i].demonstration, plan[i + 1].demonstration);
  }
}

TEST(Adaptive, ConfigurationsAreCheckedWholly) {
  const auto refuses = [](const json& changes) {
    json document = study_document(10);
    document.update(changes);
    EXPECT_THROW(parse_config(document, "study.json"), InputError) << changes;
  };
  refuses({{"adaptive_trials", 1}});
  refuses({{"adaptive_trials", 1001}});
  refuses({{"repetitions", 2}});
  refuses({{"both_orders", true}});
  json none = {{"format", "pinchlab-study 1"}, {"adaptive_trials", 10}};
  EXPECT_THROW(parse_config(none, "study.json"), InputError);
}

// Simulated participants over HTTP, and what the analysis makes of their answers.
TEST(Adaptive, AStudyFindsTheThreshold) {
  const fs::path folder = scratch_folder();
  { const DeskOptions writes_the_clips = adaptive_desk(folder); }
  write_text(folder / "study.json", study_document(30).dump());
  write_text(
      folder / "truth.json",
      json{{"format", "pinchlab-truth 1"},
           {"series", {{"squeeze", {{"threshold", 0.16}, {"width", 0.15}, {"spread", 0.02}}}}},
           {"lapses", 0.02}}
          .dump());
  const std::string commands =
      std::string("cd '") + folder.string() + "' && '" + PINCHLAB_PROGRAM +
      "' study simulate --participants 30 --seed 5 --clips clips --answers answers --truth "
      "truth.json --config study.json > out.txt 2> err.txt && '" +
      PINCHLAB_PROGRAM +
      "' analyse answers --no-figures --bootstrap 99 --out report >> out.txt 2>> err.txt";
  ASSERT_EQ(std::system(commands.c_str()), 0) << read_whole(folder / "err.txt");
  const json series = json::parse(read_whole(folder / "report/report.json"))["series"][0];
  EXPECT_EQ(series["participants"], 30);
  EXPECT_EQ(series["answers"], 30 * 30);
  EXPECT_LE(series["threshold_low"].get<double>(), 0.16);
  EXPECT_GE(series["threshold_high"].get<double>(), 0.16);
  EXPECT_NEAR(series["threshold"].get<double>(), 0.16, 0.025);
  const json file = json::parse(read_whole(answer_files(folder / "answers").front()));
  EXPECT_EQ(file["plan"]["adaptive"], "psi");
  EXPECT_EQ(file["plan"]["answers_per_demonstration"], 30);
}

}  // namespace
}  // namespace pinchlab::study
