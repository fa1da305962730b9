// SPDX-License-Identifier: GPL-3.0-or-later
// Cables with mass whose number of nodes adapts.

#include "sim/motion/adapt_nodes.h"

#include <cmath>

#include "base/at.h"
#include "demos/scenes/shape_scenes.h"
#include "sim/cable/cable.h"
#include "sim/cable/held.h"
#include "sim/diagnostics.h"
#include "sim/tangent.h"
#include "sim/workspace.h"
#include "tests/sim/random_hanging.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

int pieces_of(const World& world) {
  int count = 0;
  for (const CableState& cable : world.cables) count += cable.rod && !is_dormant(cable) ? 1 : 0;
  return count;
}

/// Of all that moves, first moments with it.
struct Whole {
  double mass = 0.0, length = 0.0;                       // kg, m of material
  Vec2 moment = Vec2::Zero(), momentum = Vec2::Zero();   // kg m, kg m/s
  double angular = 0.0, kinetic = 0.0, potential = 0.0;  // kg m^2/s, J, J
};

Whole measure(const Scene& scene, const World& world) {
  Whole all;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    if (!can_move(world.bodies[b])) continue;
    const double m = world.bodies[b].mass;
    all.mass += m;
    all.moment += m * world.position[b];
    all.momentum += m * world.velocity[b];
    all.angular += m * cross(world.position[b], world.velocity[b]);
  }
  for (const CableState& cable : world.cables) {
    if (!is_dormant(cable)) all.moment += first_moment(cable);
    all.length += cable.pieces * scene.chains[0].piece_length;
  }
  all.kinetic = kinetic_energy(world);
  all.potential = potential_energy(scene, world);
  return all;
}

/// Two free bodies with a cable between them, in the air.
Scene flying_chain(double slack, double tolerance) {
  Scene scene;
  scene.bodies.push_back(body("left", BodyKind::free, 0.0, 0.0, 0.01, 0.4));
  scene.bodies.push_back(body("right", BodyKind::free, 1.0, 0.1, 0.01, 0.7));
  for (Body& b : scene.bodies) b.node = true;
  scene.cables.push_back(cable(on(0), {}, on(1), 0.002));
  scene.cables[0].slack = slack;
  scene.cables[0].mass_per_metre = 0.5;
  scene.cables[0].nodes = 31;
  scene.cables[0].node_tolerance = tolerance;
  spread_nodes(scene);
  scene.steps_per_frame = 32;
  scene.bodies[0].velocity = {0.3, 1.0};
  scene.bodies[1].velocity = {-0.2, 1.4};
  return scene;
}

void expect_kept(const Whole& before, const Whole& after, double share) {
  constexpr double exact = 1e-11;  // m: to that pieces have their lengths, some metres off
  EXPECT_NEAR(after.mass, before.mass, 1e-14 * before.mass);
  EXPECT_LT((after.moment - before.moment).norm(), exact * before.mass);
  EXPECT_LT((after.momentum - before.momentum).norm(), 1e-13);
  EXPECT_NEAR(after.length, before.length, 1e-14);
  EXPECT_NEAR(after.potential, before.potential, exact * before.mass * g);
  EXPECT_LE(after.kinetic, before.kinetic * (1.0 + 1e-15));
  EXPECT_GT(after.kinetic, share * before.kinetic);
}

// Each change, before an impact fits velocities to it and after: mass, centre and momentum stay, no
// cable is lost, and no energy comes from it.
TEST(AdaptNodes, EachChangeKeepsWhatItMust) {
  Scene scene = flying_chain(0.2, 2e-3);
  World world = make_world(scene, measured());
  Workspace work;
  int splits = 0, merges = 0;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    if (i % 50 != 49) continue;
    for (const double factor : {0.05, 0.3, 5.0, 50.0}) {
      Scene other = scene;
      other.chains[0].tolerance *= factor;
      World changed = world;
      Workspace own;
      find_parts(changed, own);
      const Whole before = measure(other, changed);
      const int pieces = pieces_of(changed);
      if (!wants_other_nodes(other, changed, own)) continue;
      change_nodes(other, changed, own);
      (pieces_of(changed) > pieces ? splits : merges) += 1;
      expect_kept(before, measure(other, changed), 0.9);
    }
  }
  EXPECT_GT(splits, 5);
  EXPECT_GT(merges, 5);
  const Whole start = measure(scene, make_world(scene, measured()));
  EXPECT_NEAR(measure(scene, world).mass, start.mass, 1e-13);
  EXPECT_NEAR(measure(scene, world).momentum.x(), start.momentum.x(), 1e-12);
}

