// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One interval of a step: tried, taken back and tried again until nothing happens in it but at its
// end, lengths and gaps are exact there, and its error is what the scene allows.

#include "sim/stages.h"
#include "sim/world.h"

namespace pinchlab {

struct Workspace;

/// The share of Configuration::error that one interval may err by. Intervals' errors add up, and an
/// impact that comes a little late throws bodies apart: measured, so that demonstrations keep what they
/// ask for (analysis/results/convergence.md).
constexpr double share_of_error = 4e-5;

/// Notes that an interval begins at `time` (s), with the world as it is: Workspace::start.
void begin_interval(const World& world, Workspace& work, double time);

/// Moves the world by the longest interval of at most `length` (s) in which nothing happens but at its
/// end; what happens there is in Workspace::events. Returns its length. `met`: lengths and gaps are
/// exact there.
double find_interval(const Scene& scene, World& world, Workspace& work, double length, bool& met,
                     Stopwatch& watch);

/// Moves the world by an interval of `length` (s) whatever happens in it: constraints bear force as
/// early as it takes. Whether lengths and gaps are exact at its end.
bool cross_interval(const Scene& scene, World& world, Workspace& work, double length,
                    Stopwatch& watch);

}  // namespace pinchlab
