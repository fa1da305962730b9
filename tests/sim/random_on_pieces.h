// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "demos/scenes/build.h"
#include "sim/nodes.h"
#include "sim/outline.h"
#include "tests/sim/random.h"

namespace pinchlab::testing {

/// One to three bodies, mostly smaller than the pieces of a hanging cable, that fall on to it:
/// discs, or with `polygons` these too, of any friction, bouncing or not. In some a wall ends below
/// the cable, or its number of nodes adapts.
inline Scene random_on_pieces(int seed, bool polygons) {
  Random random(static_cast<unsigned>(seed) + 7000U);
  const auto uniform = [&](double low, double high) { return random.uniform(low, high); };
  Scene scene;
  const double friction = random.below(2) * uniform(0.1, 0.8);
  const double restitution = random.below(3) == 0 ? uniform(0.1, 0.8) : 0.0;
  const int bodies = 1 + random.below(3);
  for (int i = 0; i < bodies; ++i) {
    const double radius = uniform(0.015, 0.05);
    Body body = build::body("body " + std::to_string(i), BodyKind::free, uniform(-0.4, 0.4),
                            0.3 + 0.15 * i, radius, random.spread(0.05, 3.0));
    if (polygons && random.below(2) == 0) {
      std::vector<Vec2> corners;
      const int count = 3 + random.below(3);
      const double turn = uniform(0.0, 2.0);
      for (int k = 0; k < count; ++k) {
        corners.push_back(turned(Vec2(radius, 0.0), turn + 6.283185307179586 * k / count));
      }
      make_polygon(body, corners, random.below(2) * 0.2 * radius);
      body.angular_velocity = uniform(-5.0, 5.0);
    }
    body.velocity = {uniform(-1.0, 1.0), uniform(-3.0, 0.0)};
    body.contact_friction = friction;
    body.restitution = restitution;
    scene.bodies.push_back(body);
  }
  Cable cable = build::cable(build::at(-0.6, uniform(-0.1, 0.1)), {}, build::at(0.6, 0.0), 0.01);
  cable.slack = random.spread(0.03, 0.4);
  cable.mass_per_metre = random.spread(0.1, 3.0);
  cable.contact_friction = friction;
  cable.nodes = 3 + random.below(8);
  if (random.below(4) == 0) {
    cable.nodes = 7;
    cable.node_tolerance = random.spread(1e-3, 1e-2);
  }
  scene.cables.push_back(cable);
  if (random.below(3) == 0) {
    const double y = uniform(-0.8, -0.5);
    scene.walls.push_back({{-1.5, y}, {uniform(-0.2, 0.2), y + uniform(-0.1, 0.1)}, 0.5, 0.0});
  }
  spread_nodes(scene);
  return scene;
}

}  // namespace pinchlab::testing