// A straight cable that turns: where pieces become one the angular momentum stays, and what that
// takes of the energy is lost; where one becomes two its motion stays.
TEST(AdaptNodes, MergingKeepsAngularMomentum) {
  Scene scene = flying_chain(0.0, 2e-2);
  for (Body& b : scene.bodies) b.velocity = 0.3 * left(b.position - Vec2(0.5, 0.05));
  World world = make_world(scene, measured());
  Workspace work;
  find_parts(world, work);
  int before_pieces = pieces_of(world);
  while (wants_other_nodes(scene, world, work)) {
    const Whole before = measure(scene, world);
    change_nodes(scene, world, work);
    const Whole after = measure(scene, world);
    ASSERT_LT(pieces_of(world), before_pieces);
    before_pieces = pieces_of(world);
    expect_kept(before, after, 0.5);
    EXPECT_NEAR(after.angular, before.angular, 1e-14);
  }
  EXPECT_EQ(before_pieces, 2);  // which do not pull enough to be one
  scene.chains[0].tolerance = 1e-6;
  const Vec2 end = world.velocity[1];
  const Whole before = measure(scene, world);
  change_nodes(scene, world, work);
  EXPECT_EQ(pieces_of(world), 32);
  expect_kept(before, measure(scene, world), 0.5);
  EXPECT_EQ(world.velocity[1], end);
}

// No change makes energy, and what there is does not rise by more than leapfrog's own swing.
TEST(AdaptNodes, EnergyDoesNotRise) {
  for (const int steps : {32, 64, 128}) {
    for (int seed = 0; seed < seeds_of(200); ++seed) {
      if (steps == 128 && seed % 4 != 0) continue;
      Scene scene = random_hanging(seed);
      scene.steps_per_frame = steps;
      World world = make_world(scene, measured());
      Workspace work;
      double first = 0.0, most = 0.0, at_play = 0.0, losses = 0.0;
      for (int i = 0; i < 60 * steps; ++i) {
        ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
        const Diagnostics& d = world.diagnostics;
        if (i == 0) first = d.energy;
        most = std::max(most, d.energy - first);
        at_play = std::max(at_play, kinetic_energy(world));
        ASSERT_GE(d.node_losses, losses - 1e-13) << seed;
        losses = d.node_losses;
        ASSERT_LT(d.largest_stretch, 1e-6) << seed;
      }
      EXPECT_LT(most, (steps > 32 ? 1e-3 : 2e-2) * at_play) << seed << " at " << steps;
    }
  }
}

// At rest pieces that hold their bends hang as their nodes did: sag 0.7963884, tension 1.0260286
// rho g.
TEST(AdaptNodes, ACatenaryHangsAsItHung) {
  for (const double tolerance : {5e-4, 2e-3, 1e-2}) {
    Scene scene = build::catenary(0, 4);
    scene.cables[0].nodes = 127;
    scene.cables[0].node_tolerance = tolerance;
    spread_nodes(scene);
    World world = make_world(scene, measured());
    const std::vector<Vec2> start = world.position;
    run(scene, world, 240);
    EXPECT_LT(pieces_of(world), 120);
    double sag = 0.0;
    for (std::size_t b = 0; b < start.size(); ++b) {
      EXPECT_LT((world.position[b] - start[b]).norm(), 1e-9);
      sag = std::max(sag, -world.position[b].y());
    }
    EXPECT_NEAR(sag, 0.7963884, 1e-4);
    EXPECT_LE(world.diagnostics.node_changes, 127);
    EXPECT_LT(world.diagnostics.node_losses, 1e-15);
  }
}

