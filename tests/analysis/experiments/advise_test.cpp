// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/advise.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "analysis/experiments/steady_times.h"
#include "demos/scenes/scene_json.h"

namespace pinchlab::experiments {
namespace {

namespace fs = std::filesystem;

const char* const atwood_json = R"({"title": "Two loads", "duration_s": 1,
  "view": {"low_m": [-2, -5], "high_m": [2, 1]},
  "baseline": {"method": "cable", "reason": "Nothing is pinched."},
  "bodies": [
    {"name": "left", "kind": "free", "radius_m": 0.2, "mass_kg": 1, "position_m": [-0.55, -3]},
    {"name": "right", "kind": "free", "radius_m": 0.2, "mass_kg": 1.5, "position_m": [0.55, -3]},
    {"name": "pulley", "kind": "fixed_axle", "radius_m": 0.5, "mass_kg": 1, "position_m": [0, 0]}],
  "cables": [{"name": "cable", "half_width_m": 0.05, "start": {"body": "left"},
    "wraps": [{"body": "pulley", "turn": "clockwise"}], "end": {"body": "right"}}]})";

const char* const pendulum_json = R"({"title": "Pendulum", "duration_s": 1,
  "view": {"low_m": [-2, -3], "high_m": [2, 1]},
  "baseline": {"method": "cable", "reason": "Nothing is pinched."},
  "bodies": [
    {"name": "bob", "kind": "free", "radius_m": 0.1, "mass_kg": 1, "position_m": [1.2, -1.6]}],
  "cables": [{"name": "cable", "half_width_m": 0.05, "start": {"world_m": [0, 0]},
    "end": {"body": "bob"}}]})";

class Advise : public ::testing::Test {
 protected:
  Question ask(const std::string& name, const std::string& json, double error_m) {
    fs::create_directories(folder_);
    const fs::path path = folder_ / (name + ".json");
    std::ofstream(path) << json;
    Question question;
    question.scene = path;
    question.error_m = error_m;
    question.most_steps = 16;
    question.most_reference_steps = 1024;
    return question;
  }
  ~Advise() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  fs::path folder_ = fs::path(::testing::TempDir()) / ("advise-" + std::to_string(::getpid()));
};

// The loads' acceleration is uniform, so that one step a frame is exact with any solver that
// solves one row exactly; the first of the list wins.
TEST_F(Advise, OneStepIsEnoughForUniformAcceleration) {
  const Question question = ask("atwood", atwood_json, 1e-6);
  Advice advice = advise(question);
  for (Rung& rung : advice.rungs) rung.trial.cpu_s_per_s = rung.steps_per_frame;  // no clock's
  advice.best = cheapest(advice.problem, advice.rungs, question.error_m, true);
  ASSERT_GE(advice.best, 0);
  const Rung& best = advice.rungs[static_cast<std::size_t>(advice.best)];
  EXPECT_EQ(best.steps_per_frame, 1);
  EXPECT_LT(best.trial.error, 1e-9);
  const std::string text = advice_text(question, advice);
  EXPECT_NE(text.find("Cheapest within 1e-06 m"), std::string::npos) << text;
  EXPECT_NE(text.find("1 step a frame"), std::string::npos) << text;
}

TEST_F(Advise, NamesTheFewestStepsThatMeetTheError) {
  const Question question = ask("pendulum", pendulum_json, 2e-5);
  const Advice advice = advise(question);
  ASSERT_GE(advice.best, 0) << advice_text(question, advice);
  // Which setting is cheapest is the clock's to say; that none could do with fewer steps is not.
  const auto fewest = [&](std::size_t i) {
    const bool first = i == 0 || advice.rungs[i - 1].setting != advice.rungs[i].setting;
    return first || !meets(advice.problem, advice.rungs[i - 1].trial, question.error_m);
  };
  const auto best = static_cast<std::size_t>(advice.best);
  EXPECT_TRUE(meets(advice.problem, advice.rungs[best].trial, question.error_m));
  EXPECT_TRUE(fewest(best));
  std::vector<Rung> fixed;
  for (const Rung& rung : advice.rungs) {
    if (rung.setting == "pinch direct") fixed.push_back(rung);
  }
  const int own = cheapest(advice.problem, fixed, question.error_m, true);
  ASSERT_GE(own, 1);
  EXPECT_FALSE(
      meets(advice.problem, fixed[static_cast<std::size_t>(own) - 1].trial, question.error_m));
  const auto rows = [](const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
  };
  Question all = question;
  all.all = true;
  EXPECT_EQ(rows(advice_text(all, advice)) - rows(advice_text(question, advice)),
            static_cast<std::ptrdiff_t>(advice.rungs.size() - contenders().size() - 1));
}

