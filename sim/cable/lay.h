// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Cables as they start: over which corners of polygons they run, tangents, wraps, and the material
// along them.

#include "sim/world.h"

namespace pinchlab {

/// Cable c of the scene, for the bodies' positions in `world`. Throws SceneError where it does not
/// fit, to `allowed` (m; overlap_allowed).
CableState lay_cable(const Scene& scene, const World& world, double allowed, std::size_t c);

}  // namespace pinchlab
