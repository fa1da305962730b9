// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What may happen within an interval and then ends it: Workspace::events.

#include <vector>

#include "sim/world.h"

namespace pinchlab {

struct Happening;
struct Workspace;

/// How many events of a step are located, of each neighbourhood, so that its cost is bounded: 48,
/// and four a node of a cable that runs over bodies, which may be hit beside, moored, let go and
/// taken in.
int located_events(const World& world);

/// Another trial of the interval begins.
void begin_trial(Workspace& work);

/// Notes what is left of an event in this trial (m; below 0: too late); a new one only where it is
/// late by `late` or more (below 0: or nearly there).
void measure(Workspace& work, const Happening& key, double clearance, double late);

/// Catches of a part: rows that idle and would have to bear force at the present positions,
/// contacts that close and cables that are pulled tight. New ones are listed, known ones measured
/// anew.
void find_catches(World& world, Workspace& work, int part);

/// Links of a part that have come off, likewise.
void find_gone_links(const World& world, Workspace& work, int part);

/// The same after an interval whose events were not located, of a part whose cables have nodes:
/// rims that have come upon nodes are to have these now. What links of other cables have come off
/// is seen at the positions (links.h).
void find_overrun_nodes(const World& world, Workspace& work, int part);

/// Bodies that have met spans, likewise.
void find_span_hits(const Scene& scene, const World& world, Workspace& work);

/// What closes is met early rather than late, by this share of its reach, so that nothing is ever
/// squeezed or stretched; what changes a cable's course late, so that it has happened. It is met
/// within half of that either way (locate_first_event): never on the other side of nothing, and
/// well within the reach.
constexpr double aim = 0.25;

/// Of the events the one of least clearance, over its reach; 0 where it is aimed at.
double least_clearance(const std::vector<Happening>& events);

/// The same when the interval began; infinity where that is not known of any.
double least_before(const std::vector<Happening>& events);

/// Whether that one is a jump (jumps.h).
bool is_jump_first(const std::vector<Happening>& events);

/// Changes the cables' courses as the events have it that have been met.
void change_courses(World& world, Workspace& work);

}  // namespace pinchlab
