// SPDX-License-Identifier: GPL-3.0-or-later
// Ropes that hang by nodes: how they start, and the bodies that hold their ends.

#include "base/at.h"
#include "demos/scenes/shape_scenes.h"
#include "sim/cable/cable.h"
#include "sim/cable/held_spans.h"
#include "sim/cable/strung.h"
#include "sim/detect/contacts.h"
#include "sim/detect/detect.h"
#include "sim/nodes.h"
#include "sim/outline.h"
#include "sim/tangent.h"
#include "sim/workspace.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using Polygon = std::vector<Vec2>;
const Polygon square = {{-0.2, -0.2}, {0.2, -0.2}, {0.2, 0.2}, {-0.2, 0.2}};
const Polygon pentagon = {{0.3, 0.0},
                          {0.0927051, 0.2853170},
                          {-0.2427051, 0.1763356},
                          {-0.2427051, -0.1763356},
                          {0.0927051, -0.2853170}};
const Polygon hexagon = {{0.3, 0.0},  {0.15, 0.2598},   {-0.15, 0.2598},
                         {-0.3, 0.0}, {-0.15, -0.2598}, {0.15, -0.2598}};

Attachment on_rim(int body, double x) {
  Attachment end = on(body);
  end.point = {x, 0.0};
  return end;
}

/// Two discs on a slack rope over a smooth beam.
Scene over_beam(const Polygon& outline, const Body& left, const Body& right, double density,
                double slack) {
  Scene scene;
  Body beam = body("beam", BodyKind::fixed, 0.0, 0.0, 0.1, 1.0);
  make_polygon(beam, outline, 0.0);
  beam.cable_friction = 0.0;
  scene.bodies = {beam, left, right};
  Cable rope = cable(on(1), {{0, -1, 0}}, on(2), 0.02);
  rope.mass_per_metre = density;
  rope.nodes = automatic_nodes;
  rope.slack = slack;
  scene.cables.push_back(rope);
  return scene;
}

Scene pentagon_scene(double stiffness) {
  Scene scene = over_beam(pentagon, body("a", BodyKind::free, -1.735, 0.867, 0.11, 0.25),
                          body("b", BodyKind::free, 1.0426, -0.1057, 0.17, 0.75), 0.034, 0.5);
  scene.cables[0].axial_stiffness = stiffness;
  spread_nodes(scene);
  return scene;
}

// The discs come down on rope that their own ends hold. Rims that took in all nodes up to an end
// within them gave out cable from nothing, which threw discs up with four times all energy.
TEST(StrungEnds, NoRopeIsMadeWhereItComesDownOnItsOwnLoads) {
  for (const auto& [mass, x, slack] : {std::tuple{1.0, 0.5, 0.4}, {0.5, 0.8, 0.2}}) {
    Scene scene = over_beam(square, body("a", BodyKind::free, -x, 0.0, 0.1, mass),
                            body("b", BodyKind::free, x, -0.8, 0.1, 2.0), 0.3, slack);
    scene.walls.push_back({Vec2(-3.0, -2.0), Vec2(3.0, -2.0), 0.0, 0.0});
    spread_nodes(scene);
    World world = make_world(scene, measured());
    const CableState& rope = world.cables[0];
    Workspace work;
    double last = infinity;
    for (int i = 0; i < 480; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      for (std::size_t s = first_segment(rope); s < rope.segments.size(); ++s) {
        ASSERT_GE(rope.segments[s].rest_length, -1e-9) << "step " << i << ", segment " << s;
      }
      ASSERT_LE(world.diagnostics.energy, last + 0.3) << i;  // of 30 J and more
      last = world.diagnostics.energy;
    }
  }
}

// A disc rolls over the rope that holds its centre, which is in front of it. It was pressed off by
// the rope's width, in one step, when it came over where the rope lies on the hexagon: 0.6 J.
TEST(StrungEnds, RopeIsNotPinchedByWhatItIsInFrontOf) {
  Scene scene =
      over_beam(hexagon, body("a", BodyKind::free, -1.6105, -0.43674, 0.18903, 0.12),
                body("b", BodyKind::free, 0.87724, -0.33069, 0.17031, 0.45424), 0.065057, 0.5);
  scene.bodies[0].kind = BodyKind::fixed_axle;
  scene.cables[0].nodes = 12;
  scene.cables[0].axial_stiffness = 4443.6;
  scene.steps_per_frame = 16;
  spread_nodes(scene);
  World world = make_world(scene, measured());
  Workspace work;
  double last = infinity;
  bool touched = false;
  for (int i = 0; i < 960; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    for (const Contact& contact : world.contacts) {
      if (contact.a != 0 || contact.b < 1 || contact.b > 2) continue;
      touched |= contact.touching;
      EXPECT_EQ(contact.target, 0.0) << i;
    }
    ASSERT_LE(world.diagnostics.energy, last + 0.06) << i << ", of 4.2 J";
    last = world.diagnostics.energy;
  }
  EXPECT_TRUE(touched);
}

