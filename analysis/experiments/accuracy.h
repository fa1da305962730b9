// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// `pinchlab bench accuracy`: error against processor time, ours and other engines'.

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "analysis/experiments/experiment.h"
#include "analysis/experiments/peers/peer.h"
#include "analysis/experiments/work_precision.h"

namespace pinchlab::experiments {

/// What another engine did on a problem.
struct PeerResult {
  std::string cannot;       ///< why it took no part; empty where it did
  std::vector<Rung> rungs;  ///< ladder after ladder
};

/// All that ran on one problem.
struct ProblemResult {
  Problem problem;
  bool demonstration = false;
  bool events = false;            ///< of event_scenes.h
  std::vector<Rung> rungs;        ///< one ladder a contender, in the contenders' order
  std::vector<Rung> at_steps;     ///< of event scenes: our default's, with events at the steps
  std::vector<PeerResult> peers;  ///< one a peer, in the peers' order
};

/// Those of accuracy_scenes.h and event_scenes.h that are not known from their own solutions only;
/// nothing has run on them yet.
std::vector<ProblemResult> scenes_of_known_motion();

/// Setting of ProblemResult::at_steps; without a comma, at which gnuplot would cut it.
inline const std::string events_at_steps = "pinch direct with events at the steps";

/// The rungs of one setting.
std::vector<Rung> ladder(const std::vector<Rung>& rungs, const std::string& setting);

/// accuracy-NAME for each problem, and accuracy-demonstrations for those. The tables accuracy.csv
/// and accuracy-fronts.csv must be there.
void write_accuracy_figures(Output& output, const std::vector<ProblemResult>& results,
                            const std::vector<Peer>& peers);

/// accuracy-events: of event scenes, with events at their time and at the steps. Tables as above.
void write_events_figure(Output& output, const std::vector<ProblemResult>& results);

/// The page's section on that, and its line in short; empty without event scenes.
std::string events_section(const std::vector<ProblemResult>& results);
std::string events_sentence(const std::vector<ProblemResult>& results);

/// Gnuplot commands: logarithmic axes, and drawn(e), for errors too small to draw.
std::string accuracy_axes();

/// Lowest and highest decade of the errors that those draw.
std::pair<double, double> error_range(const std::vector<const ProblemResult*>& results);

/// Gnuplot's columns of error against time, of the rows of a scene with that in a column.
std::string accuracy_points(const std::string& scene, const std::string& column,
                            const std::string& value);

/// The doubt of the reference as a grey line; empty where there is none.
std::string doubt_line(const Problem& problem);

// Words that the page's parts share.
std::string error_text(double error);          ///< "1.0e-04"
std::string microseconds(double cpu_s_per_s);  ///< processor time a simulated second
std::string order_text(const Problem& problem, const std::vector<Rung>& rungs);

/// Errors that the page asks for.
inline constexpr std::array wanted_errors{1e-2, 1e-3, 1e-4, 1e-6};

/// What the figures show, in words; the limits are those that our and the peers' ladders had.
std::string accuracy_page(const std::vector<ProblemResult>& results, const std::vector<Peer>& peers,
                          const Limits& ours_limits, const Limits& peer_limits);

/// Runs everything; writes accuracy.csv, accuracy-fronts.csv, the figures and accuracy.md.
void run_accuracy(const Options& options);

}  // namespace pinchlab::experiments
