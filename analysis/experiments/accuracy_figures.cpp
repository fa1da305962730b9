// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/experiments/accuracy.h"
#include "analysis/gnuplot.h"

namespace pinchlab::experiments {

namespace {

/// Errors below this are drawn there.
constexpr double smallest_drawn = 1e-16;

/// A line a contender, drawn in this order, so that the first named lies on top of its equals.
struct Series {
  const char* setting;
  int style;         // of figure_preamble
  const char* dash;  // gnuplot's dash type
};
constexpr Series series[] = {
    {"cable iterative", 6, "2"},
    {"cable direct", 6, "1"},
    {"pinch_no_contact iterative", 7, "2"},
    {"pinch_no_contact direct", 7, "1"},
    {"thesis", 3, "1"},
    {"pinch iterative", 2, "1"},
    {"pinch direct", 1, "1"},
};
constexpr int peer_styles[] = {4, 5};

std::string lines_of(const ProblemResult& result, const std::vector<Peer>& peers, double size) {
  const std::string& scene = result.problem.name;
  std::vector<std::string> plots;
  const std::string doubt = doubt_line(result.problem);
  if (!doubt.empty()) plots.push_back(doubt);
  for (std::size_t p = 0; p < peers.size(); ++p) {
    if (result.peers[p].rungs.empty()) continue;
    plots.push_back(fmt::format("'accuracy.csv' {} with points ls {} ps 0.25 notitle",
                                accuracy_points(scene, "engine", peers[p].name), peer_styles[p]));
    plots.push_back(fmt::format("'accuracy-fronts.csv' {} with linespoints ls {} title {}",
                                accuracy_points(scene, "engine", peers[p].name), peer_styles[p],
                                analysis::gnuplot_quote(peers[p].name + ", its best (dots: all)")));
  }
  for (const Series& s : series) {
    if (std::ranges::none_of(result.rungs, [&s](const Rung& rung) {
          return rung.setting == s.setting && rung.trial.finite;
        })) {
      continue;
    }
    plots.push_back(fmt::format("'accuracy.csv' {} with linespoints ls {} dt {} ps {} title {}",
                                accuracy_points(scene, "setting", s.setting), s.style, s.dash, size,
                                analysis::gnuplot_quote(s.setting)));
  }
  return fmt::format("plot {}\n", fmt::join(plots, ", \\\n  "));
}

void figure_of(Output& output, const ProblemResult& result, const std::vector<Peer>& peers) {
  const auto [low, high] = error_range({&result});
  output.figure(
      "accuracy-" + result.problem.name, 900, 480,
      accuracy_axes() +
          fmt::format(
              "set title {} tc rgb '#333333'\n"
              "set xlabel 'processor time a simulated second (µs)'\n"
              "set ylabel {}\n"
              "set yrange [{}:{}]\nset key outside right center invert reverse Left spacing 1.3 "
              "title \"where lines are the same\\nthe first named is on top\"\n",
              analysis::gnuplot_quote(result.problem.title),
              analysis::gnuplot_quote("error / " + result.problem.length), low, high) +
          lines_of(result, peers, 0.7));
}

void figure_of_demonstrations(Output& output, const std::vector<const ProblemResult*>& results,
                              const std::vector<Peer>& peers) {
  const auto [low, high] = error_range(results);
  std::string text = accuracy_axes() + fmt::format(
                                           "set multiplot layout 3,3\nset yrange [{}:{}]\n"
                                           "set xrange [10:*]\nset key off\n",
                                           low, high);
  for (std::size_t i = 0; i < results.size(); ++i) {
    text += fmt::format("set title {} tc rgb '#333333'\nset ylabel {}\nset xlabel {}\n",
                        analysis::gnuplot_quote(results[i]->problem.name),
                        i % 3 == 0 ? "'error, relative'" : "' '",
                        i + 3 >= results.size() ? "'µs a simulated second'" : "' '") +
            lines_of(*results[i], peers, 0.5);
  }
  text +=
      "unset title\nunset xlabel\nunset ylabel\nunset tics\nunset border\nunset grid\n"
      "set key center center invert reverse Left spacing 1.4\n"
      "set xrange [1:2]\nset yrange [1:2]\nplot ";
  for (const Series& s : series) {
    text += fmt::format("NaN with linespoints ls {} dt {} title {}, ", s.style, s.dash,
                        analysis::gnuplot_quote(s.setting));
  }
  text +=
      "NaN with lines lc rgb '#999999' dt 3 lw 1.5 title \"the reference's own doubt\"\n"
      "unset multiplot\n";
  output.figure("accuracy-demonstrations", 1100, 900, text);
}

}  // namespace

std::string accuracy_points(const std::string& scene, const std::string& column,
                            const std::string& value) {
  const std::vector<std::pair<std::string, std::string>> where{{"scene", scene}, {column, value}};
  return fmt::format("using {}:{}", column_where("cpu_us_per_s", where),
                     fmt::format("(drawn({}))", column_where("error", where)));
}

std::string doubt_line(const Problem& problem) {
  if (!(problem.doubt_m > 0.0)) return "";
  return fmt::format("{} with lines lc rgb '#999999' dt 3 lw 1.5 notitle",
                     problem.doubt_m / problem.length_m);
}

std::string accuracy_axes() {
  return fmt::format(
      "drawn(e) = e < {0} ? {0} : e\n"
      "set logscale xy\nset format x '1e%T'\nset format y '1e%T'\n"
      "set mxtics 10\nset mytics 1\n",
      smallest_drawn);
}

std::pair<double, double> error_range(const std::vector<const ProblemResult*>& results) {
  double low = 1e-2, high = 1e-2;
  const auto widen = [&](const std::vector<Rung>& rungs) {
    for (const Rung& rung : rungs) {
      if (!rung.trial.finite) continue;
      low = std::min(low, std::max(rung.trial.error, smallest_drawn));
      high = std::max(high, rung.trial.error);
    }
  };
  for (const ProblemResult* result : results) {
    widen(result->rungs);
    widen(result->at_steps);
    for (const PeerResult& peer : result->peers) widen(peer.rungs);
  }
  return {std::pow(10.0, std::floor(std::log10(low) - 0.1)),
          std::pow(10.0, std::min(5.0, std::ceil(std::log10(high) + 0.1)))};
}

void write_accuracy_figures(Output& output, const std::vector<ProblemResult>& results,
                            const std::vector<Peer>& peers) {
  std::vector<const ProblemResult*> demonstrations;
  for (const ProblemResult& result : results) {
    if (result.demonstration) {
      demonstrations.push_back(&result);
    } else {
      figure_of(output, result, peers);
    }
  }
  if (!demonstrations.empty()) figure_of_demonstrations(output, demonstrations, peers);
}

}  // namespace pinchlab::experiments
