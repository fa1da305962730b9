// SPDX-License-Identifier: GPL-3.0-or-later
// Event scenes, with events at their time and at the steps.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/experiments/accuracy.h"
#include "analysis/gnuplot.h"
#include "base/at.h"

namespace pinchlab::experiments {

namespace {

/// Our default: events at their time.
const std::string located = "pinch direct";

std::vector<const ProblemResult*> event_results(const std::vector<ProblemResult>& results) {
  std::vector<const ProblemResult*> found;
  for (const ProblemResult& result : results) {
    if (result.events) found.push_back(&result);
  }
  return found;
}

std::vector<std::string> row_of(const ProblemResult& result, const std::string& name,
                                const std::vector<Rung>& rungs) {
  std::vector<std::string> row{result.problem.name, name};
  for (const int steps : {1, 4, 16, 64}) {
    const auto at = std::find_if(rungs.begin(), rungs.end(),
                                 [=](const Rung& r) { return r.steps_per_frame == steps; });
    row.push_back(at == rungs.end()   ? "too slow"
                  : !at->trial.finite ? "not finite"
                                      : error_text(at->trial.error));
  }
  row.push_back(order_text(result.problem, rungs));
  for (const double error : wanted_errors) {
    const int best = cheapest(result.problem, rungs, error, true);
    row.push_back(best < 0 ? "not reached" : microseconds(at(rungs, best).trial.cpu_s_per_s));
  }
  return row;
}

std::string table(const std::vector<const ProblemResult*>& results) {
  std::vector<std::string> header{"scene", "events"};
  for (const char* steps : {"1 step", "4 steps", "16 steps", "64 steps"}) {
    header.push_back(fmt::format("error at {}", steps));
  }
  header.emplace_back("order");
  for (const double error : wanted_errors) header.push_back(fmt::format("time for {:.0e}", error));
  std::vector<std::vector<std::string>> rows;
  for (const ProblemResult* result : results) {
    rows.push_back(row_of(*result, "at their time", ladder(result->rungs, located)));
    rows.push_back(row_of(*result, "at the steps", result->at_steps));
  }
  return markdown_table(header, rows);
}

/// What one way to meet events comes to.
struct Tally {
  std::vector<std::string> exact, other;  // scenes, the others with their orders
  int met = 0;                            // wanted errors

  void add(const ProblemResult& result, const std::vector<Rung>& rungs) {
    const std::string order = order_text(result.problem, rungs);
    if (order == "exact") exact.push_back(result.problem.name);
    if (order != "exact") other.push_back(result.problem.name + ' ' + order);
    for (const double error : wanted_errors) {
      if (cheapest(result.problem, rungs, error, true) >= 0) ++met;
    }
  }
  std::string orders() const {
    return fmt::format("exact on {} of {}{}{}", exact.size(), exact.size() + other.size(),
                       other.empty() ? "" : ", of order ", fmt::join(other, ", "));
  }
};

}  // namespace

void write_events_figure(Output& output, const std::vector<ProblemResult>& all) {
  constexpr std::size_t columns = 4;
  const std::vector<const ProblemResult*> results = event_results(all);
  if (results.empty()) return;
  const auto [low, high] = error_range(results);
  const std::size_t rows = (results.size() + 1 + columns - 1) / columns;
  std::string text =
      accuracy_axes() + fmt::format("set multiplot layout {},{}\nset yrange [{}:{}]\nset key off\n",
                                    rows, columns, low, high);
  const std::string ours = "with linespoints ls 1 ps 0.6", other = "with linespoints ls 2 ps 0.6";
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Problem& problem = results[i]->problem;
    const std::string doubt = doubt_line(problem);
    text += fmt::format(
        "set title {} tc rgb '#333333'\nset ylabel {}\nset xlabel {}\n"
        "plot {}'accuracy.csv' {} {} notitle, \\\n  'accuracy.csv' {} {} notitle\n",
        analysis::gnuplot_quote(problem.name), i % columns == 0 ? "'error, relative'" : "' '",
        i + columns >= results.size() ? "'µs a simulated second'" : "' '",
        doubt.empty() ? "" : doubt + ", \\\n  ",
        accuracy_points(problem.name, "setting", events_at_steps), other,
        accuracy_points(problem.name, "setting", located), ours);
  }
  text += fmt::format(
      "unset title\nunset xlabel\nunset ylabel\nunset tics\nunset border\nunset grid\n"
      "set key center center invert reverse Left spacing 1.4\n"
      "set xrange [1:2]\nset yrange [1:2]\n"
      "plot NaN with lines lc rgb '#999999' dt 3 lw 1.5 title \"the reference's own doubt\", "
      "NaN {} title 'events at the steps', NaN {} title 'events at their time'\n"
      "unset multiplot\n",
      other, ours);
  output.figure("accuracy-events", 1200, static_cast<int>(300 * rows), text);
}

std::string events_sentence(const std::vector<ProblemResult>& all) {
  const std::vector<const ProblemResult*> results = event_results(all);
  if (results.empty()) return "";
  Tally at_time, at_steps;
  std::vector<double> ratios;  // of times, where both meet an error
  for (const ProblemResult* result : results) {
    const std::vector<Rung> mine = ladder(result->rungs, located);
    at_time.add(*result, mine);
    at_steps.add(*result, result->at_steps);
    for (const double error : wanted_errors) {
      const int a = cheapest(result->problem, mine, error, true);
      const int b = cheapest(result->problem, result->at_steps, error, true);
      if (a < 0 || b < 0) continue;
      ratios.push_back(at(mine, a).trial.cpu_s_per_s / at(result->at_steps, b).trial.cpu_s_per_s);
    }
  }
  std::string text = fmt::format(
      "* Through impacts, catches, hits and slip `{}` is, with events at their time, {}; with "
      "events at the steps, {}. It meets {} of {} errors (scene and error) with events at their "
      "time, {} with events at the steps",
      located, at_time.orders(), at_steps.orders(), at_time.met,
      results.size() * wanted_errors.size(), at_steps.met);
  if (ratios.empty()) return text + ".\n";
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  return text + fmt::format(
                    "; where both do, the former takes {:.2g} to {:.2g} times the latter's time "
                    "(median {:.2g}).\n",
                    *least, *most, spread(ratios).median);
}

std::string events_section(const std::vector<ProblemResult>& all) {
  const std::vector<const ProblemResult*> results = event_results(all);
  if (results.empty()) return "";
  return fmt::format(
      "\n## Events at their time and at the steps\n\n"
      "`{}` on the scenes of impacts, catches, hits and slip, where events divide the step at "
      "their time (its default) and where they take effect in the step in which they fall. Left "
      "ends of curves are one step a frame; errors below 1e-16 are drawn there. \"Time for\": the "
      "least processor time a simulated second that meets the error at all finer steps too.\n\n"
      "![Events at their time and at the steps](accuracy-events.svg)\n\n{}",
      located, table(results));
}

}  // namespace pinchlab::experiments
