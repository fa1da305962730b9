// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One interval of a step: tried, taken back and tried again until nothing happens in it but at its
// end, lengths and gaps are exact there, and its error is what the scene allows.

#include <span>

#include "sim/stages.h"
#include "sim/world.h"

namespace pinchlab {

struct IntervalTrial;
struct Part;
struct Workspace;

/// The share of Configuration::error that one interval may err by. Intervals' errors add up, and an
/// impact that comes a little late throws bodies apart: measured, so that demonstrations keep what
/// they ask for (analysis/results/convergence.md).
constexpr double share_of_error = 4e-5;

/// What moves together by one interval: some parts.
struct Movers {
  std::span<const int> parts;
  bool crept = false;  // Neighbourhood::crept
  bool jumps = true;   // jumps.h are events
};

/// Notes that an interval of these begins at `time` (s), with the world as it is: Workspace::start.
void begin_interval(const World& world, Workspace& work, const Movers& movers, double time);

/// Moves them by `length` (s); whether nothing happens then, lengths and gaps are exact, the error
/// is what the scene allows and the interval no longer than it may be, so that this is it. To be
/// the first try since begin_interval.
bool try_whole_interval(const Scene& scene, World& world, Workspace& work, const Movers& movers,
                        double length, Stopwatch& watch);

/// Moves them, where a whole interval of `length` has just been tried in vain, by the longest in
/// which nothing happens but at its end; what happens there is in Workspace::events. Returns its
/// length. `met`: lengths and gaps are exact there. Clears Movers::jumps where one cannot be found.
double shorten_interval(const Scene& scene, World& world, Workspace& work, Movers& movers,
                        double length, bool& met, Stopwatch& watch);

/// Moves them by an interval of `length` (s), shortened to what waves ask for, or to where lengths
/// and gaps are exact, whatever happens in it: constraints bear force as early as it takes. Whether
/// they are exact at its end.
bool cross_interval(const Scene& scene, World& world, Workspace& work, const Movers& movers,
                    double& length, Stopwatch& watch);

/// The last trial of these parts.
IntervalTrial trial_of(const Workspace& work, std::span<const int> parts);

/// Whether a trial of that length (s) errs by no more than the scene allows, has followed all waves
/// on cables of nodes, is no longer than vanishing spans allow, and needs no repair.
bool is_sound(const World& world, const IntervalTrial& trial, double length);

/// Of the time that is left of a step (s) the interval to try: all of it, or what follows the waves
/// on these parts' cables under the tensions that they have and, with `locates`, their vanishing
/// spans.
double length_to_try(const World& world, const Workspace& work, std::span<const int> parts,
                     double left, bool locates);

/// Puts these back to where their interval began.
void go_back(World& world, Workspace& work, std::span<const int> parts);

/// Notes how a part's ways bend in an interval of `length` (s), whose last trial that was, how fast
/// it stretches, and its pace; `met`: nothing happened in it, and lengths and gaps are exact.
void note_ways(World& world, const Workspace& work, const Part& part, const IntervalTrial& trial,
               double length, bool met);

}  // namespace pinchlab