TEST(AdaptNodes, DrawnTautItIsOnePieceAndReleasedItHangsAgain) {
  Scene scene = build::drawn_taut(31, 4, 2e-3);
  // With a sixth of this drag it still swings by 1 cm then, from the jerk that pulls it taut.
  for (Body& body : scene.bodies) {
    if (body.node) body.linear_drag = 5.0;
  }
  World world = make_world(scene, measured());
  Workspace work;
  int fewest = 99;
  while (world.time() < 2.6) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    fewest = std::min(fewest, pieces_of(world));
  }
  EXPECT_EQ(fewest, 1);
  EXPECT_EQ(pieces_of(world), 1);
  const CableState& cable = world.cables[0];
  EXPECT_EQ(cable.pieces, 32);
  EXPECT_NEAR(cable.length, 1.25, 3e-6);  // the exact straight span, but for a bend of 1 mm let out
  EXPECT_NEAR(cable.segments[1].tension, world.cables[1].segments[1].tension, 2.0);  // of 1960
  EXPECT_NEAR(world.position[0].norm(), 1.25, 3e-6);
  EXPECT_NEAR(world.bodies[0].mass, 0.2 + 0.5, 1e-13);
  const std::int64_t taut = world.diagnostics.node_changes;
  while (world.time() < 5.0) ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  EXPECT_GT(pieces_of(world), 8);
  EXPECT_GT(world.position[0].y(), -0.6);
  EXPECT_LT(world.position[0].y(), -0.4);
  EXPECT_LT(world.diagnostics.node_changes - taut, 200);
  EXPECT_EQ(world.diagnostics.fallbacks, 0);
}

// A bob on a straight cable moves as on one without mass whose half the bob bears: from rest, in as
// many steps as it has levels.
TEST(AdaptNodes, AStraightSpanMovesAsOneWithoutNodes) {
  Scene scene;
  scene.steps_per_frame = 16;
  scene.bodies.push_back(body("bob", BodyKind::free, std::sin(0.05), -std::cos(0.05), 0.002, 2.0));
  scene.bodies[0].node = true;
  scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0), 0.001));
  Scene nodes = scene;
  nodes.cables[0].mass_per_metre = 1.0;
  nodes.cables[0].nodes = 31;
  nodes.cables[0].node_tolerance = 1e-2;
  spread_nodes(nodes);
  scene.bodies[0].mass = 2.5;
  World world = make_world(nodes, Method::pinch), span = make_world(scene, Method::pinch);
  Workspace work, span_work;
  for (int i = 0; i < 60 * 16 * 3; ++i) {
    ASSERT_EQ(step(nodes, world, work), StepStatus::ok);
    ASSERT_EQ(step(scene, span, span_work), StepStatus::ok);
    EXPECT_LT((world.position[0] - span.position[0]).norm(), 4e-6);
    if (i < 8) continue;
    ASSERT_EQ(pieces_of(world), 1);
    EXPECT_NEAR(world.cables[0].segments[1].tension, span.cables[0].segments[1].tension, 1e-3);
  }
}

// Where pieces become one, their ends' motion is changed for what is lost with the nodes: on a rail
// only along it. Else the cart would leave the rail for good.
TEST(AdaptNodes, ACartThatHoldsTheRopeStaysOnItsRail) {
  Scene scene;
  scene.steps_per_frame = 16;
  scene.bodies.push_back(body("cart", BodyKind::rail, 0.6, 0.0, 0.05, 0.5));
  scene.bodies[0].rail_axis = {1.0, 0.0};
  scene.bodies[0].velocity = {1.0, 0.0};
  scene.cables.push_back(cable(at(0.0, 0.3), {}, on(0), 0.005));
  Cable& rope = scene.cables[0];
  rope.slack = 0.3;
  rope.mass_per_metre = 0.5;
  rope.nodes = 31;
  rope.node_tolerance = 0.01;
  rope.linear_drag = 1.0;
  spread_nodes(scene);
  World world = make_world(scene, measured());
  Workspace work;
  for (int i = 0; i < 60 * 16 * 2; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    ASSERT_LT(std::abs(world.position[0].y()), 1e-12) << i;
  }
  EXPECT_GT(world.diagnostics.node_changes, 20);
}

// Few nodes but at the bight: in the time of the finest, within a hundredth, with less than half of
// its pieces.
TEST(AdaptNodes, AFoldedChainFallsAsTheFinest) {
  constexpr int pieces = 128, steps = 64;
  double times[2] = {};
  double mean = 0.0;
  for (const double tolerance : {1e-12, 2e-3}) {
    const Scene scene = build::folded_chain(pieces, steps, tolerance);
    World world = make_world(scene, measured());
    Workspace work;
    double first = 0.0, sum = 0.0;
    for (int i = 0; world.step == 0 || world.velocity[0].y() < 0.0; ++i) {
      ASSERT_LT(i, steps * 60);
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      if (i == 0) first = world.diagnostics.energy;
      EXPECT_LT(world.diagnostics.energy - first, 1e-5);
      sum += pieces_of(world);
    }
    times[tolerance > 1e-6 ? 1 : 0] = world.time();
    mean = sum / static_cast<double>(world.step);
  }
  EXPECT_NEAR(times[1], times[0], 0.01 * times[0]);
  EXPECT_LT(mean, 0.5 * pieces);
}

