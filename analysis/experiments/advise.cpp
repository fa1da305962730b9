// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/advise.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "analysis/experiments/accuracy_scenes.h"
#include "analysis/experiments/experiment.h"
#include "analysis/experiments/steady_times.h"
#include "base/at.h"
#include "demos/command_line.h"
#include "demos/scenes/player.h"
#include "demos/scenes/scene_json.h"
#include "sim/make_world.h"
#include "sim/scene_error.h"

namespace pinchlab::experiments {

namespace {

/// The wanted error must be this many times what the reference may be off by.
constexpr double least_surety = 2.0;
/// Where refining stops.
constexpr double enough_surety = 8.0;

/// What the name of the configuration ends with that divides steps by their error.
constexpr const char* by_error = ", steps by error";

/// Looks on as one simulation follows the other: tells how far they are, and gives up in time.
class Watch {
 public:
  explicit Watch(std::function<void(const World&)> check_time)
      : check_time_(std::move(check_time)) {}

  /// What follows is `parts` times `steps` steps, all in all.
  void start(const std::string& what, double parts, double steps) {
    progress_.reset();  // one line at a time
    progress_.emplace(what, parts * steps);
    left_ = steps;
  }
  /// One of the parts is done, with however many of its steps; so many has the next one.
  void next(double steps) {
    progress_->done(left_);
    left_ = steps;
  }
  /// Whether the simulations that follow count. Those do not that are repeated for their time.
  void count(bool counts) { counts_ = counts; }

  void look(const World& world) {
    check_time_(world);
    const std::int64_t before = world.step > last_step_ ? last_step_ : 0;  // else another one's
    last_step_ = world.step;
    if (!counts_) return;
    const double steps = std::min(static_cast<double>(world.step - before), left_);
    progress_->done(steps);
    left_ -= steps;
  }