// The iterative solver can be cheaper, but simulate has no name for it.
TEST_F(Advise, RecommendsWhatCanBeTyped) {
  const Question question = ask("atwood", atwood_json, 1e-2);
  Advice advice = advise(question);
  for (Rung& rung : advice.rungs) {
    const bool is_named = rung.setting.find("iterative") == std::string::npos;
    rung.trial.cpu_s_per_s = (is_named ? 10.0 : 1.0) * rung.steps_per_frame;
  }
  const int any = cheapest(advice.problem, advice.rungs, question.error_m, true);
  ASSERT_GE(any, 0);
  EXPECT_NE(advice.rungs[static_cast<std::size_t>(any)].setting.find("iterative"),
            std::string::npos);
  advice.best = best_to_type(question, advice);
  ASSERT_GE(advice.best, 0);
  EXPECT_EQ(advice.rungs[static_cast<std::size_t>(advice.best)].setting, "pinch direct");
  const std::string text = advice_text(question, advice);
  EXPECT_NE(text.find("Try it: pinchlab simulate "), std::string::npos) << text;
  EXPECT_NE(text.find("* for comparison only"), std::string::npos) << text;
}

// Two that cost the same but for a machine that is now and then busy.
TEST(SteadyTimes, AreMediansOfAsManySamplesAsTheirScatterNeeds) {
  unsigned state = 1;
  const auto noise = [&state] {
    state = state * 1664525U + 1013904223U;
    return static_cast<double>(state >> 8U) / static_cast<double>(1U << 24U);
  };
  int calls = 0;
  const auto busy = [&] {
    ++calls;
    return 1.0 + 0.3 * noise() + (noise() < 0.05 ? 20.0 : 0.0);
  };
  const std::vector<double> noisy = steady_times({busy, busy}, 1e6);
  EXPECT_NEAR(noisy[0], 1.15, 0.07);
  EXPECT_NEAR(noisy[1], 1.15, 0.07);
  EXPECT_GT(calls, 2 * 15);
  calls = 0;
  const std::vector<double> same = steady_times({[&] { return ++calls, 2.0; }}, 1e6);
  EXPECT_EQ(same, std::vector<double>{2.0});
  EXPECT_EQ(calls, 15);
  EXPECT_EQ(steady_times({[] { return 3.0; }}, 1e-9), std::vector<double>{3.0});
}

TEST_F(Advise, RefusesWhatTheReferenceCannotVouchFor) {
  Question question = ask("pendulum", pendulum_json, 1e-11);
  question.most_reference_steps = 128;
  const Advice advice = advise(question);
  EXPECT_EQ(advice.best, -1);
  EXPECT_TRUE(advice.rungs.empty());
  const std::string text = advice_text(question, advice);
  EXPECT_NE(text.find("below what this can vouch for"), std::string::npos) << text;
  // What it asks for instead is granted.
  const std::string ask_for = "Ask for ";
  Question next = question;
  next.error_m = std::stod(text.substr(text.find(ask_for) + ask_for.size()));
  EXPECT_FALSE(advise(next).rungs.empty()) << text;
}

