// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "base/at.h"
#include "demos/scenes/shape_scenes.h"
#include "sim/joints.h"
#include "sim/nodes.h"
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

/// Elastic cables over pulleys that they do not slip on, with loads, and discs that fall on them.
inline Scene random_elastic(unsigned seed) {
  Random random(seed);
  Scene scene;
  const int pulleys = 1 + 2 * random.below(2);
  std::vector<Wrap> wraps;
  for (int i = 0; i < pulleys; ++i) {
    scene.bodies.push_back(body(fmt::format("pulley {}", i), BodyKind::fixed_axle, 1.2 * i,
                                random.uniform(-0.1, 0.1), random.uniform(0.2, 0.4),
                                std::pow(10.0, random.uniform(-0.5, 0.5))));
    wraps.push_back({i, i % 2 == 0 ? -1 : 1, 0});
  }
  for (const double x : {-0.5, 1.2 * (pulleys - 1) + 0.5}) {
    scene.bodies.push_back(body(x < 0 ? "left" : "right", BodyKind::free, x, -2.0, 0.1,
                                std::pow(10.0, random.uniform(-0.3, 0.7))));
  }
  scene.cables.push_back(cable(on(pulleys), wraps, on(pulleys + 1), 0.03));
  scene.cables[0].axial_stiffness = std::pow(10.0, random.uniform(2.5, 4.0));
  if (random.below(2) == 0) {
    scene.bodies.push_back(body("falling", BodyKind::free, 0.6, 1.5, 0.15, 0.5));
    scene.bodies.back().angular_velocity = random.uniform(-3.0, 3.0);
  }
  return scene;
}

/// The same by ropes with mass.
inline Scene heavy_elastic(unsigned seed) {
  Scene scene = random_elastic(seed);
  scene.cables[0].mass_per_metre = std::pow(10.0, Random(seed + 555).uniform(-1.5, 0.3));
  return scene;
}

/// The same over pulleys on which the rope slips, with friction or without.
inline Scene slipping_elastic(unsigned seed) {
  Scene scene = random_elastic(seed);
  Random random(seed + 777);
  for (Body& body : scene.bodies) {
    body.cable_friction = random.below(3) == 0 ? 0.0 : random.uniform(0.05, 0.6);
  }
  return scene;
}

/// A linkage: discs of all weights hinged, barred and sprung to one another and to the world, at
/// random.
inline Scene linkage(unsigned seed) {
  std::uint64_t state = 0x9e3779b97f4a7c15ULL * (seed + 1);
  const auto random = [&state] {  // 0 to 1, xorshift64*
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return static_cast<double>((state * 0x2545f4914f6cdd1dULL) >> 11) * 0x1p-53;
  };
  Scene scene;
  const int count = 2 + static_cast<int>(4.0 * random());
  for (int i = 0; i < count; ++i) {
    const double radius = 0.1 + 0.15 * random();
    scene.bodies.push_back(body(fmt::format("{}", i), BodyKind::free, 0.7 * i, 0.3 * random(),
                                radius, std::pow(10.0, -1.0 + 2.0 * random())));
    at(scene.bodies, i).velocity = {2.0 * random() - 1.0, 2.0 * random() - 1.0};
    at(scene.bodies, i).restitution = random() < 0.5 ? 0.0 : random();
    const int other = i - 1;
    const Attachment here{i, {radius * (random() - 0.5), radius * (random() - 0.5)}};
    const Attachment there =
        other < 0 ? Attachment{-1, {-0.5, 0.5}}
                  : Attachment{other, {0.1 * (random() - 0.5), 0.1 * (random() - 0.5)}};
    const std::string name = fmt::format("joint {}", i);
    const double kind = random();
    if (kind < 0.4) {
      add_bar(scene, name, here, there);
    } else if (kind < 0.8) {
      const Vec2 pin =
          other < 0 ? Vec2(-0.2, 0.4) : Vec2(at(scene.bodies, other).position + Vec2(0.35, 0.1));
      add_hinge(scene, name, i, other, pin);
    } else {
      add_spring(scene, name, here, there, 20.0 + 200.0 * random(), 0.5, 5.0 * random());
    }
  }
  return scene;
}