// Sides on to which the rope sags are laid on where nothing pulls. They had the strain of the
// straight rope, 14 %: 27 J, which were let go a quarter of a second later.
TEST(StrungEnds, SidesThatRopeSagsOnAreNotStretched) {
  const Scene scene = pentagon_scene(3000.0);
  World world = make_world(scene, measured());
  const CableState& rope = world.cables[0];
  int sides = 0;
  for (std::size_t s = first_segment(rope); s < rope.segments.size(); ++s) {
    if (!is_side(rope.links[s - 1], rope.links[s])) continue;
    ++sides;
    EXPECT_NEAR(rope.segments[s].rest_length, rope.segments[s].length, 1e-3) << s;
  }
  EXPECT_GE(sides, 1);
  const Extremes most = play(scene, world, 0.5);
  EXPECT_LT(most.energy_gain, 0.5) << "of 14 J";
}

// From a corner that the sagging rope was laid on it was lifted off, and laid on again, until no
// turns were left: half of it was a straight row of slack pieces.
TEST(StrungEnds, WhatIsLaidOnACornerStillHangs) {
  const World world = make_world(pentagon_scene(infinity), Method::pinch);
  const CableState& rope = world.cables[0];
  for (std::size_t s = first_segment(rope); s < rope.segments.size(); ++s) {
    EXPECT_NEAR(rope.segments[s].rest_length, rope.segments[s].length, 1e-3) << s;
  }
}

// A straight rope whose weight no tension bears is refused, also where its end is the centre of
// what only turns, and where the number of nodes is to be chosen.
TEST(StrungEnds, WhatCannotHangIsRefused) {
  const auto refusal = [](const Attachment& start, int nodes) {
    Scene scene;
    Body post = body("post", BodyKind::fixed, 0.0, 0.0, 0.1, 1.0);
    post.cable_friction = 0.0;
    scene.bodies = {post, body("wheel", BodyKind::fixed_axle, -2.0, -1.0, 0.2, 1.0)};
    Cable rope = cable(start, {{0, -1, 0}}, at(2.0, -1.0), 0.02);
    rope.mass_per_metre = 0.1;
    rope.nodes = nodes;
    scene.cables.push_back(rope);
    return message_of<SceneError>([&] {
      spread_nodes(scene);
      make_world(scene, Method::pinch);
    });
  };
  for (const Attachment& start : {at(-1.7, -1.0), on(1)}) {
    for (const int nodes : {10, automatic_nodes}) {
      EXPECT_NE(refusal(start, nodes).find("no tension bears its weight"), std::string::npos)
          << nodes << " " << refusal(start, nodes);
    }
  }
  EXPECT_EQ(refusal(on_rim(1, 0.1), 10), "") << "the wheel turns";
}

// What a span holds moves with it, at the time of the positions too.
TEST(StrungEnds, VelocitiesOfHeldNodesAreThoseOfTheirSpan) {
  Scene scene = build::crane(40, 4, 2e-3);
  spread_nodes(scene);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  int held = 0;
  for (int i = 0; i < 600; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    if (i % 50 != 49) continue;
    const Velocities now = velocities_now(scene, world, work);
    for (const int c : world.strung) {
      const CableState& rope = pinchlab::at(world.cables, c);
      for (std::size_t s = first_segment(rope); s < rope.segments.size(); ++s) {
        if (!is_held(rope, s)) continue;
        const int before = rope.links[s - 1].body;
        const Vec2 from = pinchlab::at(now.linear, before);
        const Vec2 to = pinchlab::at(now.linear, rope.links[s].body);
        const Vec2 tail = rope.segments[s].tail, line = rope.segments[s].head - tail;
        const double turning = cross(line, to - from) / line.squaredNorm();
        for (int k = 1; k < held_at(rope, s).pieces; ++k, ++held) {
          const Vec2 there = from + turning * left(Vec2(place_of_held(rope, s, k) - tail));
          EXPECT_LT((there - pinchlab::at(now.linear, before + k)).norm(), 1e-12);
        }
      }
    }
  }
  EXPECT_GT(held, 100);
}

// A node that a drum has just given off has the contacts that it would have if they were found by
// themselves.
TEST(StrungEnds, NodesThatHaveJustComeMeetWalls) {
  Scene scene;
  scene.gravity = {3.0, -9.81};
  scene.bodies = {body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.5, 10.0),
                  body("load", BodyKind::free, 0.52, -2.0, 0.02, 0.2)};
  scene.bodies[0].driven_angular_velocity = -4.0;
  Cable rope = cable(on_rim(0, -0.52), {{0, -1, 2}}, on(1), 0.02);
  rope.mass_per_metre = 1.0;
  rope.nodes = 30;
  scene.cables.push_back(rope);
  scene.walls.push_back({Vec2(0.543, -6.0), Vec2(0.543, 0.5), 0.0, 0.0});
  spread_nodes(scene);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  for (int i = 0; i < 240; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    World anew = world;
    Workspace fresh;
    fit(anew, fresh);
    find_pairs(scene, anew, fresh);
    find_contacts(scene, anew, fresh);
    EXPECT_EQ(anew.contacts.size(), world.contacts.size()) << i;
  }
  EXPECT_GT(world.diagnostics.node_changes, 5);
}

}  // namespace
}  // namespace pinchlab::testing