 private:
  std::function<void(const World&)> check_time_;
  std::optional<Progress> progress_;
  double left_ = 0.0;  // steps of this part
  std::int64_t last_step_ = 0;
  bool counts_ = true;
};

/// All configurations of the experiments, and ours with the error as what steps are divided by.
std::vector<Contender> tried(const Question& question) {
  std::vector<Contender> all = contenders();
  Contender adaptive = all.front();
  adaptive.name += by_error;
  adaptive.configuration.error = question.error_m;
  all.insert(all.begin() + 1, adaptive);
  return all;
}

/// Those by which the scene can be simulated; the others' names go to `refused`.
std::vector<Contender> possible(const Scene& scene, std::vector<Contender> all,
                                std::vector<std::string>& refused) {
  std::erase_if(all, [&](const Contender& contender) {
    try {
      make_world(scene, contender.configuration);
      return false;
    } catch (const SceneError&) {
      refused.push_back(contender.name);
      return true;
    }
  });
  return all;
}

bool vouched_for(const Question& question, const Problem& problem) {
  return problem.doubt_m * least_surety <= question.error_m;
}

/// The rungs of one configuration.
struct Ladder {
  std::size_t begin = 0, end = 0;
  std::size_t first = 0;  ///< fewest steps from which on all meet the error; `end`: none do
  std::size_t closest = 0;
};

std::vector<Ladder> ladders(const Question& question, const Advice& advice) {
  std::vector<Ladder> all;
  const std::vector<Rung>& rungs = advice.rungs;
  for (std::size_t i = 0; i < rungs.size(); i = all.back().end) {
    Ladder& one = all.emplace_back(Ladder{i, i, i, i});
    while (one.end < rungs.size() && rungs[one.end].setting == rungs[i].setting) {
      const Trial& trial = rungs[one.end].trial;
      if (trial.finite && !(trial.error >= rungs[one.closest].trial.error)) one.closest = one.end;
      ++one.end;
    }
    one.first = one.end;
    while (one.first > i && meets(advice.problem, rungs[one.first - 1].trial, question.error_m)) {
      --one.first;
    }
  }
  return all;
}

/// Whether `simulate` has a name for it; there is one of the direct solver and of the thesis' own.
bool can_be_typed(const Rung& rung) {
  return rung.setting.find(" direct") != std::string::npos || rung.setting == "thesis";
}

/// The candidates for the best: of each setting that can be typed the fewest steps that do.
std::vector<std::size_t> finalists(const Question& question, const Advice& advice) {
  std::vector<std::size_t> rows;
  for (const Ladder& one : ladders(question, advice)) {
    if (one.first < one.end && can_be_typed(advice.rungs[one.first])) rows.push_back(one.first);
  }
  return rows;
}

/// Measures the candidates once more, side by side: clocks of short runs are coarse, and what else
/// the machine does comes and goes.
void time_finalists(const Question& question, const std::vector<Contender>& all, Advice& advice) {
  constexpr double least_sample_s = 2e-3, most_s = 3.0;
  const std::vector<std::size_t> rows = finalists(question, advice);
  if (rows.size() < 2) return;
  std::vector<std::function<double()>> samplers;
  std::vector<double> seconds_a_sample;  // of the scene
  for (const std::size_t row : rows) {
    const Rung& rung = advice.rungs[row];
    const auto contender = std::ranges::find(all, rung.setting, &Contender::name);
    const double once_s = rung.trial.cpu_s_per_s * advice.problem.seconds();
    const int runs = 1 + static_cast<int>(std::min(least_sample_s / once_s, 1000.0));
    samplers.emplace_back([&advice, &rung, runs, how = contender->configuration] {
      double sum = 0.0;
      for (int i = 0; i < runs; ++i) {
        sum += simulate(advice.problem, how, rung.steps_per_frame).cpu_s;
      }
      return sum;
    });
    seconds_a_sample.push_back(runs * advice.problem.seconds());
  }
  const std::vector<double> times = steady_times(samplers, most_s);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    advice.rungs[rows[i]].trial.cpu_s_per_s = times[i] / seconds_a_sample[i];
  }
}

/// Of each configuration the fewest steps that do, or its best rung.
std::vector<std::size_t> shown(const Question& question, const Advice& advice) {
  std::vector<std::size_t> rows;
  for (const Ladder& one : ladders(question, advice)) {
    if (!question.all) {
      rows.push_back(one.first < one.end ? one.first : one.closest);
    } else {
      for (std::size_t k = one.begin; k < one.end; ++k) rows.push_back(k);
    }
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
    if (!can_be_typed(rung)) text.insert(text.size() - 1, " *");
  }
  return text + "* for comparison only: simulate has no name for it\n";
}

std::string cost(const Trial& trial) {
  return fmt::format("{:.3g} ms of processor time a simulated second", 1e3 * trial.cpu_s_per_s);
}

/// What to type for a configuration that can be typed.
std::string how_to_use(const Question& question, const Advice& advice, const Rung& rung) {
  const std::size_t solver = rung.setting.find(" direct");
  const bool adapts = rung.setting.ends_with(by_error);
  const std::string try_it =
      fmt::format("Try it: pinchlab simulate {} --method {} --steps-per-frame {}{} --out -\n",
                  question.scene.string(), rung.setting.substr(0, solver), rung.steps_per_frame,
                  adapts ? fmt::format(" --error {:g}", question.error_m) : "");
  const std::string keep = words_to_keep(advice.nodes);
  return keep.empty() ? try_it : fmt::format("In the scene, {}.\n{}", keep, try_it);
}

}  // namespace

int best_to_type(const Question& question, const Advice& advice) {
  const std::vector<std::size_t> rows = finalists(question, advice);
  std::vector<Rung> rungs;
  rungs.reserve(rows.size());
  for (const std::size_t row : rows) rungs.push_back(advice.rungs[row]);
  const int best = cheapest(advice.problem, rungs, question.error_m, true);
  return best < 0 ? -1 : static_cast<int>(at(rows, best));
}

