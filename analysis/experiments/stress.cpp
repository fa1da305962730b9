// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/stress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "analysis/experiments/bare_pass.h"

namespace pinchlab::experiments {

namespace {

Configuration awake(Configuration configuration) {
  configuration.sleep = false;
  return configuration;
}

template <class Change>
Configuration ours_but(Change change) {
  Configuration configuration = awake(Method::pinch);
  change(configuration);
  return configuration;
}

Configuration thesis_cable() {
  Configuration configuration = thesis_configuration();
  configuration.method = Method::cable;
  return configuration;
}

StressResult measure(const StressCase& one, int load, const Effort& effort) {
  const Scene scene = stress_scene(load, one.spacing);
  World world = make_world(scene, one.configuration);
  Workspace work;
  StressResult result{one.name, load, {}, {}, {}};
  result.cost = measure_steps(scene, world, work, effort);
  result.elements = count_elements(world);
  result.tensions = tensions_of(world);
  return result;
}

/// The scene begins again before a weight of the chain comes to its pulley, after 31 s: from then
/// on it bounces and swings, which is another scene.
BareResult measure_bare(const char* name, const Scene& scene, Method method, const Effort& effort) {
  const World start = make_world(scene, awake(method));
  World world = start;
  Workspace work;
  BarePass pass(scene, world);
  BareResult result{name, pass.rows.size(), {}, {}};
  const BothCosts both = measure_both([&] { pass.step(); },
                                      [&] {
                                        if (world.step == steps_of_bare) world = start;
                                        step_or_throw(scene, world, work);
                                      },
                                      effort);
  result.bare = both.first;
  result.step = both.second;
  return result;
}

SlackResult measure_slack(int load, double solves_with) {
  Scene scene = stress_scene(load, pinched_spacing);
  scene.cables.front().slack = 0.0;
  scene.cables.front().axial_stiffness = infinity;
  World world = make_world(scene, awake(Method::pinch));
  Workspace work;
  constexpr int steps = 10;
  for (int i = 0; i < steps; ++i) step_or_throw(scene, world, work);
  return {load, solves_with, static_cast<double>(world.diagnostics.total_solves) / steps,
          world.diagnostics.fallbacks};
}

SleepResult measure_sleep(int load, double awake_s, const Effort& effort) {
  const Scene scene = stress_scene(load, pinched_spacing);
  Configuration configuration = Method::pinch;
  configuration.sleep = true;
  World world = make_world(scene, configuration);
  Workspace work;
  SleepResult result{load, infinity, awake_s, 0.0};
  while (!result.asleep() && world.time() < SleepResult::most_s) {
    step_or_throw(scene, world, work);
    if (std::ranges::all_of(work.parts.list, &Part::asleep)) result.after_s = world.time();
  }
  const Effort little{0.2 * effort.seconds, effort.samples};
  const CallCost cost = measure_call([&] { step_or_throw(scene, world, work); }, little);
  result.asleep_s = cost.seconds.median;
  return result;
}

/// Rough processor time of a case, for telling the time left; all-pairs detection is quadratic.
double expected_work(const StressCase& one, int load) {
  const double relative = load / 1000.0;
  const bool quadratic = one.configuration.detection == Detection::all_pairs;
  return 0.3 + relative + (quadratic ? 3.0 * std::min(1.0, relative * 4.0) + relative : 0.0);
}

Csv step_table(const StressResults& results) {
  Csv csv({"case",
           "load",
           "bodies",
           "joints",
           "segments",
           "non_transitional",
           "transitional",
           "contacts",
           "attachments",
           "steps",
           "step_low_s",
           "step_median_s",
           "step_high_s",
           "per_load_s",
           "per_joint_s",
           "per_attachment_s",
           "solves_per_step",
           "fallbacks",
           "least_tension_n",
           "greatest_tension_n"});
  const auto whole = [](std::size_t count) { return static_cast<std::int64_t>(count); };
  for (const StressResult& r : results.steps) {
    const ElementCounts& e = r.elements;
    const Spread& s = r.cost.step_s;
    csv.row({r.name,
             std::int64_t{r.load},
             whole(e.bodies),
             whole(e.joints),
             whole(e.segments),
             whole(e.non_transitional),
             whole(e.transitional),
             whole(e.contacts),
             whole(e.attachments()),
             r.cost.steps,
             s.low,
             s.median,
             s.high,
             s.median / r.load,
             s.median / static_cast<double>(e.joints),
             s.median / static_cast<double>(e.attachments()),
             r.cost.solves,
             r.cost.fallbacks,
             r.tensions.least,
             r.tensions.greatest});
  }
  return csv;
}

Csv stage_table(const StressResults& results) {
  Csv csv({"case", "load", "stage", "thesis_name", "low_s", "median_s", "high_s", "per_load_s",
           "per_joint_s", "per_attachment_s"});
  for (const StressResult& r : results.steps) {
    for (std::size_t i = 0; i < stage_count; ++i) {
      const Spread& s = r.cost.stage_s[i];
      csv.row({r.name, std::int64_t{r.load}, to_string(static_cast<Stage>(i)),
               thesis_name(static_cast<Stage>(i)), s.low, s.median, s.high, s.median / r.load,
               s.median / static_cast<double>(r.elements.joints),
               s.median / static_cast<double>(r.elements.attachments())});
    }
  }
  return csv;
}

Csv bare_table(const StressResults& results) {
  Csv csv({"scene", "segments", "bare_low_s", "bare_median_s", "bare_high_s", "step_low_s",
           "step_median_s", "step_high_s", "ratio"});
  for (const BareResult& r : results.bare) {
    const Spread &b = r.bare.seconds, &s = r.step.seconds;
    csv.row({r.scene, static_cast<std::int64_t>(r.segments), b.low, b.median, b.high, s.low,
             s.median, s.high, r.ratio()});
  }
  return csv;
}

Csv growth_table(const StressResults& results) {
  Csv csv({"what", "size", "median_s", "per_unit_s", "exponent", "cold_s", "cold_per_unit_s",
           "cold_exponent", "copy_s", "copy_per_unit_s"});
  for (const GrowthResult& r : results.growth) {
    for (std::size_t i = 0; i < r.sizes.size(); ++i) {
      csv.row({r.what, std::int64_t{r.sizes[i]}, r.seconds[i], r.seconds[i] / r.sizes[i],
               r.exponent(), r.cold_seconds[i], r.cold_seconds[i] / r.sizes[i], r.cold_exponent(),
               r.copy_seconds[i], r.copy_seconds[i] / r.sizes[i]});
    }
  }
  return csv;
}

}  // namespace

const std::vector<StressCase>& stress_cases() {
  static const std::vector<StressCase> cases{
      {"pinch", awake(Method::pinch), pinched_spacing},
      {"thesis", thesis_configuration(), pinched_spacing},
      {"cable", awake(Method::cable), free_spacing},
      {"thesis cable", thesis_cable(), free_spacing},
      {"iterative", ours_but([](Configuration& c) { c.solver = Solver::iterative; }),
       pinched_spacing},
      {"all pairs", ours_but([](Configuration& c) { c.detection = Detection::all_pairs; }),
       pinched_spacing},
      {"three rows", ours_but([](Configuration& c) { c.pinch_rows = PinchRows::three; }),
       pinched_spacing},
  };
  return cases;
}

const StressResult* find(const StressResults& results, const std::string& name, int load) {
  for (const StressResult& r : results.steps) {
    if (r.name == name && r.load == load) return &r;
  }
  return nullptr;
}

void run_stress(const Options& options) {
  const std::vector<int> loads = loads_of(options, {1, 5, 20, 100, 1000});
  const Effort effort = effort_of(options);
  Output output(options.out);
  double work = 0.0;
  for (const StressCase& one : stress_cases()) {
    for (const int load : loads) work += expected_work(one, load);
  }
  Progress progress("stress", work);
  StressResults results;
  for (const int load : loads) {
    for (const StressCase& one : stress_cases()) {
      results.steps.push_back(measure(one, load, effort));
      progress.done(expected_work(one, load));
    }
  }
  results.bare = {measure_bare("81 segments over fixed pulleys, where nothing moves",
                               stress_scene(20, free_spacing), Method::pinch, effort),
                  measure_bare("the same by plain cable joints", stress_scene(20, free_spacing),
                               Method::cable, effort),
                  measure_bare("a weight that swings beside 81 pulleys", swinging_scene(81),
                               Method::pinch, effort),
                  measure_bare("weights over 81 light pulleys, where all moves", chain_scene(81),
                               Method::pinch, effort)};
  for (const int load : loads) {
    const StressResult& ours = *find(results, "pinch", load);
    results.slack.push_back(measure_slack(load, ours.cost.solves));
    results.sleep.push_back(measure_sleep(load, ours.cost.step_s.median, effort));
  }
  results.growth = measure_growth(Effort{0.3 * effort.seconds, effort.samples});
  results.independence = measure_independence(Effort{0.3 * effort.seconds, effort.samples});
  output.csv("stress", step_table(results), options.command);
  output.csv("stress-stages", stage_table(results), options.command);
  output.csv("stress-bare-pass", bare_table(results), options.command);
  output.csv("stress-growth", growth_table(results), options.command);
  draw_stress(results, output);
  output.page("stress", stress_page(results), options.command);
  fmt::print("{}: what a step costs as scenes grow\n", (options.out / "stress.md").string());
}

}  // namespace pinchlab::experiments
