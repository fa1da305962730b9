// SPDX-License-Identifier: GPL-3.0-or-later
// Cables with mass and slack between two points: where they hang, one piece of them may have to
// push, or be slack.

#include "sim/hanging.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/nodes.h"
#include "sim/scene_error.h"
#include "tests/sim/random.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

/// A cable of 0.5 kg/m from (0, 0) to `end`, which stands.
Scene hung(const Vec2& end, double length, int nodes) {
  Scene scene;
  scene.cables.push_back(cable(at(0.0, 0.0), {}, at(end.x(), end.y()), 0.2 * length / (nodes + 1)));
  scene.cables[0].mass_per_metre = 0.5;
  scene.cables[0].nodes = nodes;
  scene.cables[0].slack = length - end.norm();
  return scene;
}

double length_of(const World& world) {
  double sum = 0.0;
  for (const CableState& piece : world.cables) sum += piece.segments[1].rest_length;
  return sum;
}

/// By how far a node moves at most in a second (m).
double moves_by(const Scene& scene, World& world) {
  const std::vector<Vec2> start = world.position;
  double most = 0.0;
  for (int frame = 0; frame < 60; ++frame) {
    run(scene, world, scene.steps_per_frame);
    for (std::size_t b = 0; b < start.size(); ++b)
      most = std::max(most, (world.position[b] - start[b]).norm());
  }
  return most;
}

// Two legs of 20 pieces and a piece across them that is longer than its ends' distance: it keeps
// the legs apart. Either end bears half of the weight, without its own half piece.
TEST(Hanging, APieceAcrossTwoLegsKeepsThemApart) {
  Scene scene = hung({0.02, 0.0}, 2.02, 40);
  spread_nodes(scene);
  World world = make_world(scene, measured());
  EXPECT_NEAR(length_of(world), 2.02, 1e-13);
  EXPECT_LT(moves_by(scene, world), 1e-12);
  const Segment &first = world.cables[0].segments[1], &last = world.cables[40].segments[1];
  EXPECT_NEAR(first.tension * -first.direction.y(), 0.5 * g * 0.5 * 2.02 * 40 / 41, 1e-9);
  EXPECT_NEAR(first.tension, last.tension, 1e-9);
  const Segment& middle = world.cables[20].segments[1];
  EXPECT_NEAR(middle.direction.x(), 1.0, 1e-12);
  EXPECT_LT(middle.tension, -0.01);
}

// Ends level, one above the other, to 1e-6 so and anywhere; gravity down, aslant and none.
TEST(Hanging, IsOfItsLengthAndAtRest) {
  int push = 0;
  for (unsigned seed = 0; seed < seeds_of(300U); ++seed) {
    Random random(seed);
    const int nodes = 1 + random.below(60);
    const double length = random.uniform(0.5, 3.0), piece = length / (nodes + 1);
    const double x[] = {0.0, 1e-6, random.uniform(0.0, 1.2 * piece), random.uniform(0.0, 0.7)};
    const double y[] = {0.0, random.uniform(-0.7, 0.7), random.uniform(0.0, piece) / length - 1.0};
    const Vec2 end(x[random.below(4)], length * y[random.below(3)]);
    if (end.norm() > 0.999 * length) continue;
    Scene scene = hung(end, length, nodes);
    const int gravity = random.below(8);
    if (gravity < 2) scene.gravity = gravity == 0 ? Vec2(0.0, 0.0) : Vec2(3.0, -7.0);
    spread_nodes(scene);
    World world = make_world(scene, measured());
    EXPECT_NEAR(length_of(world), length, 1e-12 * length) << seed;
    EXPECT_LT(moves_by(scene, world), 1e-9) << seed;
    push += std::ranges::any_of(world.cables,
                                [](const CableState& c) { return c.segments[1].tension < -1e-6; });
  }
  EXPECT_GT(push, seeds_of(60));
}

// Their ends are not at rest, and what bends is not; that their pieces are as long as given is all.
TEST(Hanging, IsOfItsLengthWithBendingAdaptingAndMovingEnds) {
  for (int way = 0; way < 3; ++way) {
    Scene scene = hung({0.01, -1.0}, 1.05, 7);
    Cable& hanging = scene.cables[0];
    if (way == 0) hanging.bending_stiffness = 0.01;
    if (way == 1) hanging.node_tolerance = 0.005;
    if (way == 2) {
      scene.bodies.push_back(body("weight", BodyKind::free, 0.01, -1.0, 0.02, 1.0));
      hanging.end = on(0);
    }
    spread_nodes(scene);
    EXPECT_NEAR(length_of(make_world(scene, measured())), 1.05, 1e-13) << way;
  }
}

// One of an elastic cable does not push.
TEST(Hanging, APieceOfAnElasticCableIsSlack) {
  for (const double x : {0.0, 1e-9, 0.01, 0.05}) {
    Scene scene = hung({x, -1.0}, x + 1.05, 10);
    scene.cables[0].axial_stiffness = 1e6;
    spread_nodes(scene);
    World world = make_world(scene, measured());
    EXPECT_NEAR(length_of(world), x + 1.05, 1e-12) << x;
    int slack = 0;
    for (const CableState& piece : world.cables) {
      const Segment& s = piece.segments[1];
      slack += s.length < 0.9 * s.rest_length;
      EXPECT_LT(s.length, s.rest_length + 1e-12) << x;
    }
    EXPECT_EQ(slack, 1) << x;
    EXPECT_LT(moves_by(scene, world), 1e-5) << x;  // by T l / EA
  }
}

// Two rods that are 1e-9 m apart where they are held, and not level, stand out to the side by
// couples of 1e9 times their weight.
TEST(Hanging, WhatFindsNoRestIsRefused) {
  Scene scene = hung({3e-10, 5e-10}, 0.8, 1);
  try {
    spread_nodes(scene);
    ADD_FAILURE();
  } catch (const SceneError& error) {
    EXPECT_EQ(error.place, "/cables/0");
    EXPECT_NE(std::string(error.what()).find("move them apart"), std::string::npos);
  }
}

}  // namespace
}  // namespace pinchlab::testing
