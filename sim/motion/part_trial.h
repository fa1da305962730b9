// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// An interval of one part, tried: its forces, its solve, its motion, and what lengths and gaps miss
// then, corrected until they are exact.

#include "sim/stages.h"
#include "sim/world.h"

namespace pinchlab {

struct IntervalTrial;
struct Part;
struct Workspace;

constexpr int shake_rounds = 12;  // of corrections: each gains at least a factor 2, mostly 100

/// How an interval is tried.
struct Attempt {
  double length;                   // s
  int most_rounds = shake_rounds;  // of corrections
  bool begins = false;             // it is the first since begin_interval
  bool locates = true;    // what happens in it; else constraints bear force as early as it takes
  bool foresees = false;  // what is to be corrected, where the intervals before tell
};

/// Tries an interval of a part from where Workspace::start has it.
IntervalTrial try_part(const Scene& scene, World& world, Workspace& work, Part& part,
                       const Attempt& attempt, Stopwatch& watch);

/// Puts a part back to where its interval began.
void put_back(World& world, Workspace& work, const Part& part);

}  // namespace pinchlab
