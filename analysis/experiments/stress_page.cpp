// SPDX-License-Identifier: GPL-3.0-or-later
// The stress test in words and pictures, all of it computed from the measurements.

#include <fmt/format.h>

#include <algorithm>

#include "analysis/experiments/chart.h"
#include "analysis/experiments/stress.h"

namespace pinchlab::experiments {

namespace {

// What was asked for.
constexpr int small_load = 20, large_load = 1000;
constexpr double small_gain = 6.0, large_gain = 100.0, growth_limit = 1.06, bare_limit = 3.0;
constexpr double other_growth_limit = 1.05;

std::vector<int> loads_in(const StressResults& results) {
  std::vector<int> loads;
  for (const StressResult& r : results.steps) {
    if (std::find(loads.begin(), loads.end(), r.load) == loads.end()) loads.push_back(r.load);
  }
  return loads;
}

double median(const StressResults& results, const std::string& name, int load) {
  return find(results, name, load)->cost.step_s.median;
}

/// How many times as long a step of `name` takes as one of `pinch`.
double times_ours(const StressResults& results, const std::string& name, int load) {
  return median(results, name, load) / median(results, "pinch", load);
}

std::size_t place(Stage stage) {
  return static_cast<std::size_t>(stage);
}

/// Growth exponent from load 20 upwards, of the whole step or of one stage; nothing where fewer
/// than two loads are measured or the stage takes less than the clock can tell.
std::optional<double> growth(const StressResults& results, const std::string& name,
                             std::optional<Stage> stage = std::nullopt) {
  constexpr double least_s = 20e-9;
  std::vector<double> sizes, costs;
  for (const StressResult& r : results.steps) {
    if (r.name != name || r.load < small_load) continue;
    const double cost = stage ? r.cost.stage_s[place(*stage)].median : r.cost.step_s.median;
    if (cost < least_s) return std::nullopt;
    sizes.push_back(r.load);
    costs.push_back(cost);
  }
  if (sizes.size() < 2) return std::nullopt;
  return growth_exponent(sizes, costs);
}

std::string exponent_text(const std::optional<double>& exponent) {
  return exponent ? fmt::format("{:.2f}", *exponent) : "–";
}

/// The three stages that take most of a step, "solve 53 %, configure_pinches 20 % and ...".
std::string largest_stages(const StressResult& r) {
  std::array<std::size_t, stage_count> order{};
  double sum = 0.0;
  for (std::size_t i = 0; i < stage_count; ++i) {
    order[i] = i;
    sum += r.cost.stage_s[i].median;
  }
  std::sort(order.begin(), order.end(), [&r](std::size_t a, std::size_t b) {
    return r.cost.stage_s[a].median > r.cost.stage_s[b].median;
  });
  const auto part = [&](std::size_t i) {
    return fmt::format("`{}` {:.0f} %", to_string(static_cast<Stage>(order[i])),
                       100.0 * r.cost.stage_s[order[i]].median / sum);
  };
  return fmt::format("{}, {} and {}", part(0), part(1), part(2));
}

std::string verdict(bool met) {
  return met ? "yes" : "**no**";
}

std::string asked_and_measured(const StressResults& results) {
  std::vector<std::vector<std::string>> rows;
  const auto gain = [&](int load, double asked) {
    if (find(results, "pinch", load) == nullptr) return;
    const double measured = times_ours(results, "thesis", load);
    rows.push_back({fmt::format("load {}: step of `thesis` / step of `pinch`", load),
                    fmt::format("at least {:g}", asked), fmt::format("{:.1f}", measured),
                    verdict(measured >= asked)});
  };
  gain(small_load, small_gain);
  gain(large_load, large_gain);
  if (const std::optional<double> exponent = growth(results, "pinch")) {
    rows.push_back({fmt::format("growth exponent of the whole step, load {} to {}", small_load,
                                loads_in(results).back()),
                    fmt::format("at most {:g}", growth_limit), fmt::format("{:.3f}", *exponent),
                    verdict(*exponent <= growth_limit)});
  }
  const SleepResult& sleep = results.sleep.back();
  rows.push_back({fmt::format("load {} at rest falls asleep", sleep.load),
                  fmt::format("within {:g} s", SleepResult::most_s),
                  sleep.asleep() ? fmt::format("after {:.2f} s", sleep.after_s) : "never",
                  verdict(sleep.asleep())});
  for (const BareResult& bare : {results.bare.front(), results.bare.back()}) {
    rows.push_back({fmt::format("{}: step / bare pass", bare.scene),
                    fmt::format("at most {:g}", bare_limit), fmt::format("{:.2f}", bare.ratio()),
                    verdict(bare.ratio() <= bare_limit)});
  }
  for (const GrowthResult& r : results.growth) {
    const auto row = [&](const char* where, double exponent) {
      rows.push_back({fmt::format("growth exponent of {}, {} to {}{}", r.what, r.sizes.front(),
                                  r.sizes.back(), where),
                      fmt::format("at most {:g}", other_growth_limit),
                      fmt::format("{:.3f}", exponent), verdict(exponent <= other_growth_limit)});
    };
    row("", r.exponent());
    row(", with empty caches", r.cold_exponent());
  }
  return markdown_table({"", "asked", "measured", "met"}, rows);
}

std::string summary(const StressResults& results) {
  std::string text;
  for (const int load : {small_load, large_load}) {
    if (find(results, "pinch", load) == nullptr) continue;
    text += fmt::format(
        "At load {} a step of `pinch` takes {} and a step of `thesis` {}, {:.1f} times as long. ",
        load, time_text(median(results, "pinch", load)), time_text(median(results, "thesis", load)),
        times_ours(results, "thesis", load));
  }
  const auto ours = growth(results, "pinch"), theirs = growth(results, "thesis");
  if (ours && theirs) {
    text += fmt::format(
        "From load {} to {} the cost of a step grows with the power {:.2f} of the load for "
        "`pinch` and {:.2f} for `thesis` (1 is linear, 2 quadratic).",
        small_load, loads_in(results).back(), *ours, *theirs);
  }
  return text + "\n";
}

std::string how() {
  return fmt::format(
      "## What was measured\n\n"
      "The scenes are the thesis' (3.2.1, Figure 3.1): four pulleys of radius 0.5 m with fixed "
      "axles a load on one cable of half width 0.05 m without slip. At a spacing of {:.11g} m, "
      "just under 2 r + 2 w, every load has two transitional and two non-transitional pinches and "
      "neighbouring loads two more; at {:g} m there are none. The element counts are those of the "
      "thesis' Tables 5.1 and 5.2 (tests hold them equal). The cable is elastic (EA = {:g} N) and "
      "{:g} % stretched, so that all of its segments carry {:g} N and all rows are solved in every "
      "step.\n\n"
      "`pinch` and `cable` are ours (direct solver, sweep and prune, one row a pinch) on the "
      "scene with and without pinches; `thesis` and `thesis cable` are the thesis' methods ({} "
      "Gauss-Seidel sweeps, all pairs tested, three rows a pinch) on the same, in the same "
      "program. Steps are timed in processor time, in batches that make the clock's own cost "
      "less than 1 %, hundreds of them, but fewer where they take tens of milliseconds: the tables "
      "tell. Figures are medians, bands go from the first to the ninth decile. Stages are "
      "timed by a clock that runs on inside of the step, whose own time is subtracted. Sleep is "
      "off: at rest, our own step would cost next to nothing.\n\n",
      pinched_spacing, free_spacing, stress_stiffness, 100.0 * stress_strain,
      stress_stiffness * stress_strain, thesis_configuration().iterations);
}

std::string step_table_text(const StressResults& results) {
  std::vector<std::vector<std::string>> rows;
  for (const int load : loads_in(results)) {
    std::vector<std::string> row{fmt::format("{}", load)};
    for (const char* name : {"pinch", "thesis", "cable", "thesis cable"}) {
      const StepCost& cost = find(results, name, load)->cost;
      row.push_back(fmt::format("{} ({})", time_text(cost.step_s.median), cost.steps));
    }
    row.push_back(fmt::format("{:.1f}", times_ours(results, "thesis", load)));
    row.push_back(fmt::format(
        "{:.1f}", median(results, "thesis cable", load) / median(results, "cable", load)));
    rows.push_back(row);
  }
  return markdown_table({"load", "`pinch` (steps timed)", "`thesis`", "`cable`", "`thesis cable`",
                         "thesis / pinch", "thesis cable / cable"},
                        rows);
}

std::string whole_step(const StressResults& results) {
  const int least = loads_in(results).front(), most = loads_in(results).back();
  const auto ratio = [&](const char* a, const char* b, int load) {
    return median(results, a, load) / median(results, b, load);
  };
  std::string text = fmt::format(
      "## The whole step\n\n![Cost of a step over the load, and divided by load, joints and "
      "attachments](stress-step.svg)\n\n"
      "The advantage of `pinch` over `thesis` goes from {:.1f} at load {} to {:.1f} at load {}; "
      "without pinches that of `cable` over `thesis cable` from {:.1f} to {:.1f}. ",
      ratio("thesis", "pinch", least), least, ratio("thesis", "pinch", most), most,
      ratio("thesis cable", "cable", least), ratio("thesis cable", "cable", most));
  const StressResult &pinch = *find(results, "pinch", most), &cable = *find(results, "cable", most);
  const auto per = [](const StressResult& r, std::size_t count) {
    return r.cost.step_s.median / static_cast<double>(count);
  };
  text += fmt::format(
      "At load {} the pinched scene costs our step {:.1f} times the free one, {:.1f} times a joint "
      "({} and {}) and {:.1f} times an attachment ({} and {}): what is left after the number of "
      "elements is taken out is the price of contacts and pinches. (Attachments as in the thesis' "
      "Figure 5.3: joints that are there without pinches, plus non-transitional pinches.)\n\n",
      most, ratio("pinch", "cable", most),
      per(pinch, pinch.elements.joints) / per(cable, cable.elements.joints),
      time_text(per(pinch, pinch.elements.joints)), time_text(per(cable, cable.elements.joints)),
      per(pinch, pinch.elements.attachments()) / per(cable, cable.elements.attachments()),
      time_text(per(pinch, pinch.elements.attachments())),
      time_text(per(cable, cable.elements.attachments())));
  return text + step_table_text(results);
}

std::string stages(const StressResults& results) {
  const int most = loads_in(results).back();
  std::string text = fmt::format(
      "\n## The stages\n\n![Cost of each stage of a step over the load](stress-stages.svg)\n\n"
      "Of a step of `pinch` at load {} most goes to {}; of a step of `thesis` to {}. Growth "
      "exponents from load {} on (– where a stage is too short to be timed):\n\n",
      most, largest_stages(*find(results, "pinch", most)),
      largest_stages(*find(results, "thesis", most)), small_load);
  std::vector<std::vector<std::string>> rows;
  const auto row = [&](const std::string& name, const char* thesis, std::optional<Stage> stage) {
    rows.push_back({name, thesis});
    for (const char* one : {"pinch", "thesis", "cable", "thesis cable"}) {
      rows.back().push_back(exponent_text(growth(results, one, stage)));
    }
  };
  row("whole step", "TimeStep", std::nullopt);
  for (std::size_t i = 0; i < stage_count; ++i) {
    const auto stage = static_cast<Stage>(i);
    row(fmt::format("`{}`", to_string(stage)), thesis_name(stage), stage);
  }
  return text + markdown_table({"stage", "in the thesis' Algorithm 1", "`pinch`", "`thesis`",
                                "`cable`", "`thesis cable`"},
                               rows);
}

std::string shared_stages(const StressResults& results) {
  const int most = loads_in(results).back();
  const StressResult &pinch = *find(results, "pinch", most), &cable = *find(results, "cable", most);
  std::string text =
      "\n## Stages that pinch joints and cable joints share\n\n![Cost of the shared stages a joint "
      "and an attachment](stress-shared.svg)\n\n";
  text += fmt::format("A joint and step at load {}, ours:", most);
  const char* between = " ";
  for (const Stage stage : {Stage::update_segments, Stage::init_segments, Stage::solve}) {
    const auto per_joint = [&](const StressResult& r) {
      return r.cost.stage_s[place(stage)].median / static_cast<double>(r.elements.joints);
    };
    text += fmt::format("{}`{}` takes {} with pinch joints and {} with cable joints", between,
                        to_string(stage), time_text(per_joint(pinch)), time_text(per_joint(cable)));
    between = ", ";
  }
  return text +
         ". The joints of a non-transitional pinch share one row of our solver and have no length "
         "to test for hits, which makes a joint cheaper there; the contacts' rows come on top.\n";
}

std::string choices(const StressResults& results) {
  std::string text =
      "\n## One choice at a time\n\n![Cost of a step with one of the thesis' choices, relative to "
      "ours](stress-choices.svg)\n\n";
  for (const char* name : {"iterative", "all pairs", "three rows"}) {
    text += fmt::format("`pinch` with `{}`:", name);
    const char* between = " ";
    for (const int load : {loads_in(results).front(), small_load, loads_in(results).back()}) {
      if (find(results, name, load) == nullptr) continue;
      const double solves = find(results, name, load)->cost.solves;
      text += fmt::format("{}{:.2f} times our step at load {}{}", between,
                          times_ours(results, name, load), load,
                          solves > 1.05 ? fmt::format(" ({:.1f} solves a step)", solves) : "");
      between = ", ";
    }
    text += ". ";
  }
  return text +
         "What the iterative solver's answers are worth is told by the accuracy experiment; here "
         "it does its sweeps whatever comes out. With three rows a pinch that bears nothing "
         "drops out of the direct solver's system; it costs more where that guess has to be "
         "mended.\n";
}

std::string tension_and_solves(const StressResults& results) {
  std::vector<std::vector<std::string>> rows;
  for (const SlackResult& r : results.slack) {
    const Tensions &ours = find(results, "pinch", r.load)->tensions,
                   &theirs = find(results, "thesis", r.load)->tensions;
    rows.push_back({fmt::format("{}", r.load),
                    fmt::format("{:.4g} to {:.4g}", ours.least, ours.greatest),
                    fmt::format("{:.4g} to {:.4g}", theirs.least, theirs.greatest),
                    fmt::format("{:.2f}", r.solves_with), fmt::format("{:.2f}", r.solves_without),
                    fmt::format("{}", r.fallbacks_without)});
  }
  const auto most = std::max_element(results.slack.begin(), results.slack.end(),
                                     [](const SlackResult& a, const SlackResult& b) {
                                       return a.solves_without < b.solves_without;
                                     });
  return fmt::format(
             "\n## Tension, and solves a step\n\n"
             "The least tension of any segment at the end of the run shows that the scenes are "
             "under load. The direct solver needs one solve a step where its guess of what is taut "
             "and what touches is right. A cable exactly as long as its path carries nothing and "
             "fits many states; then the most solves a step are {:.1f}, at load {}.\n\n",
             most->solves_without, most->load) +
         markdown_table({"load", "tension, `pinch`, N", "tension, `thesis`, N", "solves a step",
                         "solves a step without tension", "of those 10 steps not settled"},
                        rows);
}

std::string growth_of_others(const StressResults& results) {
  const std::string text = fmt::format(
      "\n## Many things that share nothing, and long chains\n\n"
      "Nothing here sleeps. Time a unit (cable, disc, pulley, load) at each size. Instructions are "
      "linear in all of these ([instructions](instructions.md)); what grows besides is memory, as "
      "small scenes find theirs in caches. With these emptied before each call all wait alike. A "
      "copy of the `World` (of `make_world`: a new one) reads and writes the state once: where it "
      "takes more than an exponent of {:g} leaves, no step could keep to that here.\n\n",
      other_growth_limit);
  std::vector<std::vector<std::string>> rows;
  const auto list = [](const std::vector<double>& seconds, const std::vector<int>& sizes) {
    std::vector<std::string> times;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      times.push_back(time_text(seconds[i] / sizes[i]));
    }
    return fmt::format("{}", fmt::join(times, ", "));
  };
  for (const GrowthResult& r : results.growth) {
    rows.push_back({r.what, fmt::format("{}", fmt::join(r.sizes, ", ")), list(r.seconds, r.sizes),
                    fmt::format("{:.2f}", r.exponent()), list(r.cold_seconds, r.sizes),
                    fmt::format("{:.2f}", r.cold_exponent()), list(r.copy_seconds, r.sizes),
                    time_text(r.left_by(other_growth_limit)),
                    time_text(std::max(r.taken_by_copy(), 0.0))});
  }
  const IndependenceResult& i = results.independence;
  return text +
         markdown_table(
             {"what", "sizes", "time a unit", "exponent", "with empty caches", "exponent",
              "a copy, a unit", fmt::format("{:g} leaves", other_growth_limit), "a copy takes"},
             rows) +
         fmt::format(
             "\nParts of a scene do not disturb what one another keeps: two resting cables over 21 "
             "pulleys each cost {:.2f} times one, and one beside a falling disc {:.2f} times "
             "itself alone. The velocities at the time of the positions (`velocities_now`) cost "
             "{:.2f} of the step of a cable that swings.\n",
             i.two_cables, i.with_a_disc, i.velocities);
}

std::string bare(const StressResults& results) {
  std::string text =
      "\n## Against a bare elimination\n\n"
      "The least that a direct step of a cable consists of: the tangent of each segment in closed "
      "form, J M^-1 J^T, Thomas' elimination, and the velocities. No forces, no motion, no cable "
      "that moves from span to span, no detection, no slack. Both timed by turns; scenes begin "
      "again after " +
      fmt::format("{}", steps_of_bare) + " steps, before a weight comes to its pulley.\n\n";
  std::vector<std::vector<std::string>> rows;
  for (const BareResult& r : results.bare) {
    rows.push_back({r.scene, fmt::format("{}", r.segments), time_text(r.bare.seconds.median),
                    time_text(r.step.seconds.median), fmt::format("{:.2f}", r.ratio())});
  }
  return text + markdown_table({"scene", "segments", "bare pass", "whole step", "ratio"}, rows);
}

std::string sleeping(const StressResults& results) {
  const SleepResult& r = results.sleep.back();
  const std::string text =
      r.asleep() ? fmt::format("falls asleep after {:.2f} s; then a step costs", r.after_s)
                 : fmt::format("is not asleep after {:g} s; a step costs", SleepResult::most_s);
  return fmt::format("\n## Asleep\n\nWith sleep on, load {} at rest {} {} instead of {}.\n", r.load,
                     text, time_text(r.asleep_s), time_text(r.awake_s));
}

Spread scaled(const Spread& s, double factor) {
  return {factor * s.low, factor * s.median, factor * s.high};
}

using Divisor = double (*)(const StressResult&);
double by_one(const StressResult&) {
  return 1.0;
}
double by_load(const StressResult& r) {
  return r.load;
}
double by_joint(const StressResult& r) {
  return static_cast<double>(r.elements.joints);
}
double by_attachment(const StressResult& r) {
  return static_cast<double>(r.elements.attachments());
}

/// Of the whole step or a stage of one case, in units of `unit_s`, divided by what there is of it.
Curve curve_of(const StressResults& results, const std::string& name, std::optional<Stage> stage,
               double unit_s, Divisor divisor, const std::string& label, int style) {
  Curve curve;
  curve.label = label;
  curve.style = style;
  for (const StressResult& r : results.steps) {
    if (r.name != name) continue;
    const Spread& s = stage ? r.cost.stage_s[place(*stage)] : r.cost.step_s;
    curve.points.push_back({static_cast<double>(r.load), scaled(s, 1.0 / (unit_s * divisor(r)))});
  }
  return curve;
}

constexpr double ms = 1e-3, us = 1e-6;

void draw_steps(const StressResults& results, Output& output) {
  const struct {
    const char* title;
    const char* unit;
    double size;
    Divisor divisor;
  } kinds[] = {{"Whole step", "ms", ms, by_one},
               {"Per load", "µs", us, by_load},
               {"Per joint", "µs", us, by_joint},
               {"Per attachment", "µs", us, by_attachment}};
  std::vector<Panel> panels;
  for (const auto& [title, unit, size, divisor] : kinds) {
    Panel panel{title, "load", fmt::format("processor time, {}", unit), {}, 60.0};
    int style = 1;
    for (const char* name : {"pinch", "thesis", "cable", "thesis cable"}) {
      panel.curves.push_back(curve_of(results, name, std::nullopt, size, divisor, name, style++));
      panel.curves.back().spread = true;
    }
    panels.push_back(panel);
  }
  output.figure("stress-step", 1280, 420, charts(panels, 420));
}

void draw_stages(const StressResults& results, Output& output) {
  std::vector<Panel> panels;
  for (const char* name : {"pinch", "thesis"}) {
    Panel panel{fmt::format("Stages of {}", name), "load", "time of the stage, ms", {}, 60.0};
    int style = 1;
    for (const Stage stage : {Stage::solve, Stage::intersect_segments, Stage::broad_phase,
                              Stage::find_contacts, Stage::configure_pinches,
                              Stage::update_segments, Stage::init_segments, Stage::init_contacts}) {
      panel.curves.push_back(curve_of(results, name, stage, ms, by_one, to_string(stage), style++));
    }
    panels.push_back(panel);
  }
  output.figure("stress-stages", 1100, 520, charts(panels, 520, Scale::common));
}

void draw_shared(const StressResults& results, Output& output) {
  const struct {
    const char* title;
    Divisor divisor;
  } kinds[] = {{"Per joint", by_joint}, {"Per attachment", by_attachment}};
  std::vector<Panel> panels;
  for (const auto& [title, divisor] : kinds) {
    Panel panel{title, "load", "time of the stage, ns", {}, 100.0};
    int style = 1;
    for (const Stage stage : {Stage::solve, Stage::update_segments, Stage::init_segments}) {
      for (const char* name : {"pinch", "cable"}) {
        Curve curve = curve_of(results, name, stage, 1e-9, divisor,
                               fmt::format("{}, {}", to_string(stage), name), style);
        curve.dashed = std::string(name) == "cable";
        panel.curves.push_back(curve);
      }
      ++style;
    }
    panels.push_back(panel);
  }
  output.figure("stress-shared", 1100, 420, charts(panels, 420, Scale::common));
}

void draw_choices(const StressResults& results, Output& output) {
  Panel panel{"One choice of the thesis at a time", "load", "step, relative to pinch", {}, 10.0};
  int style = 1;
  for (const char* name : {"thesis", "iterative", "all pairs", "three rows"}) {
    Curve curve;
    curve.label = name;
    curve.style = style++ + 1;
    for (const int load : loads_in(results)) {
      const double ratio = times_ours(results, name, load);
      curve.points.push_back({static_cast<double>(load), {ratio, ratio, ratio}});
    }
    panel.curves.push_back(curve);
  }
  output.figure("stress-choices", 640, 420, charts({panel}, 420));
}

}  // namespace

std::string stress_page(const StressResults& results) {
  return "# Stress test: what a step costs as scenes grow\n\n" + summary(results) + "\n" +
         asked_and_measured(results) + "\n" + how() + whole_step(results) + stages(results) +
         shared_stages(results) + choices(results) + tension_and_solves(results) + bare(results) +
         sleeping(results) + growth_of_others(results);
}

void draw_stress(const StressResults& results, Output& output) {
  draw_steps(results, output);
  draw_stages(results, output);
  draw_shared(results, output);
  draw_choices(results, output);
}

}  // namespace pinchlab::experiments
