// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/advise.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <optional>

#include "analysis/experiments/accuracy_scenes.h"
#include "analysis/experiments/experiment.h"
#include "demos/command_line.h"
#include "demos/scenes/scene_json.h"

namespace pinchlab::experiments {

namespace {

/// The wanted error must be this many times what the reference may be off by.
constexpr double least_surety = 2.0;
/// Where refining stops.
constexpr double enough_surety = 8.0;

/// What the name of the configuration ends with that divides steps by their error.
constexpr const char* by_error = ", steps by error";

/// All configurations of the experiments, and ours with the error as what steps are divided by.
std::vector<Contender> tried(const Question& question) {
  std::vector<Contender> all = contenders();
  Contender adaptive = all.front();
  adaptive.name += by_error;
  adaptive.configuration.error = question.error_m;
  all.insert(all.begin() + 1, adaptive);
  return all;
}

bool vouched_for(const Question& question, const Problem& problem) {
  return problem.doubt_m * least_surety <= question.error_m;
}

/// Of each configuration the fewest steps from which on it meets the error, or its best rung.
std::vector<std::size_t> shown(const Question& question, const Advice& advice) {
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < advice.rungs.size();) {
    std::size_t end = i, best = i;
    while (end < advice.rungs.size() && advice.rungs[end].setting == advice.rungs[i].setting) {
      const Trial& trial = advice.rungs[end].trial;
      if (trial.finite && !(trial.error >= advice.rungs[best].trial.error)) best = end;
      ++end;
    }
    std::size_t first = end;
    while (first > i && meets(advice.problem, advice.rungs[first - 1].trial, question.error_m)) {
      --first;
    }
    if (!question.all) {
      rows.push_back(first < end ? first : best);
    } else {
      for (std::size_t k = i; k < end; ++k) rows.push_back(k);
    }
    i = end;
  }
  return rows;
}

std::string table(const Question& question, const Advice& advice) {
  std::string text = fmt::format("   {:<31}{:>14}{:>12}{:>24}{:>8}\n", "configuration",
                                 "steps a frame", "error, m", "us a simulated second", "enough");
  for (const std::size_t i : shown(question, advice)) {
    const Rung& rung = advice.rungs[i];
    const Trial& t = rung.trial;
    text +=
        fmt::format("{:<3}{:<31}{:>14}{:>12}{:>24}{:>8}\n",
                    static_cast<int>(i) == advice.best ? "->" : "", rung.setting,
                    rung.steps_per_frame, t.finite ? fmt::format("{:.1e}", t.error) : "not finite",
                    t.finite ? fmt::format("{:.0f}", 1e6 * t.cpu_s_per_s) : "-",
                    meets(advice.problem, t, question.error_m) ? "yes" : "no");
  }
  return text;
}

std::string cost(const Trial& trial) {
  return fmt::format("{:.3g} ms of processor time a simulated second", 1e3 * trial.cpu_s_per_s);
}

/// What to type for a configuration; the program offers no other solvers by name.
std::string how_to_use(const Question& question, const Rung& rung) {
  const std::size_t solver = rung.setting.find(" direct");
  if (solver == std::string::npos && rung.setting != "thesis") return "";
  const bool adapts = rung.setting.ends_with(by_error);
  return fmt::format("Try it: pinchlab simulate {} --method {} --steps-per-frame {}{} --out -\n",
                     question.scene.string(), rung.setting.substr(0, solver), rung.steps_per_frame,
                     adapts ? fmt::format(" --error {:g}", question.error_m) : "");
}

}  // namespace

