// SPDX-License-Identifier: GPL-3.0-or-later
// How rims take in the nodes of cables with mass.

#include "sim/cable/taking_in.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "demos/scenes/shape_scenes.h"
#include "sim/cable/cable.h"
#include "sim/cable/mass.h"
#include "sim/cable/strung.h"
#include "sim/make_world.h"
#include "sim/motion/neighbourhoods.h"
#include "sim/nodes.h"
#include "sim/step.h"
#include "sim/tangent.h"
#include "sim/workspace.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using std::numbers::pi;

// What hangs may have turned by whole turns about a node: then what follows has turned as often,
// and when the node goes nothing that lies on a body may change by that.
TEST(TakingIn, WholeTurnsAboutANodeWindNothingUp) {
  const Scene scene = build::sagging_hoist(40, 4);
  World world = make_world(scene, measured());
  CableState& rope = world.cables[0];
  int node = 0;
  while (rope.links[static_cast<std::size_t>(node)].body != 2) ++node;
  ++node;  // the first on the free span
  World turned = world;
  CableState& other = turned.cables[0];
  for (std::size_t i = static_cast<std::size_t>(node) + 1; i < other.links.size(); ++i) {
    other.segments[i].alpha += 2.0 * pi;
    other.links[i].material -= other.links[i].signed_radius() * 2.0 * pi;
  }
  update_wraps_and_rest_lengths(turned, other);
  take_in_node(world, rope, node);
  take_in_node(turned, other, node);
  ASSERT_EQ(rope.links.size(), other.links.size());
  for (std::size_t i = 0; i < rope.links.size(); ++i) {
    EXPECT_NEAR(rope.links[i].wrap, other.links[i].wrap, 1e-12);
    EXPECT_NEAR(rope.segments[i].rest_length, other.segments[i].rest_length, 1e-12);
  }
}

/// A rope on a disc between two others, all free, which the disc draws on; from either end.
Scene drawn_by_a_disc(bool other_end) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  scene.bodies = {body("a", BodyKind::free, -0.8, 0.0, 0.2, 1.0),
                  body("b", BodyKind::free, 0.8, 0.1, 0.3, 2.0),
                  body("disc", BodyKind::free, 0.0, 0.8, 0.25, 1.5)};
  scene.bodies[2].velocity = {0.0, 1.0};
  Attachment a = on(0), b = on(1);
  a.point = {0.0, 0.2};
  b.point = {0.0, 0.3};
  scene.cables.push_back(other_end ? cable(b, {{2, 1, 0}}, a, 0.01)
                                   : cable(a, {{2, -1, 0}}, b, 0.01));
  scene.cables[0].mass_per_metre = 0.4;
  scene.cables[0].nodes = 9;
  scene.steps_per_frame = 16;
  spread_nodes(scene);
  return scene;
}

// Where the rope folds back on the disc about a node, it has more than lies there when the node is
// taken in. That is slack on both sides alike, whichever end of the rope is called its start.
TEST(TakingIn, WhatFoldsBackGivesToBothSides) {
  const Scene scene = drawn_by_a_disc(false), other = drawn_by_a_disc(true);
  World world = make_world(scene, measured()), reversed = make_world(other, measured());
  run(scene, world, 900);
  run(other, reversed, 900);
  const int first = world.cables[0].first_node, nodes = world.cables[0].nodes;
  for (int k = 0; k < nodes; ++k) {
    const Vec2 apart = pinchlab::at(world.position, first + k) -
                       pinchlab::at(reversed.position, first + nodes - 1 - k);
    EXPECT_LT(apart.norm(), 1e-9) << k;
  }
}

/// The rope of a hoist that has begun to sag, and the first node on its free span, beside the
/// pulley that is body 2.
struct BesidePulley {
  Scene scene = build::sagging_hoist(40, 4);
  World world = make_world(scene, measured());
  Workspace work;
  int node = 0;

  BesidePulley() {
    for (int i = 0; i < 40; ++i) EXPECT_EQ(step(scene, world, work), StepStatus::ok);
    while (pinchlab::at(rope().links, node).body != 2) ++node;
    ++node;
  }
  CableState& rope() { return world.cables[0]; }
};

