// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "demos/scenes/build.h"
#include "sim/nodes.h"
#include "tests/sim/random.h"

namespace pinchlab::testing {

/// A body over the middle of a cable of 2.3 m and 0.5 kg/m that hangs between two points 2 m apart,
/// half a metre below its centre.
struct Load {
  double mass = 3.0;       // kg
  double velocity = 0.0;   // m/s, upwards
  int nodes = 0;           // at most; 0: by the tension of the cable alone
  double tolerance = 0.0;  // m; 0: their number is fixed
};

inline Scene load_on_cable(const Load& load) {
  Scene scene;
  scene.bodies.push_back(build::body("load", BodyKind::free, 0.0, 1.5, 0.15, load.mass));
  scene.bodies[0].velocity = {0.0, load.velocity};
  scene.cables.push_back(build::cable(build::at(-1.0, 1.0), {}, build::at(1.0, 1.0), 0.02));
  Cable& cable = scene.cables[0];
  cable.slack = 0.3;
  cable.mass_per_metre = 0.5;
  cable.nodes = load.nodes;
  cable.node_tolerance = load.tolerance;
  spread_nodes(scene);
  return scene;
}

/// One or two bodies of up to 50 kg that fall on to a hanging cable, off its middle and across: of
/// any slack, with and without friction, bouncing or not; the number of its nodes chosen, given or
/// adapting.
inline Scene random_load(int seed) {
  Random random(static_cast<unsigned>(seed));
  const auto uniform = [&](double low, double high) { return random.uniform(low, high); };
  Scene scene;
  const double friction = random.below(2) * uniform(0.1, 0.8);
  const double restitution = random.below(3) == 0 ? uniform(0.1, 0.8) : 0.0;
  const int bodies = 1 + random.below(2);
  for (int i = 0; i < bodies; ++i) {
    const double radius = uniform(0.08, 0.2);
    double x = uniform(-0.6, 0.6);
    if (bodies == 2) x = 0.2 * x + (i == 0 ? -0.35 : 0.35);
    Body body = build::body(i == 0 ? "load" : "other", BodyKind::free, x, uniform(0.4, 1.2), radius,
                            random.spread(0.3, 50.0));
    body.velocity = {uniform(-1.0, 1.0), uniform(-5.0, 1.0)};
    body.contact_friction = friction;
    body.restitution = restitution;
    scene.bodies.push_back(body);
  }
  const double half = uniform(0.8, 1.2);
  Cable cable = build::cable(build::at(-half, uniform(-0.2, 0.2)), {}, build::at(half, 0.0), 0.015);
  cable.slack = random.spread(0.03, 0.8);
  cable.mass_per_metre = random.spread(0.1, 3.0);
  cable.contact_friction = friction;
  const int kind = random.below(4);
  if (kind == 1) cable.nodes = 5 + random.below(26);
  if (kind >= 2) cable.nodes = kind == 2 ? 15 : 31;
  if (kind == 3) cable.node_tolerance = random.spread(1e-3, 1e-2);
  scene.cables.push_back(cable);
  spread_nodes(scene);
  return scene;
}

}  // namespace pinchlab::testing
