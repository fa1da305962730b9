// SPDX-License-Identifier: GPL-3.0-or-later
// Velocities that the nodes of hanging cables start with.

#include "sim/nodes.h"
#include "sim/outline.h"
#include "sim/tangent.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

/// A bob below a trolley on a rail, on a straight chain.
Scene trolley(double speed, double tolerance) {
  Scene scene;
  scene.bodies = {body("trolley", BodyKind::rail, 0.0, 0.0, 0.1, 2.0),
                  body("bob", BodyKind::free, 0.0, -1.2, 0.1, 1.0)};
  scene.bodies[0].rail_axis = {1.0, 0.0};
  for (Body& body : scene.bodies) body.velocity = {speed, 0.0};
  scene.cables = {cable(on(0), {}, on(1), 0.011)};
  scene.cables[0].mass_per_metre = 0.5;
  scene.cables[0].nodes = 7;
  scene.cables[0].node_tolerance = tolerance;
  scene.steps_per_frame = 8;
  spread_nodes(scene);
  return scene;
}

TEST(Nodes, MoveOnWithTheirEnds) {
  for (const double tolerance : {0.0, 1e-3}) {
    const Scene moving = trolley(2.0, tolerance), standing = trolley(0.0, tolerance);
    const World start = make_world(moving, measured()), at_rest = make_world(standing, measured());
    for (std::size_t c = 0; c < moving.cables.size(); ++c) {
      EXPECT_NEAR(start.cables[c].segments[1].tension, at_rest.cables[c].segments[1].tension, 1e-9);
    }
    const World world = after(moving, 8, 1.0);
    for (std::size_t b = 0; b < moving.bodies.size(); ++b) {
      const Vec2 moved = world.position[b] - moving.bodies[b].position;
      EXPECT_NEAR((moved - Vec2(2.0, 0.0)).norm(), 0.0, 1e-9) << b << ' ' << tolerance;
    }
    for (const Body& body : standing.bodies) EXPECT_EQ(body.velocity, Vec2::Zero());
  }
}

// The end is on the rim of what turns, by itself or by a motor: chain and bob turn with it as one
// body, and with no gravity go on so.
TEST(Nodes, TurnWithWhatHoldsTheirEnds) {
  constexpr double turning = 3.0, rim = 0.3, length = 1.0;
  for (const bool driven : {false, true}) {
    Scene scene;
    scene.gravity = Vec2::Zero();
    scene.bodies = {body("axle", BodyKind::fixed_axle, 1.0, 2.0, rim, 5.0),
                    body("bob", BodyKind::free, 1.0 + rim + length, 2.0, 0.1, 1.0)};
    if (driven) {
      scene.bodies[0].driven_angular_velocity = turning;
    } else {
      scene.bodies[0].angular_velocity = turning;
    }
    scene.bodies[1].velocity = {0.0, turning * (rim + length)};
    scene.cables = {cable({0, Vec2(rim, 0.0)}, {}, on(1), 0.01)};
    scene.cables[0].mass_per_metre = 0.5;
    scene.cables[0].nodes = 4;
    scene.steps_per_frame = 8;
    spread_nodes(scene);
    for (const Body& body : scene.bodies) {
      const Vec2 v = turning * left(body.position - scene.bodies[0].position);
      if (can_move(body)) {
        EXPECT_NEAR((body.velocity - v).norm(), 0.0, 1e-14) << body.name;
      }
    }
    const World world = after(scene, 8, 0.5);
    for (std::size_t b = 1; b < scene.bodies.size(); ++b) {
      const Vec2 from = scene.bodies[b].position - scene.bodies[0].position;
      const Vec2 to = world.position[b] - world.position[0];
      EXPECT_NEAR((to - turned(from, turning * 0.5)).norm(), 0.0, 1e-4) << b << ' ' << driven;
    }
  }
}

// As on cables that run over bodies, by their share of the way along it; also where it hangs.
TEST(Nodes, StartBetweenTheVelocitiesOfTheirEnds) {
  for (const double slack : {0.0, 0.4}) {
    Scene scene;
    scene.bodies = {body("a", BodyKind::free, 0.0, 0.0, 0.1, 1.0),
                    body("rail", BodyKind::rail, 2.0, 0.0, 0.1, 1.0)};
    scene.bodies[0].velocity = {0.0, 1.0};
    scene.bodies[1].rail_axis = {0.0, 1.0};
    scene.bodies[1].velocity = {3.0, -4.0};  // of which its rail leaves it the second
    scene.cables = {cable(on(0), {}, on(1), 0.01)};
    scene.cables[0].mass_per_metre = 0.5;
    scene.cables[0].nodes = 4;
    scene.cables[0].slack = slack;
    spread_nodes(scene);
    for (int k = 1; k <= 4; ++k) {
      const Vec2& v = scene.bodies[static_cast<std::size_t>(k) + 1].velocity;
      EXPECT_NEAR((v - Vec2(0.0, 1.0 - k)).norm(), 0.0, 1e-14) << k;
    }
  }
}

}  // namespace
}  // namespace pinchlab::testing
