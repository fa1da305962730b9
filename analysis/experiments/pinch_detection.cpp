// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/pinch_detection.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "analysis/experiments/chart.h"
#include "analysis/experiments/element_counts.h"
#include "analysis/experiments/step_cost.h"
#include "demos/scenes/library.h"

namespace pinchlab::experiments {

namespace {

struct Variant {
  const char* name;
  bool pinching, other;  // which small pulleys are there
};
constexpr std::array<Variant, 4> variants{{{"both", true, true},
                                           {"pinching", true, false},
                                           {"other", false, true},
                                           {"none", false, false}}};

constexpr std::array<Stage, 3> phases{Stage::broad_phase, Stage::find_contacts,
                                      Stage::configure_pinches};
constexpr std::array<const char*, 3> phase_titles{"Broad phase", "Narrow phase",
                                                  "Confirm and configure"};
constexpr std::array<const char*, 2> methods{"pinch", "thesis"};

/// Shorter than this a phase cannot be told from the clock.
constexpr double least_s = 20e-9;

struct Result {
  std::string method, variant;
  int load = 0;
  std::size_t bodies = 0, near_pairs = 0, contacts = 0, pinches = 0;
  StepCost cost;

  [[nodiscard]] const Spread& phase(std::size_t i) const {
    return cost.stage_s[static_cast<std::size_t>(phases[i])];
  }
};

Result measure(const std::string& method, const Variant& variant, int load, const Effort& effort) {
  const Scene scene = pinch_detection_scene(load, variant.pinching, variant.other);
  Configuration configuration = *configuration_from_string(method);
  configuration.sleep = false;
  World world = make_world(scene, configuration);
  Workspace work;
  Result result{method, variant.name, load, scene.bodies.size(), 0, 0, 0, {}};
  result.cost = measure_steps(scene, world, work, effort);
  result.near_pairs = work.broad_phase.body_pairs.size();
  result.contacts = world.contacts.size();
  result.pinches = count_elements(world).non_transitional;
  return result;
}

Csv table_of(const std::vector<Result>& results) {
  Csv csv({"method", "variant", "load", "bodies", "near_pairs", "contacts", "pinches", "phase",
           "steps", "low_s", "median_s", "high_s", "per_load_s", "step_median_s"});
  const auto whole = [](std::size_t count) { return static_cast<std::int64_t>(count); };
  for (const Result& r : results) {
    for (std::size_t i = 0; i < phases.size(); ++i) {
      const Spread& s = r.phase(i);
      csv.row({r.method, r.variant, std::int64_t{r.load}, whole(r.bodies), whole(r.near_pairs),
               whole(r.contacts), whole(r.pinches), to_string(phases[i]), r.cost.steps, s.low,
               s.median, s.high, s.median / r.load, r.cost.step_s.median});
    }
  }
  return csv;
}

const Result& find(const std::vector<Result>& results, const std::string& method,
                   const std::string& variant, int load) {
  return *std::find_if(results.begin(), results.end(), [&](const Result& r) {
    return r.method == method && r.variant == variant && r.load == load;
  });
}

std::string exponent_of(const std::vector<Result>& results, const std::string& method,
                        const std::string& variant, std::size_t phase) {
  std::vector<double> sizes, costs;
  for (const Result& r : results) {
    if (r.method != method || r.variant != variant || r.load < 20) continue;
    if (r.phase(phase).median < least_s) return "–";
    sizes.push_back(r.load);
    costs.push_back(r.phase(phase).median);
  }
  return sizes.size() < 2 ? "–" : fmt::format("{:.2f}", growth_exponent(sizes, costs));
}

void draw(const std::vector<Result>& results, bool per_load, Output& output) {
  std::vector<Panel> panels;
  for (std::size_t phase = 0; phase < phases.size(); ++phase) {
    Panel panel{phase_titles[phase],
                "load",
                per_load ? "time of the phase a load, ns" : "time of the phase, µs",
                {},
                150.0};
    for (const char* method : methods) {
      for (std::size_t v = 0; v < variants.size(); ++v) {
        Curve curve;
        curve.label = fmt::format("{}, {}", variants[v].name, method);
        curve.style = static_cast<int>(v) + 1;
        curve.dashed = std::string(method) == "thesis";
        for (const Result& r : results) {
          if (r.method != method || r.variant != variants[v].name) continue;
          const Spread& s = r.phase(phase);
          if (s.median < least_s) continue;
          const double unit = per_load ? 1e-9 * r.load : 1e-6;
          curve.points.push_back(
              {static_cast<double>(r.load), {s.low / unit, s.median / unit, s.high / unit}});
        }
        panel.curves.push_back(curve);
      }
    }
    panels.push_back(panel);
  }
  output.figure(per_load ? "pinch-detection-per-load" : "pinch-detection", 1280, 460,
                charts(panels, 460));
}

/// What the four variants say of one method at the greatest load.
std::string words(const std::vector<Result>& results, const std::string& method, int load) {
  const auto at = [&](const char* variant, std::size_t phase) {
    return find(results, method, variant, load).phase(phase).median / load;
  };
  std::string text = fmt::format(
      "`{}` at load {}, a load: the broad phase takes {} with both small pulleys and {} with "
      "none, and grows with the power {} of the load; the narrow phase takes {} and {}. ",
      method, load, time_text(at("both", 0)), time_text(at("none", 0)),
      exponent_of(results, method, "both", 0), time_text(at("both", 1)), time_text(at("none", 1)));
  text += fmt::format(
      "Confirming and configuring takes {} with the pinching pulley alone, {} with the other one "
      "alone and {} with none: rejecting a pulley that lies on a bare body costs {}, keeping a "
      "pinch configured {}. ",
      time_text(at("pinching", 2)), time_text(at("other", 2)), time_text(at("none", 2)),
      time_text(std::max(0.0, at("other", 2) - at("none", 2))),
      time_text(std::max(0.0, at("pinching", 2) - at("none", 2))));
  const double sum = at("pinching", 2) + at("other", 2) - at("none", 2);
  return text + fmt::format(
                    "Both pulleys together cost {:.2f} times what the two cost alone (the thesis "
                    "found the sum).\n\n",
                    at("both", 2) / sum);
}

std::string page_of(const std::vector<Result>& results, const std::vector<int>& loads) {
  const int most = loads.back();
  std::string text =
      "# Pinch detection: what finding pinches costs\n\n"
      "The scene of the thesis' Figure 3.1c: each load has two wrapped pulleys, a small one that "
      "presses the cable on the first, and another that lies on the bare top of the second. Four "
      "variants leave out the one, the other, or both. `pinch` sweeps and prunes, `thesis` tests "
      "all pairs; the phases after that are the same. As in the thesis' Figure 5.4, the figures "
      "show the time of each phase, measured and divided by the load; a dashed line is `thesis`, "
      "and what the clock cannot tell from nothing is left out.\n\n";
  for (const char* method : methods) text += words(results, method, most);
  text +=
      "![Time of each phase over the load](pinch-detection.svg)\n\n"
      "![The same, divided by the load](pinch-detection-per-load.svg)\n\n";
  text += fmt::format("Medians a step at load {}, and growth exponents from load 20 on:\n\n", most);
  std::vector<std::vector<std::string>> rows;
  for (const char* method : methods) {
    for (const Variant& variant : variants) {
      const Result& r = find(results, method, variant.name, most);
      std::vector<std::string> row{fmt::format("`{}`, {}", method, variant.name),
                                   fmt::format("{}", r.near_pairs), fmt::format("{}", r.contacts),
                                   fmt::format("{}", r.pinches)};
      for (std::size_t phase = 0; phase < phases.size(); ++phase) {
        row.push_back(fmt::format("{} ({})", time_text(r.phase(phase).median),
                                  exponent_of(results, method, variant.name, phase)));
      }
      row.push_back(time_text(r.cost.step_s.median));
      rows.push_back(row);
    }
  }
  return text + markdown_table({"", "near pairs", "contacts", "pinches", "broad", "narrow",
                                "confirm and configure", "whole step"},
                               rows);
}

}  // namespace

void run_pinch_detection(const Options& options) {
  const std::vector<int> loads = loads_of(options, {1, 5, 20, 100, 1000});
  const Effort effort = options.quick ? Effort{0.05, 20} : Effort{0.5, 100};
  Output output(options.out);
  Progress progress("pinch-detection",
                    static_cast<double>(loads.size() * methods.size() * variants.size()));
  std::vector<Result> results;
  for (const int load : loads) {
    for (const char* method : methods) {
      for (const Variant& variant : variants) {
        results.push_back(measure(method, variant, load, effort));
        progress.done(1.0);
      }
    }
  }
  output.csv("pinch-detection", table_of(results), options.command);
  draw(results, false, output);
  draw(results, true, output);
  output.page("pinch-detection", page_of(results, loads), options.command);
  fmt::print("{}: what finding pinches costs\n", (options.out / "pinch-detection.md").string());
}

}  // namespace pinchlab::experiments
