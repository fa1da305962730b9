// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/features.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "analysis/experiments/step_cost.h"
#include "base/at.h"
#include "demos/scenes/library.h"
#include "sim/cable/cable.h"
#include "sim/cable/mass.h"
#include "sim/cable/waves.h"
#include "sim/compound.h"
#include "sim/detect/contacts.h"
#include "sim/detect/pinch.h"
#include "sim/diagnostics.h"
#include "sim/solve/capstan.h"
#include "sim/solve/rows.h"

namespace pinchlab::experiments {

namespace {

constexpr double share_limit = 0.02;  // of a step, that was asked for

struct FeatureCost {
  std::string scene, feature, how;
  double cost_s = 0.0, step_s = 0.0;
  [[nodiscard]] double share() const { return cost_s / step_s; }
};

Configuration configured(Method method, bool sleep) {
  Configuration configuration = method;
  configuration.sleep = sleep;
  return configuration;
}

double median(const std::vector<double>& samples) {
  return spread(samples).median;
}

/// What a step takes longer with one configuration than with another, s: the median over pairs of
/// neighbouring batches. Where the worlds lie in memory matters as much as what is looked for, so
/// both are made anew many times. What is left of the machine's noise may be negative.
double difference(const Scene& scene, const Configuration& with, const Configuration& without,
                  const Effort& effort) {
  constexpr int rounds = 16;
  const Effort part{effort.seconds / rounds, effort.samples / rounds};
  std::vector<double> differences;
  std::vector<World> kept;  // so that the next ones lie elsewhere
  for (int round = 0; round < rounds; ++round) {
    World a = make_world(scene, with), b = make_world(scene, without);
    Workspace work_a, work_b;
    if (round % 2 == 1) std::swap(a, b), a.configuration = with, b.configuration = without;
    const BothCosts both = measure_both([&] { step_or_throw(scene, a, work_a); },
                                        [&] { step_or_throw(scene, b, work_b); }, part);
    differences.insert(differences.end(), both.differences.begin(), both.differences.end());
    kept.push_back(std::move(round % 3 == 0 ? a : b));
  }
  return median(differences);
}

/// The functions that know loops, called twice a link: about what a step makes of them.
double loop_seconds(const World& world, const Effort& effort) {
  volatile int kept = 0;
  const auto ask_all = [&] {
    int sum = 0;
    for (const CableState& cable : world.cables) {
      for (int i = 0; i < static_cast<int>(cable.links.size()); ++i) {
        sum += previous_link(cable, i) + next_link(cable, i);
      }
    }
    kept = sum;
  };
  const auto without = [&] {
    int sum = 0;
    for (const CableState& cable : world.cables) {
      for (int i = 0; i < static_cast<int>(cable.links.size()); ++i) sum += (i - 1) + (i + 1);
    }
    kept = sum;
  };
  return median(measure_both(ask_all, without, effort).differences);
}

/// What a step asks of links and bodies to find that all are discs of their own.
int ask_for_shapes(World& world) {
  int sum = 0;
  for (const CableState& cable : world.cables) {
    for (const Link& link : cable.links) {
      if (link.body < 0) continue;
      sum += mover_of(world, link.body) + link.corner;
    }
  }
  carry(world, world.carried);
  return sum;
}

/// And of cables to find that none has mass or nodes, or keeps what it is stretched by on rims.
double ask_for_mass(const World& world) {
  double sum = 0.0;
  for (const CableState& cable : world.cables) {
    sum += wave_of(world, cable) + (is_massed(cable) || !cable.rims.empty() ? 1.0 : 0.0);
  }
  return sum;
}

std::vector<FeatureCost> measure(const Scene& scene, const std::string& name,
                                 const Effort& effort) {
  const Configuration ours = configured(Method::pinch, false);
  World world = make_world(scene, ours);
  Workspace work;
  const StepCost step_cost = measure_steps(scene, world, work, effort);
  const double step_s = step_cost.step_s.median;
  const Effort little{0.3 * effort.seconds, effort.samples};
  // Less the call itself, which is of this program and not of the step.
  const auto call = [&](const std::function<void()>& run) {
    const std::function<void()> nothing = [] {};
    return median(measure_both(run, nothing, little).differences);
  };
  volatile double kept = 0.0;  // what is asked for is not left out
  std::vector<FeatureCost> costs;
  const auto add = [&](const char* feature, const char* how, double seconds) {
    costs.push_back({name, feature, how, seconds, step_s});
  };
  add("slip", "`find_runs`", call([&] {
        for (const Part& part : work.parts.list) {
          find_runs(world, work.parts, part, at(work.systems, part.system), work.solve);
        }
      }));
  Configuration at_steps = ours;
  at_steps.events = Events::at_steps;
  add("pinch", "`pinch` less `cable`, both with events at the steps",
      difference(scene, at_steps, configured(Method::cable, false), effort));
  add("events", "at their time, with exact lengths, less at the steps",
      difference(scene, ours, at_steps, effort));
  add("contacts", "`make_contact_rows`, `find_contacts`, `configure_pinches`", call([&] {
        for (const Part& part : work.parts.list) {
          make_contact_rows(scene, world, work.parts, part, TimeSpan{},
                            at(work.systems, part.system), work.solve);
        }
        find_contacts(scene, world, work);
        configure_pinches(world, work);
      }));
  add("loops", "`previous_link`, `next_link`", loop_seconds(world, little));
  add("corners, compounds", "`Link::corner` and `mover_of` of every link, `carry`",
      call([&] { kept = ask_for_shapes(world); }));
  add("cables with mass", "`is_massed`, `wave_of` and `rims` of every cable",
      call([&] { kept = ask_for_mass(world); }));
  add("diagnostics", "`diagnose` less `check_finite`",
      step_cost.stage_s[static_cast<std::size_t>(Stage::diagnose)].median -
          call([&] { check_finite(scene, world); }));
  add("sleep", "on less off", difference(scene, configured(Method::pinch, true), ours, effort));
  add("(nothing)", "the same less the same", difference(scene, ours, ours, effort));
  return costs;
}

/// What it costs to keep a World, for a step to go back to.
struct CopyCost {
  std::string scene;
  double anew_s = 0.0, over_s = 0.0;  // a World that is made, and one that has been a copy before
  double step_s = 0.0;
};

CopyCost measure_copy(const Scene& scene, const std::string& name, const Effort& effort) {
  World world = make_world(scene, configured(Method::pinch, false));
  Workspace work;
  const StepCost step_cost = measure_steps(scene, world, work, effort);
  const Effort little{0.3 * effort.seconds, effort.samples};
  volatile std::int64_t kept = 0;  // so that no copy is left out
  World copy = world;
  const auto anew = [&] {
    const World made = world;
    kept = made.step;
  };
  const auto over = [&] {
    copy = world;
    kept = copy.step;
  };
  const BothCosts both = measure_both(anew, over, little);
  return {name, both.first.seconds.median, both.second.seconds.median, step_cost.step_s.median};
}

struct SleepingCables {
  int count = 0, moving = 0, steps = 0;
  double on_s = 0.0, off_s = 0.0, only_moving_s = 0.0;  // a step
  double largest_difference_moving = 0.0;               // m, of bodies that swing, on against off
  double largest_difference_resting = 0.0;              // m, of the others
};

/// Both runs in step with each other, compared body by body; timed after they have settled.
SleepingCables measure_sleeping_cables(int count, int moving, int steps, const Effort& effort) {
  const Scene scene = disconnected_scene(count, moving);
  World on = make_world(scene, configured(Method::pinch, true));
  World off = make_world(scene, configured(Method::pinch, false));
  Workspace on_work, off_work, only_work;
  SleepingCables result{count, moving, steps};
  for (int i = 0; i < steps; ++i) {
    step_or_throw(scene, on, on_work);
    step_or_throw(scene, off, off_work);
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      double& largest = b < 2 * static_cast<std::size_t>(moving)
                            ? result.largest_difference_moving
                            : result.largest_difference_resting;
      largest = std::max(largest, (on.position[b] - off.position[b]).norm());
    }
  }
  const BothCosts both = measure_both([&] { step_or_throw(scene, on, on_work); },
                                      [&] { step_or_throw(scene, off, off_work); }, effort);
  result.on_s = both.first.seconds.median;
  result.off_s = both.second.seconds.median;
  const Scene few = disconnected_scene(moving, moving);
  World only = make_world(few, configured(Method::pinch, false));
  result.only_moving_s =
      measure_call([&] { step_or_throw(few, only, only_work); }, effort).seconds.median;
  return result;
}

std::string share_text(double share) {
  return fmt::format("{:.2f} %", 100.0 * share);
}

std::string verdict(const FeatureCost& cost, double noise) {
  if (cost.feature == "(nothing)") return "";
  if (cost.share() <= share_limit) return "yes";
  return cost.share() <= share_limit + noise ? "within the noise" : "**no**";
}

double noise_of(const std::vector<FeatureCost>& costs, const std::string& scene) {
  for (const FeatureCost& cost : costs) {
    if (cost.scene == scene && cost.feature == "(nothing)") return std::abs(cost.share());
  }
  return 0.0;
}

/// "sleep (3 pulleys, 2.30 %)" of all that cost more than the limit and the noise, or "none".
std::string beyond_limit(const std::vector<FeatureCost>& costs) {
  std::vector<std::string> found;
  for (const FeatureCost& cost : costs) {
    if (cost.feature == "(nothing)" || cost.share() <= share_limit + noise_of(costs, cost.scene)) {
      continue;
    }
    found.push_back(fmt::format("{} ({}, {})", cost.feature, cost.scene, share_text(cost.share())));
  }
  return found.empty() ? "none" : fmt::format("{}", fmt::join(found, ", "));
}

std::string features_text(const std::vector<FeatureCost>& costs) {
  std::vector<std::vector<std::string>> rows;
  rows.reserve(costs.size());
  for (const FeatureCost& cost : costs) {
    rows.push_back({cost.scene, cost.feature, cost.how, fmt::format("{:.1f} ns", 1e9 * cost.cost_s),
                    time_text(cost.step_s), share_text(cost.share()),
                    verdict(cost, noise_of(costs, cost.scene))});
  }
  return fmt::format(
             "# What a feature costs a scene that does not use it\n\n"
             "Each feature shall cost a scene that does not use it {} of a step at most. Beyond "
             "that and the noise of the measurement: {}.\n\n"
             "Where a configuration leaves the feature out, whole steps with and without it are "
             "compared, by turns in one program. For the others it is the processor time of the "
             "functions that remain in a step of a scene without the feature, by themselves: "
             "anyone can measure that again without another build of the simulator. Called by "
             "themselves they find all they need in the cache, which flatters them; inside of a "
             "step they hide behind others, which makes them cheaper still. (Of loops it "
             "counts two calls a link, which is about what a step makes.) The scenes swing for "
             "ever, without contacts, pinches, slip and loops; sleep is off unless it is what is "
             "measured. "
             "`(nothing)` compares a configuration with itself: the noise.\n\n",
             share_text(share_limit), beyond_limit(costs)) +
         markdown_table({"scene", "feature", "measured", "cost", "step", "share",
                         fmt::format("at most {}", share_text(share_limit))},
                        rows);
}

std::string copies_text(const std::vector<CopyCost>& copies) {
  std::vector<std::vector<std::string>> rows;
  rows.reserve(copies.size());
  for (const CopyCost& c : copies) {
    rows.push_back({c.scene, time_text(c.anew_s), time_text(c.over_s), time_text(c.step_s),
                    share_text(c.over_s / c.step_s)});
  }
  return "\n## Copies\n\n"
         "A `World` is all that a restart needs: whoever tries a step and goes back copies it. "
         "Into "
         "a copy that there was before nothing is allocated.\n\n" +
         markdown_table({"scene", "a new copy", "over an old copy", "step", "old copy, of a step"},
                        rows);
}

std::string sleep_text(const SleepingCables& s) {
  return fmt::format(
      "\n## A thousand cables of which ten move\n\n"
      "{} cables apart from each other, of which {} swing (thesis 7.1 hopes for cables that freeze "
      "at rest). A step costs {} without sleep and {} with it, {:.1f} times less; the {} swinging "
      "cables alone cost {}. Over {} steps with and without sleep the swinging bodies' positions "
      "differ by {:.2g} m at most, the resting ones' by {:.2g} m.\n\n",
      s.count, s.moving, time_text(s.off_s), time_text(s.on_s), s.off_s / s.on_s, s.moving,
      time_text(s.only_moving_s), s.steps, s.largest_difference_moving,
      s.largest_difference_resting);
}

}  // namespace