/// The same with the pulley turned by so much (rad), all else where it is.
BesidePulley turned_by(BesidePulley other, double angle) {
  other.world.angle[2] += angle;
  update_cable(other.world, other.rope(), false, false);
  return other;
}

double bend_at(const CableState& rope, int link) {
  return alpha_head(rope, static_cast<std::size_t>(link)) - pinchlab::at(rope.segments, link).alpha;
}

// A rim that takes hold of a node moves nothing; the node turns with it, until the span beyond is a
// tangent of the rim: there the rope weighs the same with the node and without it. Cast off it goes
// on from where it has come to, as fast as the rim.
TEST(TakingIn, ARimTakesNodesInWithoutLiftingThem) {
  const Vec2 gravity(0.0, -9.81);
  BesidePulley held;
  const auto weight = [&gravity](const World& world) {
    return potential_energy(world, world.cables[0], gravity);
  };
  const double before = weight(held.world);
  const Vec2 place =
      held.world
          .position[static_cast<std::size_t>(pinchlab::at(held.rope().links, held.node).body)];
  ASSERT_TRUE(is_to_be_moored(held.rope(), held.node));
  BesidePulley lifted = held;
  moor_node(held.world, held.rope(), held.node);
  EXPECT_NEAR(weight(held.world), before, 1e-13 * std::abs(before));
  const double bent = bend_at(held.rope(), held.node);
  EXPECT_GT(std::abs(bent), 1e-3);
  take_in_node(lifted.world, lifted.rope(), lifted.node);
  EXPECT_GT(weight(lifted.world) - before, 1e-6 * std::abs(before));

  // The arm turns with the pulley: towards the span beyond by as much.
  double low = 0.0, high = 2.0 * bent;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    const double left_over = bend_at(turned_by(held, middle).rope(), held.node);
    (left_over * bent > 0.0 ? low : high) = middle;
  }
  BesidePulley in_line = turned_by(held, low);
  {  // the span beyond as long as its cable again
    const Segment& span = pinchlab::at(in_line.rope().segments, in_line.node + 1);
    const int next = pinchlab::at(in_line.rope().links, in_line.node + 1).body;
    pinchlab::at(in_line.world.position, next) = span.tail + span.rest_length * span.direction;
    update_cable(in_line.world, in_line.rope(), false, false);
  }
  const double heavy = weight(in_line.world);
  const std::size_t links = in_line.rope().links.size();
  take_in_node(in_line.world, in_line.rope(), in_line.node);
  EXPECT_EQ(in_line.rope().links.size() + 1, links);
  EXPECT_NEAR(weight(in_line.world), heavy, 1e-13 * std::abs(heavy));

  BesidePulley back = turned_by(held, -0.25 * bent);
  back.world.angular_velocity[2] = 3.0;
  const Link& link = pinchlab::at(back.rope().links, back.node);
  const Vec2 now = link_centre(back.world, link), from_axle = now - back.world.position[2];
  EXPECT_GT((now - place).norm(), 1e-5);
  cast_off_node(back.world, back.rope(), back.node);
  ASSERT_TRUE(is_strung(back.rope(), link));
  const auto node = static_cast<std::size_t>(link.body);
  EXPECT_NEAR((back.world.position[node] - now).norm(), 0.0, 1e-15);
  EXPECT_NEAR((back.world.velocity[node] - 3.0 * pinchlab::left(from_axle)).norm(), 0.0, 1e-13);
}

// As where two neighbourhoods of a divided step come together after all (neighbourhoods.h).
TEST(TakingIn, AStepThatIsTakenBackPutsNodesBack) {
  BesidePulley now;
  const World before = now.world;
  keep_start(now.world, now.work);
  moor_node(now.world, now.rope(), now.node);
  take_in_node(now.world, now.rope(), now.node + 3);
  take_back(now.world, now.work);
  ASSERT_EQ(now.rope().links.size(), before.cables[0].links.size());
  for (std::size_t b = 0; b < before.bodies.size(); ++b) {
    EXPECT_EQ(now.world.bodies[b].kind, before.bodies[b].kind) << b;
    EXPECT_EQ(now.world.bodies[b].outlined, before.bodies[b].outlined) << b;
  }
  EXPECT_EQ(step(now.scene, now.world, now.work), StepStatus::ok) << now.world.failure;
}

}  // namespace
}  // namespace pinchlab::testing
