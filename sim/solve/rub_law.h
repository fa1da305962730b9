// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What friction takes of a rope's tension on its way over a body on which it slips: the capstan law
// with the rope's inertia, as rubbing.h derives it.
//
// Along a side of a polygon, which does not bend the rope, N = max(0, -rho b.n) a metre, where its
// elements have the acceleration of the place that they are at and, slipping at s on a side that
// turns at omega, 2 omega s left(e) besides (Coriolis). With b of the corners' centres, between
// which that place's is their mean,
//     N = -rho (b.n + omega^2 |p| + 2 o omega s),   o: the sense in which the rope goes round.
// Whether it presses at all is told by gravity and by the turning, which are known; not by how the
// body is accelerated, which is not yet.

#include "sim/solve/part_system.h"

namespace pinchlab {

struct SolveScratch;
struct World;

/// Row of a segment of the sleeve's cable.
int row_of_segment(const PartSystem& system, const SleevePlace& one, int segment);

/// The law for slipping forward (sign = 1) or backward (-1), of a head and what goes on from it.
void find_law(const World& world, SolveScratch& scratch, const SleevePlace& one, int sign,
              PartSystem& system, RubLaw& law);

}  // namespace pinchlab
