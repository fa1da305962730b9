// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "demos/scenes/build.h"
#include "sim/nodes.h"
#include "tests/sim/random.h"

namespace pinchlab::testing {

/// A hanging cable whose number of nodes adapts: between two posts, and blown at; with a weight
/// that is let go at its end; or held by a counterweight over a pulley. Its steps are short enough
/// for its whipping.
inline Scene random_hanging(int seed) {
  Random random(static_cast<unsigned>(seed));
  const auto uniform = [&](double low, double high) { return random.uniform(low, high); };
  Scene scene;
  scene.steps_per_frame = 32;
  const double width = uniform(0.6, 1.4);
  Cable cable = build::cable(build::at(0.0, 0.0), {}, build::at(width, uniform(-0.3, 0.3)), 0.003);
  cable.slack = uniform(0.05, 0.5);
  cable.mass_per_metre = std::exp(uniform(-1.5, 1.0));
  cable.nodes = 31;
  cable.node_tolerance = std::exp(uniform(std::log(5e-4), std::log(2e-2)));
  const int kind = random.below(3);
  if (kind > 0) {
    Body ring = build::body("ring", BodyKind::free, cable.end.point, 0.01, uniform(0.1, 1.0));
    ring.node = true;
    scene.bodies.push_back(ring);
    cable.end = build::on(0);
  }
  scene.cables.push_back(cable);
  if (kind == 2) {
    scene.bodies.push_back(build::body("pulley", BodyKind::fixed_axle, width + 1.0, 0.2, 0.1, 0.5));
    scene.bodies.push_back(
        build::body("weight", BodyKind::free, width + 1.103, -1.0, 0.05, uniform(0.5, 4.0)));
    scene.cables.push_back(build::cable(build::on(0), {{1, -1, 0}}, build::on(2), 0.003));
  }
  spread_nodes(scene);
  if (kind != 0) return scene;
  const Vec2 wind(uniform(-1.0, 1.0), uniform(-0.5, 0.5));  // m/s
  for (Body& body : scene.bodies) body.velocity = wind;
  return scene;
}

}  // namespace pinchlab::testing
