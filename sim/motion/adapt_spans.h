// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The number of nodes of a cable with mass that runs over bodies adapts as that of hanging ones
// does (adapt_nodes.h), by spans between nodes which hold a bend (cable/held_spans.h). Any two that
// are neighbours may become one; pieces beside rims and ends stay the finest. A span that loses its
// tension becomes two, since it is no cable that could give way. All that is so chosen is chosen
// from both ends of the cable inwards, so that neither is its first.

#include "sim/world.h"

namespace pinchlab {

class BoxTree;

/// Whether the cable is to get other nodes at the end of a step.
bool wants_other_nodes(const Scene& scene, const World& world, const BoxTree& near, int cable);

/// Gives it these, the velocities being those of the positions' time. How many have come and gone.
int change_nodes(const Scene& scene, World& world, const BoxTree& near, int cable);

/// Lets out bends that tension straightens.
void let_out_spans(const Scene& scene, World& world, int cable);

}  // namespace pinchlab
