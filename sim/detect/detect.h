// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What touches what, and the course that the cables take.

#include <vector>

#include "sim/stages.h"
#include "sim/world.h"

namespace pinchlab {

struct SpanPair;
struct Workspace;

/// Cables, contacts and pinches for the bodies' present positions: the second half of a step.
void detect(const Scene& scene, World& world, Workspace& work, StageTimes* times = nullptr);

/// The same in two, where the segments are up to date: takes off links and finds pairs, which may
/// stand unless links come off; and then what of these meets, and the parts that there are then.
void find_what_may_meet(const Scene& scene, World& world, Workspace& work, bool pairs_stand,
                        StageTimes* times);
void find_what_meets(const Scene& scene, World& world, Workspace& work, StageTimes* times);

/// The pairs that may touch or hit.
void find_pairs(const Scene& scene, const World& world, Workspace& work);

/// The spans and bodies that may have met within the interval being tried: of a divided step, those
/// that move in it.
const std::vector<SpanPair>& find_pairs_of_interval(const Scene& scene, const World& world,
                                                    Workspace& work);

/// Those that were found last.
const std::vector<SpanPair>& pairs_of_interval(const World& world, const Workspace& work);

}  // namespace pinchlab
