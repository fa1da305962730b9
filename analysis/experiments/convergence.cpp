// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/convergence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "analysis/experiments/chart.h"
#include "analysis/experiments/event_scenes.h"
#include "demos/command_line.h"
#include "demos/scenes/find_scenes.h"
#include "demos/scenes/scene_json.h"

namespace pinchlab::experiments {

namespace {

struct Way {
  const char* name;  // in tables
  Events events;
  bool by_error;  // intervals by the scene's error_m
};
constexpr Way ways[] = {{"at the steps", Events::at_steps, false},
                        {"at their time", Events::located, false},
                        {"at their time, by error", Events::located, true}};

Configuration configuration_of(const Way& way) {
  Configuration configuration = Method::pinch;
  configuration.events = way.events;
  return configuration;
}

/// Steps of `steps` a frame.
struct Step {
  int steps = 1;
  Recording recording;
};

/// The largest distance between two motions, whose it is, and when (s).
struct Largest {
  double distance_m = 0.0, time_s = 0.0;
  std::size_t body = 0;
};

Largest largest(const Problem& problem, const Motion& a, const Motion& b) {
  Largest found;
  for (std::size_t frame = 0; frame < a.size(); ++frame) {
    for (std::size_t i = 0; i < a[frame].size(); ++i) {
      const double d = (a[frame][i].centre - b[frame][i].centre).norm();
      if (d > found.distance_m) {
        const double t = static_cast<double>(frame) / problem.scene.frames_per_second;
        found = {d, t, problem.watched[i]};
      }
    }
  }
  return found;
}

/// 1, 2, 4, ... `most` steps a frame, each for the least processor time of three runs.
std::vector<Step> climb_all(const Problem& problem, const Configuration& configuration, int most) {
  std::vector<Step> ladder;
  for (int steps = 1; steps <= most; steps *= 2) {
    Step step{steps, simulate(problem, configuration, steps)};
    for (int again = 0; again < 2; ++again) {
      step.recording.cpu_s =
          std::min(step.recording.cpu_s, simulate(problem, configuration, steps).cpu_s);
    }
    ladder.push_back(std::move(step));
  }
  return ladder;
}

double cpu_us_a_frame(const Problem& problem, const Step& step) {
  return 1e6 * step.recording.cpu_s / problem.frames;
}

/// Minus the slope of log(differences) over log(steps); none where they are round-off.
std::optional<double> order_of(const std::vector<double>& steps,
                               const std::vector<double>& errors) {
  constexpr double rounding = 1e-9;  // m
  std::vector<double> x, y;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!(errors[i] > rounding)) continue;
    x.push_back(steps[i]);
    y.push_back(errors[i]);
  }
  if (x.size() < 3) return std::nullopt;
  return -growth_exponent(x, y);
}

std::string order_text(const std::optional<double>& order) {
  return order ? fmt::format("{:.1f}", *order) : "exact";
}

std::string metres(double value) {
  return fmt::format("{:.1e}", value);
}

/// A demonstration, as given and where intervals do not go by its error.
struct Demonstration {
  Problem problem;
  double error_m = 0.0;
};

std::vector<Demonstration> demonstrations() {
  std::vector<Demonstration> all;
  for (const auto& path : find_scenes({demos_folder()})) {
    Demonstration demonstration;
    Problem& problem = demonstration.problem;
    problem.scene = read_scene_file(path).scene;
    problem.name = problem.title = problem.scene.name;
    problem.frames = static_cast<int>(problem.scene.frame_count) - 1;
    for (std::size_t b = 0; b < problem.scene.bodies.size(); ++b) problem.watched.push_back(b);
    demonstration.error_m = problem.scene.error;
    all.push_back(std::move(demonstration));
  }
  return all;
}

