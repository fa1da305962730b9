// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Builders of the scenes that the simulator's tests share.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim/step.h"
#include "sim/world.h"

namespace pinchlab::testing {

constexpr double g = 9.81;  // m/s^2, the default gravity

/// The method, with lengths, gaps and energy measured at each step.
inline Configuration measured(Method method = Method::pinch) {
  Configuration configuration = method;
  configuration.diagnostics = true;
  return configuration;
}

inline Body body(const std::string& name, BodyKind kind, double x, double y, double radius,
                 double mass) {
  Body b;
  b.name = name;
  b.kind = kind;
  b.position = {x, y};
  b.radius = radius;
  b.mass = mass;
  return b;
}

/// A cable from the world (or the centre of a body, where index >= 0) over wraps to the like.
inline Cable cable(const Attachment& start, std::vector<Wrap> wraps, const Attachment& end,
                   double half_width = 0.05) {
  Cable c;
  c.name = "cable";
  c.half_width = half_width;
  c.start = start;
  c.wraps = std::move(wraps);
  c.end = end;
  return c;
}

inline Attachment at(double x, double y) {
  return {-1, {x, y}};
}
inline Attachment on(int b) {
  return {b, {0.0, 0.0}};
}

/// Loads m1 and m2 on one cable over `pulleys` equal pulleys with fixed axles in a row, wrapped
/// over and under in turn: bodies 0 and 1 are the loads, the pulleys follow.
inline Scene load_chain(int pulleys, double m1, double m2, double pulley_mass,
                        double friction = infinity) {
  Scene scene;
  const double r = 0.5, w = 0.05, spacing = 1.5, R = r + w;
  scene.bodies.push_back(body("left", BodyKind::free, -R, -3.0, 0.2, m1));
  const double x_last = spacing * (pulleys - 1);
  std::vector<Wrap> wraps;
  wraps.reserve(static_cast<std::size_t>(pulleys));
  for (int i = 0; i < pulleys; ++i) {
    // The first and last wrap over the top; those between alternate, which needs an odd number.
    wraps.push_back({2 + i, i % 2 == 0 ? -1 : 1, 0});
  }
  scene.bodies.push_back(body("right", BodyKind::free, x_last + R, -3.0, 0.2, m2));
  for (int i = 0; i < pulleys; ++i) {
    Body p =
        body(fmt::format("pulley {}", i), BodyKind::fixed_axle, spacing * i, 0.0, r, pulley_mass);
    p.cable_friction = friction;
    scene.bodies.push_back(p);
  }
  scene.cables.push_back(cable(on(0), wraps, on(1)));
  return scene;
}

inline void run(const Scene& scene, World& world, int steps) {
  Workspace work;
  for (int i = 0; i < steps; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
  }
}

}  // namespace pinchlab::testing