void run_features(const Options& options) {
  const Effort effort = options.quick ? Effort{0.2, 100} : Effort{3.0, 1500};
  Output output(options.out);
  Progress progress("features", 3.0);
  constexpr int few = 3, many = 301;
  std::vector<FeatureCost> costs;
  std::vector<CopyCost> copies;
  for (const int pulleys : {few, many}) {
    const Scene scene = swinging_scene(pulleys);
    const std::string name = fmt::format("{} pulleys", pulleys);
    const std::vector<FeatureCost> found = measure(scene, name, effort);
    costs.insert(costs.end(), found.begin(), found.end());
    copies.push_back(measure_copy(scene, name, effort));
    progress.done(1.0);
  }
  const SleepingCables sleeping =
      measure_sleeping_cables(1000, 10, options.quick ? 240 : 1200, effort);
  progress.done(1.0);
  Csv csv({"scene", "feature", "measured", "cost_s", "step_s", "share"});
  for (const FeatureCost& c : costs) {
    csv.row({c.scene, c.feature, c.how, c.cost_s, c.step_s, c.share()});
  }
  output.csv("features", csv, options.command);
  Csv copied({"scene", "new_copy_s", "old_copy_s", "step_s"});
  for (const CopyCost& c : copies) copied.row({c.scene, c.anew_s, c.over_s, c.step_s});
  output.csv("copies", copied, options.command);
  Csv sleep({"cables", "moving", "steps", "on_s", "off_s", "only_moving_s",
             "largest_difference_moving_m", "largest_difference_resting_m"});
  sleep.row({std::int64_t{sleeping.count}, std::int64_t{sleeping.moving},
             std::int64_t{sleeping.steps}, sleeping.on_s, sleeping.off_s, sleeping.only_moving_s,
             sleeping.largest_difference_moving, sleeping.largest_difference_resting});
  output.csv("sleep", sleep, options.command);
  output.page("features", features_text(costs) + copies_text(copies) + sleep_text(sleeping),
              options.command);
  fmt::print("{}: what features cost scenes that do not use them\n",
             (options.out / "features.md").string());
}

}  // namespace pinchlab::experiments
