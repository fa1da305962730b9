// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/mirror.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {

/// The mirror image of a scene moves as the image of the scene: after so many steps to `rounding`
/// (m).
inline void expect_moves_as_image(const Scene& scene, int steps, double rounding, unsigned seed) {
  const Scene image = mirrored(scene);
  World world = make_world(scene, Method::pinch), other = make_world(image, Method::pinch);
  run(scene, world, steps);
  run(image, other, steps);
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    EXPECT_NEAR(world.position[b].x(), -other.position[b].x(), rounding) << seed;
    EXPECT_NEAR(world.position[b].y(), other.position[b].y(), rounding) << seed;
  }
}

}  // namespace pinchlab::testing