Advice advise(const Question& question) {
  const Scene scene = read_scene_file(question.scene).scene;
  start_world(scene, question.scene, Method::pinch);  // tells what is wrong with it by its file
  const double clip = static_cast<double>(scene.frame_count) / scene.frames_per_second;
  const double seconds = question.seconds > 0.0 ? question.seconds : clip;
  Advice advice;
  advice.reference_steps = 2 * question.most_steps;
  advice.problem = own_solution(scene.name, scene, seconds, advice.reference_steps);
  while (advice.problem.doubt_m * enough_surety > question.error_m &&
         2 * advice.reference_steps <= question.most_reference_steps) {
    advice.reference_steps *= 2;
    refine(advice.problem, advice.reference_steps);
  }
  advice.problem.length_m = 1.0;
  advice.problem.length = "a metre";
  if (!vouched_for(question, advice.problem)) return advice;
  const std::vector<Contender> all = tried(question);
  Progress progress("advise", static_cast<double>(all.size()));
  for (const Contender& contender : all) {
    const auto run = [&](int steps) {
      return simulate(advice.problem, contender.configuration, steps);
    };
    const std::vector<Rung> rungs =
        climb(advice.problem, contender.name, run, question.most_steps, Limits());
    advice.rungs.insert(advice.rungs.end(), rungs.begin(), rungs.end());
    progress.done(1.0);
  }
  advice.best = cheapest(advice.problem, advice.rungs, question.error_m, true);
  return advice;
}

std::string advice_text(const Question& question, const Advice& advice) {
  const Problem& problem = advice.problem;
  std::string text = fmt::format(
      "{}: {:g} s, against the scene's own solution (pinch direct) at {} steps a frame, which\n"
      "is right to {:.1e} m by what halving its step has changed.\n\n",
      problem.title, problem.seconds(), advice.reference_steps, problem.doubt_m);
  if (!vouched_for(question, problem)) {
    return text + fmt::format(
                      "An error of {:g} m is below what this can vouch for. Ask for {:.1e} m or "
                      "more, or for a shorter --time.\n",
                      question.error_m, 1.06 * least_surety * problem.doubt_m);
  }
  text += table(question, advice) + "\n";
  if (advice.best < 0) {
    return text + fmt::format("None of these keeps within {:g} m at this and all finer steps.\n",
                              question.error_m);
  }
  const Rung& best = advice.rungs[static_cast<std::size_t>(advice.best)];
  return text + fmt::format("Cheapest within {:g} m: {}, {} step{} a frame: {:.1e} m off, {}.\n{}",
                            question.error_m, best.setting, best.steps_per_frame,
                            best.steps_per_frame == 1 ? "" : "s", best.trial.error,
                            cost(best.trial), how_to_use(question, best));
}

void add_advise_command(CLI::App& app) {
  auto question = std::make_shared<Question>();
  CLI::App* command =
      app.add_subcommand("advise", "The cheapest way to simulate a scene to a wanted error");
  command->add_option("scene", question->scene, "Scene file; demos/README.md documents the format")
      ->type_name("SCENE")
      ->required();
  command
      ->add_option("--error", question->error_m,
                   "Farthest that any body's centre or rim may be off in any frame, m")
      ->type_name("M")
      ->required()
      ->check(number_in(1e-12, 1e3));
  command
      ->add_option("--time", question->seconds, "How much of the scene counts, s [the whole clip]")
      ->type_name("S")
      ->check(number_in(0.05, 600.0));
  command->add_flag("--all", question->all, "Show all that was tried, not one row a configuration");
  command->footer(
      "Tries every method with every solver, the thesis' configuration, and steps that are divided "
      "by their error\n(simulate --error), at 1 to 256 steps a frame, against the scene's own "
      "solution at many more, and names the\ncheapest that stays within the error, at those steps "
      "and all finer ones. Exit code 1: there is none, or the "
      "solution is not sure enough to tell.\n\n"
      "Examples:\n"
      "  pinchlab advise demos/04-two-blocking.json --error 0.01\n"
      "  pinchlab advise demos/06-windlass.json --error 1e-5 --time 4");
  command->callback([question] {
    const Advice advice = advise(*question);
    const std::string text = advice_text(*question, advice);
    std::fputs(text.c_str(), advice.best >= 0 ? stdout : stderr);
    if (advice.best < 0) throw CLI::RuntimeError(1);
  });
}

}  // namespace pinchlab::experiments