namespace {

/// s that are asked for.
double seconds_of(const Question& question, const Scene& scene) {
  const double clip = static_cast<double>(scene.frame_count) / scene.frames_per_second;
  if (!question.seconds) return clip;
  const double frames = std::round(*question.seconds * scene.frames_per_second);
  if (frames < 1.0 || frames > scene.frame_count) {
    throw std::invalid_argument(fmt::format(
        "{}: --time must be {:.3g} to {} s, from a frame to the whole clip, not {}",
        question.scene.string(), 1.0 / scene.frames_per_second, clip, *question.seconds));
  }
  return *question.seconds;
}

/// The scene's own solution, as sure as is asked for or can be had.
void solve(const Question& question, const Scene& scene, Watch& watch, Advice& advice) {
  const double seconds = seconds_of(question, scene);
  const double frames = std::round(seconds * scene.frames_per_second);
  const auto start = [&](double steps) {
    watch.start(fmt::format("solving {} at {} steps a frame", scene.name, advice.reference_steps),
                1.0, frames * steps);
  };
  advice.reference_steps = 2 * question.most_steps;
  start(3.0 * question.most_steps);  // at half as many steps first
  advice.problem = own_solution(scene.name, scene, seconds, advice.reference_steps,
                                [&watch](const World& world) { watch.look(world); });
  while (advice.problem.doubt_m * enough_surety > question.error_m &&
         2 * advice.reference_steps <= question.most_reference_steps) {
    advice.reference_steps *= 2;
    start(advice.reference_steps);
    refine(advice.problem, advice.reference_steps);
  }
  advice.problem.length_m = 1.0;
  advice.problem.length = "a metre";
}

void try_all(const Question& question, const std::vector<Contender>& all, Watch& watch,
             Advice& advice) {
  const double steps = static_cast<double>(advice.problem.frames) * (2 * question.most_steps - 1);
  watch.start("trying all configurations", static_cast<double>(all.size()), steps);
  for (const Contender& contender : all) {
    int known = 0;  // steps a frame
    const auto run = [&](int steps_per_frame) {
      watch.count(steps_per_frame != std::exchange(known, steps_per_frame));
      return simulate(advice.problem, contender.configuration, steps_per_frame);
    };
    const std::vector<Rung> rungs =
        climb(advice.problem, contender.name, run, question.most_steps, Limits());
    advice.rungs.insert(advice.rungs.end(), rungs.begin(), rungs.end());
    watch.next(steps);
  }
  watch.count(false);
}

}  // namespace

Advice advise(const Question& question) {
  const SceneFile file = read_scene_file(question.scene);
  start_world(file.scene, question.scene,
              Method::pinch);  // tells what is wrong with it by its file
  Watch watch(time_limit_of_all(file, question.time_limit, "a shorter --time is faster"));
  Advice advice;
  advice.nodes = file.chosen_nodes;
  solve(question, file.scene, watch, advice);
  if (vouched_for(question, advice.problem)) {
    const std::vector<Contender> all = possible(file.scene, tried(question), advice.refused);
    try_all(question, all, watch, advice);
    time_finalists(question, all, advice);
    advice.best = best_to_type(question, advice);
  }
  advice.problem.on_steps = nullptr;  // the watch ends here
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
  text += table(question, advice);
  if (!advice.refused.empty()) {
    text += fmt::format("Not possible for this scene: {}.\n", fmt::join(advice.refused, ", "));
  }
  text += "\n";
  if (advice.best < 0) {
    return text +
           fmt::format(
               "None of these, but for what is marked *, keeps within {:g} m at this and all "
               "finer steps.\n",
               question.error_m);
  }
  const Rung& best = at(advice.rungs, advice.best);
  return text + fmt::format("Cheapest within {:g} m: {}, {} step{} a frame: {:.1e} m off, {}.\n{}",
                            question.error_m, best.setting, best.steps_per_frame,
                            best.steps_per_frame == 1 ? "" : "s", best.trial.error,
                            cost(best.trial), how_to_use(question, advice, best));
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
      ->add_option("--time", question->seconds,
                   "How much of the clip counts, s, at least a frame [all of it]")
      ->type_name("S")
      ->check(number());
  add_time_limit(*command, question->time_limit, "Give up");
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
    std::fputs(advice_text(*question, advice).c_str(), stdout);
    if (advice.best < 0) throw CLI::RuntimeError(1);
  });
}

}  // namespace pinchlab::experiments