/// The most that a change of 1e-12 m/s of all velocities at the start moves any body, at eight
/// steps a frame.
double sensitivity(Problem problem) {
  const Recording given = simulate(problem, Method::pinch, 8);
  for (Body& body : problem.scene.bodies) {
    if (body.kind != BodyKind::free) continue;
    body.velocity += Vec2(1e-12, 0.5e-12);
  }
  return largest(problem, given.motion, simulate(problem, Method::pinch, 8).motion).distance_m;
}

/// A panel of error against processor time, still without curves.
Panel panel_of(const std::string& title, const std::string& error) {
  return {title, "processor time a frame, µs", error, {}, 30.0};
}

Curve curve_of(const Way& way) {
  Curve curve;
  curve.label = way.by_error ? "by error" : way.name;
  curve.style = way.by_error ? 3 : way.events == Events::located ? 1 : 2;
  return curve;
}

/// Nobody needs to see how round-off depends on the step.
bool is_worth_drawing(const Panel& panel) {
  constexpr double least = 1e-6;  // m
  return std::any_of(panel.curves.begin(), panel.curves.end(), [](const Curve& curve) {
    return std::any_of(curve.points.begin(), curve.points.end(),
                       [](const CurvePoint& point) { return point.y.median > least; });
  });
}

const Step& at_steps(const std::vector<Step>& ladder, int steps) {
  return *std::find_if(ladder.begin(), ladder.end(),
                       [steps](const Step& step) { return step.steps == steps; });
}

/// Rows of the demonstrations' table, and of the raw one.
void measure(const Demonstration& demonstration, int most, Csv& csv,
             std::vector<std::vector<std::string>>& rows, std::vector<Panel>& panels) {
  Problem problem = demonstration.problem;
  Panel panel = panel_of(problem.title, "from twice as many steps, m");
  for (const Way& way : ways) {
    problem.scene.error = way.by_error ? demonstration.error_m : 0.0;
    const std::vector<Step> ladder = climb_all(problem, configuration_of(way), 2 * most);
    std::vector<double> steps, differences;
    Curve curve = curve_of(way);
    for (std::size_t i = 0; i + 1 < ladder.size(); ++i) {
      const Largest d =
          largest(problem, ladder[i].recording.motion, ladder[i + 1].recording.motion);
      csv.row({problem.name, way.name, "from twice as many steps", std::int64_t{ladder[i].steps},
               d.distance_m, problem.scene.bodies[d.body].name, d.time_s,
               cpu_us_a_frame(problem, ladder[i])});
      steps.push_back(ladder[i].steps);
      differences.push_back(d.distance_m);
      curve.points.push_back(
          {cpu_us_a_frame(problem, ladder[i]), {d.distance_m, d.distance_m, d.distance_m}});
    }
    const Step &four = at_steps(ladder, 4), &eight = at_steps(ladder, 8);
    const Largest d = largest(problem, four.recording.motion, eight.recording.motion);
    rows.push_back({problem.name, way.name, metres(d.distance_m),
                    d.distance_m > 0.0
                        ? fmt::format("{}, {:.2f} s", problem.scene.bodies[d.body].name, d.time_s)
                        : "–",
                    order_text(order_of(steps, differences)),
                    fmt::format("{:.1f}", cpu_us_a_frame(problem, four)),
                    way.by_error ? metres(sensitivity(problem)) : ""});
    panel.curves.push_back(curve);
  }
  if (is_worth_drawing(panel)) panels.push_back(panel);
}