// A bob that starts from high up: one step a frame is too long, but not where it is divided.
TEST_F(Advise, TriesStepsThatAreDividedByTheirError) {
  const Question question = ask("pendulum", pendulum_json, 2e-4);
  const Advice advice = advise(question);
  std::vector<Rung> divided, fixed;
  for (const Rung& rung : advice.rungs) {
    if (rung.setting == "pinch direct, steps by error") divided.push_back(rung);
    if (rung.setting == "pinch direct") fixed.push_back(rung);
  }
  ASSERT_FALSE(divided.empty());
  EXPECT_EQ(divided.front().steps_per_frame, 1);
  EXPECT_LT(divided.front().trial.error, 0.5 * fixed.front().trial.error);
  EXPECT_TRUE(meets(advice.problem, divided.front().trial, question.error_m));
  EXPECT_FALSE(meets(advice.problem, fixed.front().trial, question.error_m));
  Advice by_error = advice;
  by_error.best = static_cast<int>(
      std::find_if(advice.rungs.begin(), advice.rungs.end(),
                   [](const Rung& rung) { return rung.setting.ends_with("by error"); }) -
      advice.rungs.begin());
  const std::string text = advice_text(question, by_error);
  EXPECT_NE(text.find("--method pinch --steps-per-frame 1 --error 0.0002 --out -"),
            std::string::npos)
      << text;
}

TEST_F(Advise, SaysWhereNothingMeetsTheError) {
  Question question = ask("pendulum", pendulum_json, 1e-6);
  question.most_steps = 2;
  const Advice advice = advise(question);
  EXPECT_EQ(advice.best, -1);
  EXPECT_FALSE(advice.rungs.empty());
  const std::string text = advice_text(question, advice);
  EXPECT_NE(text.find("None of these, but for what is marked *, keeps within 1e-06 m"),
            std::string::npos)
      << text;
}

TEST_F(Advise, NamesTheFileThatIsWrong) {
  try {
    advise(ask("broken", R"({"title": 1})", 1e-3));
    FAIL() << "was accepted";
  } catch (const SceneFileError& error) {
    EXPECT_NE(std::string(error.what()).find("broken.json"), std::string::npos);
  }
}

int exit_code(std::vector<std::string> arguments) {
  CLI::App app;
  add_advise_command(app);
  std::reverse(arguments.begin(), arguments.end());
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& error) {
    return error.get_exit_code();
  }
  return 0;
}

// A clip of 10 ms could be given no --time, nor one of 700 s.
TEST_F(Advise, TakesATimeOfAnyClip) {
  Question question = ask("pendulum", pendulum_json, 1.0);
  nlohmann::json scene = nlohmann::json::parse(pendulum_json);
  scene["frames_per_second"] = 1000;
  scene["duration_s"] = 0.01;
  std::ofstream(question.scene) << scene;
  EXPECT_EQ(exit_code({"advise", question.scene.string(), "--error", "1", "--time", "0.002"}), 0);
}

TEST_F(Advise, CommandLineIsStrict) {
  const std::string scene = ask("pendulum", pendulum_json, 1.0).scene.string();
  using CLI::ExitCodes;
  EXPECT_EQ(exit_code({"advise", scene}), static_cast<int>(ExitCodes::RequiredError));
  EXPECT_EQ(exit_code({"advise", "--error", "1"}), static_cast<int>(ExitCodes::RequiredError));
  const int invalid = static_cast<int>(ExitCodes::ValidationError);
  for (const char* error : {"0", "-1", "nan", "inf", "much", "1e-3x"}) {
    EXPECT_EQ(exit_code({"advise", scene, "--error", error}), invalid) << error;
  }
  EXPECT_EQ(exit_code({"advise", scene, "--error", "1", "--time", "1s"}), invalid);
  for (const char* time : {"0", "-1", "0.001", "1.5", "1000"}) {
    EXPECT_THROW(exit_code({"advise", scene, "--error", "1", "--time", time}),
                 std::invalid_argument)
        << time;
  }
  EXPECT_EQ(exit_code({"advise", scene, "--error", "1", "--steps", "4"}),
            static_cast<int>(ExitCodes::ExtrasError));
}

}  // namespace
}  // namespace pinchlab::experiments
