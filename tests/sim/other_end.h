// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Scenes whose cables are written from their other ends: they move as before.

#include <algorithm>
#include <utility>

#include "sim/scene.h"

namespace pinchlab::testing {

/// Closed cables from their last link; pieces between nodes as they are.
inline Scene from_the_other_end(Scene scene) {
  for (Cable& cable : scene.cables) {
    if (cable.piece) continue;
    std::swap(cable.start, cable.end);
    std::ranges::reverse(cable.wraps);
    for (Wrap& wrap : cable.wraps) wrap.orientation = -wrap.orientation;
  }
  return scene;
}

}  // namespace pinchlab::testing
