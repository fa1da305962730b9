// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A scene in other units of length and mass, and in another order.

#include <algorithm>
#include <vector>

#include "base/at.h"
#include "sim/scene.h"

namespace pinchlab::testing {

/// The scene with lengths `l` times and masses `m` times as large, and everything else as its
/// dimension asks for, so that it moves alike in the same time. Where both are powers of two no
/// number is rounded.
inline Scene scaled(Scene scene, double l, double m = 1.0) {
  const double force = m * l, work = m * l * l;
  const auto scale = [](double factor, auto&... values) { ((values *= factor), ...); };
  scale(l, scene.gravity, scene.error, scene.view.low, scene.view.high);
  for (Body& b : scene.bodies) {
    scale(l, b.radius, b.corner_radius, b.seat, b.position, b.velocity);
    for (Vec2& corner : b.corners) corner *= l;
    scale(m, b.mass);
    if (b.inertia) *b.inertia *= work;
    scale(work, b.torque, b.torque_limit);
    if (!b.driven_angular_velocity) {
      for (MotorPoint& point : b.motor) point.value *= work;  // torques
    }
  }
  for (Cable& c : scene.cables) {
    scale(l, c.half_width, c.start.point, c.end.point, c.slack, c.node_tolerance);
    scale(force, c.axial_stiffness);
    scale(m, c.damping);
    scale(m / l, c.mass_per_metre);
    scale(work * l, c.bending_stiffness);
    scale(work, c.bend);
  }
  for (NodeChain& chain : scene.chains) {
    scale(l, chain.piece_length, chain.tolerance);
    scale(m / l, chain.mass_per_metre);
  }
  for (Wall& wall : scene.walls) scale(l, wall.a, wall.b);
  return scene;
}

/// The scene with its bodies, cables and walls listed from the last to the first, but for shapes,
/// which follow the body that carries them. `place` is where each body has come to. Not for chains
/// of nodes, whose bodies and cables are a run of the list.
inline Scene reversed(const Scene& scene, std::vector<int>& place) {
  Scene turned = scene;
  turned.bodies.clear();
  place.resize(scene.bodies.size());
  for (std::size_t b = scene.bodies.size(); b-- > 0;) {
    if (scene.bodies[b].carrier >= 0) continue;
    for (std::size_t k = b; k < scene.bodies.size(); ++k) {
      if (k != b && scene.bodies[k].carrier != static_cast<int>(b)) continue;
      place[k] = static_cast<int>(turned.bodies.size());
      turned.bodies.push_back(scene.bodies[k]);
    }
  }
  std::ranges::reverse(turned.cables);
  std::ranges::reverse(turned.walls);
  const auto move = [&](int& body) {
    if (body >= 0) body = pinchlab::at(place, body);
  };
  for (Body& body : turned.bodies) move(body.carrier);
  for (Cable& cable : turned.cables) {
    move(cable.start.body);
    move(cable.end.body);
    for (Wrap& wrap : cable.wraps) move(wrap.body);
  }
  for (auto& pair : turned.apart) {
    for (int& body : pair) move(body);
    std::ranges::sort(pair);
  }
  std::ranges::sort(turned.apart);
  return turned;
}

}  // namespace pinchlab::testing