/// The same of a scene whose motion is known.
void measure(const Problem& problem, int most, Csv& csv,
             std::vector<std::vector<std::string>>& rows, std::vector<Panel>& panels) {
  Panel panel = panel_of(problem.title, "largest error, m");
  for (const Way& way : ways) {
    if (way.by_error) continue;
    Curve curve = curve_of(way);
    std::vector<double> steps, errors;
    std::vector<std::string> row{problem.title, way.name};
    for (const Step& step : climb_all(problem, configuration_of(way), most)) {
      const Largest d = largest(problem, step.recording.motion, problem.exact);
      const double cpu = cpu_us_a_frame(problem, step);
      csv.row({problem.name, way.name, "from " + problem.reference, std::int64_t{step.steps},
               d.distance_m, problem.scene.bodies[d.body].name, d.time_s, cpu});
      steps.push_back(step.steps);
      errors.push_back(d.distance_m);
      curve.points.push_back({cpu, {d.distance_m, d.distance_m, d.distance_m}});
      if (step.steps == 1 || step.steps == 4 || step.steps == 16 || step.steps == 64) {
        row.push_back(metres(d.distance_m));
      }
    }
    row.push_back(order_text(order_of(steps, errors)));
    row.push_back(problem.doubt_m > 0.0 ? metres(problem.doubt_m) : "");
    rows.push_back(row);
    panel.curves.push_back(curve);
  }
  if (is_worth_drawing(panel)) panels.push_back(panel);
}

}  // namespace

void run_convergence(const Options& options) {
  const int most = 64;
  Csv csv({"scene", "events", "difference", "steps_per_frame", "largest_m", "body", "time_s",
           "cpu_us_per_frame"});
  std::vector<std::vector<std::string>> demonstration_rows, event_rows;
  std::vector<Panel> panels;
  const std::vector<Demonstration> all = demonstrations();
  const std::vector<Problem> events = event_problems();
  Progress progress("bench convergence", static_cast<double>(all.size() + events.size()));
  for (const Demonstration& demonstration : all) {
    measure(demonstration, options.quick ? 16 : most, csv, demonstration_rows, panels);
    progress.done(1.0);
  }
  Output output(options.out);
  for (const Problem& problem : events) {
    measure(problem, most, csv, event_rows, panels);
    progress.done(1.0);
  }
  output.csv("convergence", csv, options.command);
  std::string figures;
  for (std::size_t i = 0; i < panels.size(); i += 3) {
    const std::vector<Panel> row(
        panels.begin() + static_cast<std::ptrdiff_t>(i),
        panels.begin() + static_cast<std::ptrdiff_t>(std::min(i + 3, panels.size())));
    const std::string name = fmt::format("convergence-{}", i / 3 + 1);
    output.figure(name, 1280, 420, charts(row, 420));
    figures += fmt::format("\n![error against time]({}.svg)\n", name);
  }
  output.page(
      "convergence",
      fmt::format(
          "# Motion through events\n\n"
          "Impacts, catches and hits either take effect in the step in which they fall "
          "(`at the steps`, as before version 0.2 and in `thesis`), or divide it (`at their "
          "time`); `by error` divides intervals further, as the scene's `error_m` asks. Method "
          "`pinch`, solved directly.\n\n"
          "## Demonstrations\n\n"
          "The largest distance of any body in any frame between runs at 4 and at 8 steps a frame, "
          "whose it is and when; the order of such distances from 1 to {} steps a frame; "
          "processor time a frame at 4, the least of three runs; and what a change of 1e-12 m/s in "
          "the start's velocities moves at most: where that is small, the motion is decided, and "
          "what is left is the method's.\n\n{}\n"
          "## Known motions\n\n"
          "The largest error of any body in any frame (m), at so many steps a frame. `exact`: "
          "round-off at every length of the step. The last column is how far the reference itself "
          "may be off, where it is a solution of our own.\n\n{}\n"
          "## Error against time\n\n"
          "From one step a frame (left) on, twice as many from point to point; scenes whose every "
          "motion is "
          "exact are left out.\n{}",
          options.quick ? 16 : most,
          markdown_table({"demonstration", "events", "4 against 8, m", "of", "order", "µs a frame",
                          "of 1e-12 m/s, m"},
                         demonstration_rows),
          markdown_table({"scene", "events", "1", "4", "16", "64", "order", "doubt, m"},
                         event_rows),
          figures),
      options.command);
}

}  // namespace pinchlab::experiments
