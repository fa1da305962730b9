// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "tests/sim/random.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {

/// Two to six free rollers of 0.1 to 10 kg that fall on three to five wrapped pulleys. No cable
/// slips where `seed` is a multiple of 3.
inline Scene random_scene(int seed) {
  Random random(static_cast<unsigned>(seed));
  const auto uniform = [&](double low, double high) { return random.uniform(low, high); };
  Scene scene;
  const int pulleys = 3 + random.below(3);
  const int rollers = 2 + random.below(5);
  std::vector<Wrap> wraps;
  for (int i = 0; i < pulleys; ++i) {
    Body p = body(fmt::format("pulley {}", i), BodyKind::fixed_axle, 1.3 * i,
                  -0.12 * std::pow(i - 0.5 * (pulleys - 1), 2), uniform(0.37, 0.43), 1.0);
    p.cable_friction = seed % 3 == 0 ? infinity : uniform(0.0, 0.6);
    scene.bodies.push_back(p);
    wraps.push_back({i, -1, 0});
  }
  for (int i = 0; i < rollers; ++i) {
    Body p =
        body(fmt::format("roller {}", i), BodyKind::free, uniform(-0.3, 1.3 * (pulleys - 1) + 0.3),
             1.6 + 0.9 * i, uniform(0.15, 0.4), std::pow(10.0, uniform(-1.0, 1.0)));
    p.cable_friction = seed % 3 == 0 ? infinity : uniform(0.0, 0.6);
    scene.bodies.push_back(p);
  }
  scene.cables.push_back(cable(at(-1.5, -1.5), wraps, at(1.3 * (pulleys - 1) + 1.5, -1.5)));
  scene.cables[0].slack = uniform(0.0, 0.5);
  scene.walls.push_back({Vec2(-10.0, -2.5), Vec2(20.0, -2.5), 0.5, 0.0});
  return scene;
}

}  // namespace pinchlab::testing
