// SPDX-License-Identifier: GPL-3.0-or-later
// Blows on several contacts at once.

#include <array>
#include <cmath>
#include <utility>

#include "sim/outline.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

class AtOnce : public ::testing::TestWithParam<int> {};

// Struck by one corner after the other it turned, and went off to a side.
TEST_P(AtOnce, ABoxThatFallsFlatRebounds) {
  Scene scene;
  Body box = body("box", BodyKind::free, 0.0, 0.7, 0.1, 1.0);
  make_polygon(box, {{-0.3, -0.2}, {0.3, -0.2}, {0.3, 0.2}, {-0.3, 0.2}}, 0.0);
  box.restitution = 0.5;
  scene.bodies.push_back(box);
  scene.walls.push_back({Vec2(-3.0, 0.0), Vec2(3.0, 0.0), 0.0, 0.5});
  const World world = after(scene, GetParam(), 0.5);
  const double fallen = std::sqrt(2.0 * 0.5 / g), up = 0.5 - fallen;  // s
  EXPECT_NEAR(world.position[0].y(), 0.2 + 0.5 * g * fallen * up - 0.5 * g * up * up, 1e-9);
  EXPECT_NEAR(world.position[0].x(), 0.0, 1e-12);
  EXPECT_NEAR(world.angle[0], 0.0, 1e-12);
  EXPECT_NEAR(after(scene, GetParam(), 2.0).position[0].y(), 0.2, 1e-9) << "at rest";
}

// Two balls meet a third from both sides, which stays; in any order of the list.
TEST_P(AtOnce, BallsFromBothSides) {
  for (const auto& order : {std::array{0, 1, 2}, {0, 2, 1}, {2, 1, 0}}) {
    Scene scene;
    scene.gravity = Vec2::Zero();
    for (const int k : order) {
      scene.bodies.push_back(body("ball", BodyKind::free, 0.5 * (k - 1), 0.0, 0.1, 1.0));
      scene.bodies.back().velocity.x() = 1.0 - k;
      scene.bodies.back().restitution = 0.5;
    }
    const World world = after(scene, GetParam(), 0.5);
    for (std::size_t b = 0; b < 3; ++b) {
      // They go 0.3 m until they meet, and back half as fast.
      const int k = order[b];
      EXPECT_NEAR(world.position[b].x(), (k - 1) * (0.2 + 0.5 * 0.2), 1e-9) << k;
    }
  }
}

// A ball falls along the middle of a groove of two walls, and goes back as it came.
TEST_P(AtOnce, ABallInAGroove) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  Body ball = body("ball", BodyKind::free, 0.0, 1.0, 0.1, 1.0);
  ball.velocity = {0.0, -2.0};
  ball.restitution = 1.0;
  ball.contact_friction = 0.0;
  scene.bodies.push_back(ball);
  for (const double side : {-1.0, 1.0}) {
    scene.walls.push_back({Vec2(0.0, 0.0), Vec2(side * std::sqrt(3.0), 1.0), 0.0, 0.0});
  }
  const World world = after(scene, GetParam(), 0.6);
  const double depth = 0.1 / std::cos(std::atan(1.0 / std::sqrt(3.0)));  // m, of its centre
  EXPECT_NEAR(world.position[0].y(), depth + (1.2 - (1.0 - depth)), 1e-9);
  EXPECT_NEAR(world.position[0].x(), 0.0, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Impact, AtOnce, ::testing::Values(1, 4, 16));

}  // namespace
}  // namespace pinchlab::testing
