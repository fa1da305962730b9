// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Other engines, run on the same problems. Each is compiled in only where its library is installed.

#include <functional>
#include <string>
#include <vector>

#include "analysis/experiments/work_precision.h"

namespace pinchlab::experiments {

/// One way to run a problem, at any number of steps a frame.
struct PeerSetting {
  std::string text;  ///< "links of 0.1 m, 8 and 3 iterations"
  std::function<Recording(const Problem&, int steps_per_frame)> run;
};

struct Peer {
  std::string name;     ///< "Box2D"
  std::string package;  ///< Debian's name: "libbox2d-dev"
  std::string version;  ///< "2.4.1"; empty where the library was not there at build time
  std::string model;    ///< how it models a cable, and what it cannot do, for the page
  /// Why it cannot take part in a problem; empty where it can.
  std::function<std::string(const Problem&)> cannot;
  /// Each worth trying; `quick`: the most promising one or two.
  std::function<std::vector<PeerSetting>(const Problem&, bool quick)> settings;

  bool present() const { return !version.empty(); }
};

/// Whether the problem is a cable with mass that hangs, and nothing else: nodes and the pieces
/// between them.
bool is_chain(const Problem& problem);

/// All known peers, present or not.
std::vector<Peer> peers();

}  // namespace pinchlab::experiments