// What lands on a straight cable meets nodes, and what falls on to a floor lies on it with them.
TEST(AdaptNodes, WhatIsNearMeetsNodes) {
  Scene scene;
  scene.steps_per_frame = 16;
  scene.bodies.push_back(body("ring", BodyKind::free, 1.0, 0.0, 0.01, 0.2));
  scene.bodies[0].node = true;
  scene.bodies.push_back(body("post", BodyKind::fixed_axle, 1.4, -0.1, 0.1));
  scene.bodies.push_back(body("weight", BodyKind::free, 1.503, -0.6, 0.05, 8.0));
  scene.bodies.push_back(body("ball", BodyKind::free, 0.5, 0.5, 0.1, 0.3));
  Cable hanging = cable(at(0.0, 0.0), {}, on(0), 0.003);
  hanging.mass_per_metre = 0.5;
  hanging.nodes = 31;
  hanging.node_tolerance = 4e-3;
  scene.cables = {hanging, cable(on(0), {{1, -1, 0}}, on(2), 0.003)};
  spread_nodes(scene);
  World world = make_world(scene, measured());
  Workspace work;
  int fewest = 99;
  bool touched = false;
  while (world.time() < 0.5) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    fewest = std::min(fewest, pieces_of(world));
    EXPECT_LT(world.diagnostics.largest_gap_violation, 1e-6);
    for (const Contact& contact : world.contacts) {
      touched = touched || (contact.touching && contact.a == 3);
      EXPECT_TRUE(world.bodies[index(contact.a)].outlined);
    }
    for (std::size_t b = 4; b < world.bodies.size(); ++b) {
      const double apart = (world.position[b] - world.position[3]).norm();
      EXPECT_GT(apart, 0.103 - 1e-6) << world.bodies[b].outlined;
    }
  }
  EXPECT_LT(fewest, 8);
  EXPECT_TRUE(touched);
}

TEST(AdaptNodes, StateIsAllInTheWorld) {
  for (const int seed : {1, 2, 3}) {
    const Scene scene = random_hanging(seed);
    EXPECT_TRUE(is_all_state(scene, Method::pinch, 1000)) << seed;
    World world = make_world(scene, Method::pinch);
    run(scene, world, 1000);
    EXPECT_GT(world.diagnostics.node_changes, 0);
  }
  EXPECT_TRUE(is_all_state(build::drawn_taut(31, 4, 2e-3), Method::pinch, 800));
}

// Where events are not located pieces pull only, and stay as they are.
TEST(AdaptNodes, OtherMethodsHaveTheMost) {
  const Scene scene = random_hanging(1);
  World world = make_world(scene, thesis_configuration());
  run(scene, world, 200);
  EXPECT_EQ(pieces_of(world), 32);
}

TEST(AdaptNodes, RefuseWhatDoesNotAdapt) {
  const auto refusal = [](auto change) -> std::string {
    Scene scene = build::catenary(0, 1);
    scene.bodies.push_back(body("wheel", BodyKind::free, 2.0, 0.0, 0.1));
    scene.cables[0].node_tolerance = 1e-3;
    change(scene);
    return message_of<SceneError>([&scene] { spread_nodes(scene); });
  };
  EXPECT_EQ(refusal([](Scene&) {}), "");
  EXPECT_EQ(refusal([](Scene& s) { s.cables[0].end = on(0); }), "");
  const std::string count = refusal([](Scene& s) { s.cables[0].nodes = 20; });
  EXPECT_NE(count.find("15 or 31, not 20"), std::string::npos) << count;
  EXPECT_NE(refusal([](Scene& s) { s.cables[0].axial_stiffness = 1e3; }).find("neither stretch"),
            std::string::npos);
  EXPECT_NE(refusal([](Scene& s) { s.gravity.setZero(); }).find("gravity"), std::string::npos);
  const std::string end = refusal([](Scene& s) {
    s.cables[0].end = on(0);
    s.cables[0].end.point = {0.1, 0.0};
  });
  EXPECT_NE(end.find("/end: "), std::string::npos) << end;
  EXPECT_NE(refusal([](Scene& s) { s.cables[0].node_tolerance = -1.0; }).find("above 0"),
            std::string::npos);
}

}  // namespace
}  // namespace pinchlab::testing
