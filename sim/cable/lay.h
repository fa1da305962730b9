// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Cables as they start: over which corners of polygons they run, tangents, wraps, and the material
// along them.

#include <vector>

#include "sim/world.h"

namespace pinchlab {

/// Storage of lay_cable, which serves the next.
struct LayScratch {
  std::vector<Link> choices;          // of all stops: the start, Cable::wraps, the end
  std::vector<std::size_t> begin;     // of each stop's, and the end
  std::vector<Link> arrives, leaves;  // of the stops
  std::vector<int> stops;  // of each link: of Cable::wraps; -1: the start; their number: the end
};

/// Lays cable c of the scene into `cable`, whatever that was, for the bodies' positions in `world`.
/// Throws SceneError where it does not fit, to `allowed` (m; overlap_allowed).
void lay_cable(const Scene& scene, const World& world, double allowed, std::size_t c,
               CableState& cable, LayScratch& scratch);

}  // namespace pinchlab
