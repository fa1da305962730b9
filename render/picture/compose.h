// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The state of a simulation as a picture.

#include "render/picture/picture.h"
#include "render/picture/scenery.h"
#include "sim/world.h"

namespace pinchlab {

/// Fills `picture` (its storage is reused) with what `world` looks like now. A pure function of the
/// scene, its scenery and the world's positions, angles and cables: the methods of a pair look
/// alike, and nothing is remembered from frame to frame.
///
/// Bodies are drawn over the cables and let a little of them through, so that a body that has sunk
/// into a cable shows the overlap instead of hiding it.
void compose(const Scene& scene, const Scenery& scenery, const World& world, Picture& picture);

}  // namespace pinchlab
