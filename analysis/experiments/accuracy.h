// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// `pinchlab bench accuracy`: error against processor time, ours and other engines'.

#include <string>
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
  std::vector<Rung> rungs;        ///< one ladder a contender, in the contenders' order
  std::vector<PeerResult> peers;  ///< one a peer, in the peers' order
};

/// The rungs of one setting.
std::vector<Rung> ladder(const std::vector<Rung>& rungs, const std::string& setting);

/// accuracy-NAME for each problem, and accuracy-demonstrations for those. The tables accuracy.csv
/// and accuracy-fronts.csv must be there.
void write_accuracy_figures(Output& output, const std::vector<ProblemResult>& results,
                            const std::vector<Peer>& peers);

/// What the figures show, in words; the limits are those that our and the peers' ladders had.
std::string accuracy_page(const std::vector<ProblemResult>& results, const std::vector<Peer>& peers,
                          const Limits& ours_limits, const Limits& peer_limits);

/// Runs everything; writes accuracy.csv, accuracy-fronts.csv, the figures and accuracy.md.
void run_accuracy(const Options& options);

}  // namespace pinchlab::experiments
