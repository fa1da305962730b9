// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/experiments/accuracy.h"
#include "base/at.h"

namespace pinchlab::experiments {

namespace {

const std::string ours = "pinch direct";

std::string steps_text(int steps) {
  return fmt::format("{} step{}", steps, steps == 1 ? "" : "s");
}

/// Least error of all finite rungs; infinity where there are none.
double best_error(const std::vector<Rung>& rungs) {
  double best = infinity;
  for (const Rung& rung : rungs) {
    if (rung.trial.finite) best = std::min(best, rung.trial.error);
  }
  return best;
}

std::string not_reached(const Problem& problem, const std::vector<Rung>& rungs, double error) {
  const double doubt = problem.doubt_m / problem.length_m;
  if (doubt > error) return "not vouched for";
  return fmt::format("not reached (best {})", error_text(best_error(rungs) + doubt));
}

std::string wanted_header(double error) {
  return fmt::format("error {:.0e}", error);
}

std::string cheapest_table(const std::vector<ProblemResult>& results) {
  std::vector<std::string> header{"scene"};
  for (const double error : wanted_errors) header.push_back(wanted_header(error));
  std::vector<std::vector<std::string>> rows;
  for (const ProblemResult& result : results) {
    std::vector<std::string> row{result.problem.name};
    for (const double error : wanted_errors) {
      const int best = cheapest(result.problem, result.rungs, error, true);
      if (best < 0) {
        row.push_back(not_reached(result.problem, result.rungs, error));
        continue;
      }
      const Rung& rung = at(result.rungs, best);
      row.push_back(fmt::format("{}, {}: {}", rung.setting, steps_text(rung.steps_per_frame),
                                microseconds(rung.trial.cpu_s_per_s)));
    }
    rows.push_back(row);
  }
  return markdown_table(header, rows);
}

/// Cost of another engine at an error, against ours.
std::string peer_cell(const Problem& problem, const PeerResult& peer, double error,
                      const Rung* mine) {
  if (!peer.cannot.empty()) return "cannot";
  const int best = cheapest(problem, peer.rungs, error, false);
  if (best < 0) return not_reached(problem, peer.rungs, error);
  const Rung& rung = at(peer.rungs, best);
  const std::string cost = fmt::format("{} ({})", microseconds(rung.trial.cpu_s_per_s),
                                       steps_text(rung.steps_per_frame));
  return mine ? fmt::format("{}, {:.2g} times ours", cost,
                            rung.trial.cpu_s_per_s / mine->trial.cpu_s_per_s)
              : cost;
}

const Rung* cheapest_of_ours(const ProblemResult& result, const std::vector<Rung>& rungs,
                             double error) {
  const int best = cheapest(result.problem, rungs, error, true);
  return best < 0 ? nullptr : &at(rungs, best);
}

/// "1e-02 to 1e-04"
std::string error_span(double from, double to) {
  return from == to ? fmt::format("{:.0e}", from) : fmt::format("{:.0e} to {:.0e}", from, to);
}

std::string peers_table(const std::vector<ProblemResult>& results, const std::vector<Peer>& peers) {
  std::vector<std::string> header{"scene", "error", "Pinchlab (" + ours + ")"};
  for (const Peer& peer : peers) {
    if (peer.present()) header.push_back(peer.name);
  }
  std::vector<std::vector<std::string>> rows;
  for (const ProblemResult& result : results) {
    if (result.demonstration) continue;
    const std::vector<Rung> mine = ladder(result.rungs, ours);
    double from = 0.0;  // first error of the row that is being extended
    for (const double error : wanted_errors) {
      const Rung* rung = cheapest_of_ours(result, mine, error);
      std::vector<std::string> row{
          result.problem.name, "",
          rung ? fmt::format("{} ({})", microseconds(rung->trial.cpu_s_per_s),
                             steps_text(rung->steps_per_frame))
               : not_reached(result.problem, mine, error)};
      for (std::size_t p = 0; p < peers.size(); ++p) {
        if (peers[p].present()) {
          row.push_back(peer_cell(result.problem, result.peers[p], error, rung));
        }
      }
      const bool same =
          from > 0.0 && std::equal(row.begin() + 2, row.end(), rows.back().begin() + 2);
      if (same) rows.pop_back();
      if (!same) from = error;
      row[1] = error_span(from, error);
      rows.push_back(row);
    }
  }
  return markdown_table(header, rows);
}

/// Who meets an error for clearly less than our default's time, a line each.
class Beaten {
 public:
  void note(const Problem& problem, double error, const std::string& who, const Rung& rung,
            const Rung* mine) {
    const std::string what =
        fmt::format("{} ({}) takes {}, {}", who, steps_text(rung.steps_per_frame),
                    microseconds(rung.trial.cpu_s_per_s),
                    mine ? fmt::format("`{}` {}", ours, microseconds(mine->trial.cpu_s_per_s))
                         : fmt::format("`{}` does not reach it", ours));
    for (Line& line : lines_) {
      if (line.scene == problem.name && line.what == what) {
        line.to = error;
        return;
      }
    }
    lines_.push_back({problem.name, what, error, error});
  }
  std::string text() const {
    std::string all;
    for (const Line& line : lines_) {
      all += fmt::format("* {}, error {}: {}.\n", line.scene, error_span(line.from, line.to),
                         line.what);
    }
    return all.empty() ? "Nowhere in this run.\n" : all;
  }