/// Pulleys in a row, over and under which one heavy rope runs with weights at its ends, and discs
/// that fall on it.
inline Scene falling_on_rope(unsigned seed) {
  Random random(seed);
  Scene scene;
  const int pulleys = 1 + 2 * random.below(2);
  const double half_width = random.uniform(0.005, 0.02);
  for (int i = 0; i < 2; ++i) {
    const double x = i == 0 ? -0.3 : 1.2 * (pulleys - 1) + 0.3;
    scene.bodies.push_back(body("weight" + std::to_string(i), BodyKind::free, x,
                                random.uniform(-2.0, -1.0), 0.08, random.uniform(0.5, 3.0)));
  }
  for (int i = 0; i < pulleys; ++i) {
    scene.bodies.push_back(body("pulley" + std::to_string(i), BodyKind::fixed_axle, 1.2 * i,
                                random.uniform(-0.1, 0.1), random.uniform(0.1, 0.25),
                                random.uniform(0.1, 1.0)));
  }
  for (int i = 0; i < 1 + random.below(3); ++i) {
    scene.bodies.push_back(body("disc" + std::to_string(i), BodyKind::free,
                                0.8 * i + random.uniform(0.2, 0.5), random.uniform(0.8, 1.5),
                                random.uniform(0.08, 0.2), random.uniform(0.05, 2.0)));
    scene.bodies.back().angular_velocity = random.uniform(-5.0, 5.0);
    scene.bodies.back().restitution = random.below(3) == 0 ? random.uniform(0.0, 0.8) : 0.0;
  }
  scene.cables.push_back(cable(on(0), build::over_and_under(2, pulleys), on(1), half_width));
  scene.cables[0].mass_per_metre = std::pow(10.0, random.uniform(-2.0, 0.7));
  if (random.below(3) == 0) scene.cables[0].axial_stiffness = random.uniform(2e3, 5e4);
  return scene;
}

/// The same rope, which slips on some of the pulleys and discs, without friction or with.
inline Scene slipping_rope(unsigned seed) {
  Scene scene = falling_on_rope(seed);
  Random random(seed + 1000);
  for (Body& b : scene.bodies) {
    const int what = random.below(4);
    if (b.name.starts_with("weight") || what == 1) continue;
    b.cable_friction = what == 0 ? 0.0 : random.uniform(0.02, 0.5);
  }
  return scene;
}

/// The rope of `falling_on_rope`, one end of which is wound up in layers on a drum beside the
/// pulleys, which is braked. It begins or ends there.
inline Scene braked_rope(unsigned seed) {
  Scene scene = falling_on_rope(seed);
  Random random(seed + 2000);
  Body& drum = scene.bodies[0];
  drum.kind = BodyKind::fixed_axle;
  drum.position = {-random.uniform(1.0, 1.5), random.uniform(-1.2, -0.5)};
  drum.radius = random.uniform(0.1, 0.2);
  drum.angular_drag = random.uniform(0.2, 3.0);
  Cable& rope = scene.cables[0];
  const int orientation = random.below(2) == 0 ? 1 : -1;
  const double angle = random.uniform(0.0, 6.0), rim = drum.radius + rope.half_width;
  rope.start = {0, {rim * std::cos(angle), rim * std::sin(angle)}, true};
  rope.wraps.insert(rope.wraps.begin(), {0, orientation, 1 + random.below(6)});
  if (random.below(2) == 0) return scene;
  std::swap(rope.start, rope.end);
  std::reverse(rope.wraps.begin(), rope.wraps.end());
  for (Wrap& wrap : rope.wraps) wrap.orientation *= -1;
  return scene;
}

/// The same, inextensible, in layers or not, with nodes by which it hangs.
inline Scene strung_braked_rope(unsigned seed, bool layers) {
  Scene scene = braked_rope(seed);
  Cable& rope = scene.cables[0];
  rope.axial_stiffness = infinity;
  rope.slack = std::max(rope.slack, 0.0) + (seed % 3 == 1 ? 0.1 : 0.0);
  for (Attachment* end : {&rope.start, &rope.end}) end->layers = end->layers && layers;
  rope.nodes = 12 + static_cast<int>(seed) % 20;
  spread_nodes(scene);
  return scene;
}

/// A rope that discs fall on, with slip or without, inextensible, with nodes by which it hangs.
inline Scene strung_rope(unsigned seed) {
  Scene scene = seed % 2 == 0 ? falling_on_rope(seed) : slipping_rope(seed);
  scene.cables[0].axial_stiffness = infinity;
  scene.cables[0].nodes = 12 + static_cast<int>(seed) % 20;
  spread_nodes(scene);
  return scene;
}

}  // namespace pinchlab::testing