 private:
  struct Line {
    std::string scene, what;
    double from = 0.0, to = 0.0;
  };
  std::vector<Line> lines_;
};

std::string where_beaten(const std::vector<ProblemResult>& results,
                         const std::vector<Peer>& peers) {
  constexpr double clearly = 0.85;
  Beaten beaten;
  for (const ProblemResult& result : results) {
    const std::vector<Rung> mine = ladder(result.rungs, ours);
    for (const double error : wanted_errors) {
      const Rung* best = cheapest_of_ours(result, mine, error);
      const auto beats = [&](const Rung& rung) {
        return !best || rung.trial.cpu_s_per_s < clearly * best->trial.cpu_s_per_s;
      };
      const Rung* other = cheapest_of_ours(result, result.rungs, error);
      if (other && other->setting != ours && beats(*other)) {
        beaten.note(result.problem, error, "`" + other->setting + "`", *other, best);
      }
      for (std::size_t p = 0; p < peers.size(); ++p) {
        const int peer = cheapest(result.problem, result.peers[p].rungs, error, false);
        if (peer < 0) continue;
        const Rung& rung = at(result.peers[p].rungs, peer);
        if (beats(rung)) {
          beaten.note(result.problem, error, peers[p].name + ", " + rung.setting, rung, best);
        }
      }
    }
  }
  return beaten.text();
}

/// In how many cases (scene and wanted error) a contender meets the error, of those that any meets,
/// and in how many it is the cheapest or nearly.
std::string contender_sentence(const std::vector<ProblemResult>& results,
                               const std::string& setting) {
  constexpr double nearly = 1.15;
  int cases = 0, met = 0, cheapest_in = 0;
  for (const ProblemResult& result : results) {
    const std::vector<Rung> mine = ladder(result.rungs, setting);
    for (const double error : wanted_errors) {
      const Rung* best = cheapest_of_ours(result, result.rungs, error);
      const Rung* own = cheapest_of_ours(result, mine, error);
      if (best) ++cases;
      if (own) ++met;
      if (best && own && own->trial.cpu_s_per_s <= nearly * best->trial.cpu_s_per_s) ++cheapest_in;
    }
  }
  return fmt::format(
      "* `{}` meets the error in {} of the {} cases (scene and error) in which any setting does, "
      "and "
      "is the cheapest or within 15 % of it in {}.\n",
      setting, met, cases, cheapest_in);
}

/// How often another engine meets an error that our default meets, and at how many times its cost.
std::string peer_sentence(const std::vector<ProblemResult>& results, const Peer& peer,
                          std::size_t p) {
  int cases = 0;
  std::vector<double> ratios;
  for (const ProblemResult& result : results) {
    if (result.peers[p].rungs.empty()) continue;
    const std::vector<Rung> mine = ladder(result.rungs, ours);
    for (const double error : wanted_errors) {
      const Rung* own = cheapest_of_ours(result, mine, error);
      if (!own) continue;
      ++cases;
      const int best = cheapest(result.problem, result.peers[p].rungs, error, false);
      if (best < 0) continue;
      ratios.push_back(at(result.peers[p].rungs, best).trial.cpu_s_per_s / own->trial.cpu_s_per_s);
    }
  }
  if (ratios.empty()) {
    return fmt::format("* {} meets none of the {} cases that it can take part in.\n", peer.name,
                       cases);
  }
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  return fmt::format(
      "* {} meets {} of the {} cases that it can take part in and `{}` meets, in {:.2g} to {:.2g} "
      "times its time (median {:.2g}).\n",
      peer.name, ratios.size(), cases, ours, *least, *most, spread(ratios).median);
}

std::string in_short(const std::vector<ProblemResult>& results, const std::vector<Peer>& peers) {
  std::vector<std::string> exact, second;
  for (const ProblemResult& result : results) {
    const std::string order = order_text(result.problem, ladder(result.rungs, ours));
    if (order == "exact") exact.push_back(result.problem.name);
    if (order == "1.9" || order == "2.0" || order == "2.1") second.push_back(result.problem.name);
  }
  std::string text = fmt::format(
      "* `{}` is exact but for round-off at any number of steps on: {}. It is of second order on: "
      "{}.\n",
      ours, exact.empty() ? "none" : fmt::format("{}", fmt::join(exact, ", ")),
      second.empty() ? "none" : fmt::format("{}", fmt::join(second, ", ")));
  for (const std::string& setting : {ours, std::string("pinch iterative"), std::string("thesis")}) {
    text += contender_sentence(results, setting);
  }
  text += events_sentence(results);
  for (std::size_t p = 0; p < peers.size(); ++p) {
    if (peers[p].present()) text += peer_sentence(results, peers[p], p);
  }
  return text;
}

/// A row a contender: errors at some numbers of steps, order, times.
std::string settings_table(const ProblemResult& result) {
  std::vector<int> shown;
  for (const Rung& rung : ladder(result.rungs, ours)) {
    if (rung.steps_per_frame == 1 || rung.steps_per_frame == 4 || rung.steps_per_frame == 16 ||
        rung.steps_per_frame == 64 || rung.steps_per_frame == 256) {
      shown.push_back(rung.steps_per_frame);
    }
  }
  std::vector<std::string> header{"setting"};
  for (const int steps : shown) header.push_back("error at " + steps_text(steps));
  header.insert(header.end(), {"order", "time at 1 step"});
  std::vector<std::vector<std::string>> rows;
  for (const Contender& contender : contenders()) {
    const std::vector<Rung> rungs = ladder(result.rungs, contender.name);
    std::vector<std::string> row{contender.name};
    for (const int steps : shown) {
      const auto at = std::find_if(rungs.begin(), rungs.end(),
                                   [&](const Rung& r) { return r.steps_per_frame == steps; });
      row.push_back(at == rungs.end()   ? "too slow"
                    : !at->trial.finite ? "not finite"
                                        : error_text(at->trial.error));
    }
    row.push_back(order_text(result.problem, rungs));
    row.push_back(microseconds(rungs.front().trial.cpu_s_per_s));
    rows.push_back(row);
  }
  return markdown_table(header, rows);
}

std::string who_takes_no_part(const ProblemResult& result, const std::vector<Peer>& peers) {
  std::string text;
  for (std::size_t p = 0; p < peers.size(); ++p) {
    if (peers[p].present() && !result.peers[p].cannot.empty()) {
      text += fmt::format(" {} takes no part ({}).", peers[p].name, result.peers[p].cannot);
    }
  }
  return text;
}

std::string rest_text(const ProblemResult& result) {
  if (result.problem.reference.find("nothing moves") == std::string::npos) return "";
  std::vector<std::string> speeds;
  for (const Contender& contender : contenders()) {
    const std::vector<Rung> rungs = ladder(result.rungs, contender.name);
    double largest = 0.0;
    bool finite = true;
    for (const Rung& rung : rungs) {
      finite = finite && rung.trial.finite;
      largest = std::max(largest, rung.trial.speed_m_s);
    }
    speeds.push_back(
        fmt::format("`{}` {}", contender.name, finite ? error_text(largest) : "not finite"));
  }
  return fmt::format("\nLargest speed in the last frame, over all numbers of steps, in m/s: {}.\n",
                     fmt::join(speeds, "; "));
}

std::string scene_section(const ProblemResult& result, const std::vector<Peer>& peers) {
  const Problem& p = result.problem;
  return fmt::format(
      "### {}\n\n{:g} s. Right answer: {}. Errors are relative to {}, {:.3g} m.{}\n\n"
      "![{}](accuracy-{}.svg)\n\n{}{}\n",
      p.title, p.seconds(), p.reference, p.length, p.length_m, who_takes_no_part(result, peers),
      p.title, p.name, settings_table(result), rest_text(result));
}

std::string demonstrations_table(const std::vector<ProblemResult>& results) {
  std::vector<std::vector<std::string>> rows;
  for (const ProblemResult& result : results) {
    if (!result.demonstration) continue;
    const Problem& p = result.problem;
    const std::vector<Rung> mine = ladder(result.rungs, ours);
    const auto at = [&](int steps) {
      for (const Rung& rung : mine) {
        if (rung.steps_per_frame == steps) return error_text(rung.trial.error);
      }
      return std::string("-");
    };
    const auto least = [&](const std::string& setting) {
      const double best = best_error(ladder(result.rungs, setting));
      return std::isinf(best) ? "not finite" : error_text(best);
    };
    rows.push_back({p.name, fmt::format("{:g} s", p.seconds()), fmt::format("{:.3g} m", p.length_m),
                    error_text(p.doubt_m / p.length_m), order_text(result.problem, mine), at(1),
                    at(4), at(64), least("pinch iterative"), least("thesis"),
                    least("pinch_no_contact direct"), least("cable direct")});
  }
  return markdown_table({"demonstration", "horizon", "length", "doubt", "order", "1 step",
                         "4 steps", "64 steps", "best of pinch iterative", "best of thesis",
                         "best of pinch_no_contact direct", "best of cable direct"},
                        rows);
}

std::string demonstrations_section(const std::vector<ProblemResult>& results) {
  if (std::none_of(results.begin(), results.end(),
                   [](const ProblemResult& r) { return r.demonstration; })) {
    return "";
  }
  return fmt::format(
      "### The demonstrations\n\nTheir right answer is not known otherwise, so it is "
      "{}. Errors are the largest of any body's centre and rim, relative to "
      "the farthest that one gets from its start. The doubt is 2.5 times the distance between that "
      "solution and the one at half as many steps, over the whole horizon, which allows for an "
      "order of 1/2; errors below it say nothing. "
      "Where the order is near 2 the motion is smooth; where it is 1 or less, bodies meet with "
      "an impact, whose moment is known to a step, and what follows inherits that. A best error "
      "that stays large at all numbers of steps is the model's own, not the step's.\n\n"
      "![The demonstrations](accuracy-demonstrations.svg)\n\n{}\n",
      results.back().problem.reference, demonstrations_table(results));
}

std::string peers_text(const std::vector<Peer>& peers) {
  std::string text;
  for (const Peer& peer : peers) {
    text += peer.present() ? fmt::format("* **{} {}**: {}\n", peer.name, peer.version, peer.model)
                           : fmt::format(
                                 "* **{}** was not there: `{}` was not installed when "
                                 "Pinchlab was built.\n",
                                 peer.name, peer.package);
  }
  return text;
}

}  // namespace

std::string error_text(double value) {
  return value == 0.0 ? "0" : fmt::format("{:.1e}", value);
}

std::string microseconds(double cpu_s_per_s) {
  const double us = 1e6 * cpu_s_per_s;
  return us < 10000.0 ? fmt::format("{:.0f} µs", us) : fmt::format("{:.3g} ms", 1e-3 * us);
}

std::string order_text(const Problem& problem, const std::vector<Rung>& rungs) {
  const double doubt = problem.doubt_m / problem.length_m;
  const double order = observed_order(rungs, std::max(1e-12, doubt));
  if (best_error(rungs) < 1e-9 && rungs.front().trial.error < 1e-9) return "exact";
  if (std::isnan(order)) return "-";
  return std::abs(order) < 0.05 ? "0.0" : fmt::format("{:.1f}", order);
}

std::string accuracy_page(const std::vector<ProblemResult>& results, const std::vector<Peer>& peers,
                          const Limits& ours_limits, const Limits& peer_limits) {
  std::string text = fmt::format(
      "# Error against processor time\n\n"
      "Every method with every solver, and the thesis' configuration as a whole, at 1, 2, 4, ... "
      "steps a frame of 1/60 s, on scenes whose motion is known, and on the demonstrations. The "
      "error is the largest distance, over all frames, of a watched body from where it should be, "
      "relative to a length that is named with each scene. Time is processor time of the steps a "
      "simulated second, the median of repeats, with sleep and diagnostics off. A setting is left "
      "out at finer steps once a simulated second takes {:g} s (another engine's: {:g} s). Raw "
      "numbers: `accuracy.csv`.\n\n## In short\n\n{}\n"
      "## Which setting is cheapest\n\n"
      "The cheapest of Pinchlab's settings that meets the error, and meets it at all finer steps "
      "too; what the reference itself may be off by is added to each error. Of settings within 15 "
      "% of the least time the first is named, in the order of the "
      "tables below. \"Not vouched for\": the reference itself is no better.\n\n{}\n",
      ours_limits.ladder_cpu_s_per_s, peer_limits.ladder_cpu_s_per_s, in_short(results, peers),
      cheapest_table(results));
  text += "## Against other engines, at equal error\n\n" + peers_text(peers);
  if (std::any_of(peers.begin(), peers.end(), [](const Peer& p) { return p.present(); })) {
    text +=
        "\nEach with the best of its settings; a lucky one counts. \"Cannot\": see the scene.\n\n" +
        peers_table(results, peers);
  }
  text += events_section(results);
  text += fmt::format("\n## Where `{}` is not the cheapest\n\n{}\n## Scene by scene\n\n", ours,
                      where_beaten(results, peers));
  for (const ProblemResult& result : results) {
    if (!result.demonstration) text += scene_section(result, peers);
  }
  return text + demonstrations_section(results);
}

}  // namespace pinchlab::experiments
