// SPDX-License-Identifier: GPL-3.0-or-later
// Cables with mass that run over bodies, whose number of nodes adapts.

#include "sim/motion/adapt_spans.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "demos/scenes/shape_scenes.h"
#include "sim/cable/cable.h"
#include "sim/cable/held_spans.h"
#include "sim/cable/mass.h"
#include "sim/diagnostics.h"
#include "sim/motion/piece_line.h"
#include "sim/nodes.h"
#include "sim/tangent.h"
#include "tests/sim/course.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

int live_nodes(const World& world) {
  const CableState& cable = world.cables[0];
  return static_cast<int>(
      std::count_if(cable.links.begin(), cable.links.end(),
                    [&cable](const Link& link) { return is_strung(cable, link); }));
}

/// A rope between two drums that stand 4 m apart, to whose rims it is fastened.
Scene between_drums(double slack, int nodes, double tolerance) {
  Scene scene;
  scene.steps_per_frame = 4;
  const double radius = 0.3, half_width = 0.02, rim = radius + half_width;
  scene.bodies.push_back(body("left", BodyKind::fixed, -2.0, 0.0, radius));
  scene.bodies.push_back(body("right", BodyKind::fixed, 2.0, 0.0, radius));
  scene.cables.push_back(cable(Attachment{0, {-rim, 0.0}}, {{0, -1, 0}, {1, -1, 0}},
                               Attachment{1, {rim, 0.0}}, half_width));
  Cable& rope = scene.cables[0];
  rope.slack = slack;
  rope.mass_per_metre = 1.5;
  rope.nodes = nodes;
  rope.node_tolerance = tolerance;
  spread_nodes(scene);
  return scene;
}

/// build::sagging_hoist, its number of nodes adapting.
Scene adapting_hoist(int nodes, int steps, double tolerance) {
  Scene scene = build::sagging_hoist(nodes, steps);
  scene.cables[0].node_tolerance = tolerance;
  return scene;
}

// What is at rest stays as it hangs, to the node, whatever becomes one.
TEST(AdaptSpans, AtRestHangsAsItHung) {
  const Scene finest = between_drums(0.4, 79, 0.0);
  const World hangs = make_world(finest, measured());
  int before = live_nodes(hangs);
  for (const double tolerance : {4e-3, 2e-2, 1e-1}) {
    const Scene scene = between_drums(0.4, 79, tolerance);
    World world = make_world(scene, measured());
    run(scene, world, 480);
    EXPECT_LT(live_nodes(world), before) << tolerance;
    before = live_nodes(world);
    double moved = 0.0;
    for (std::size_t b = 0; b < world.position.size(); ++b) {
      moved = std::max(moved, (world.position[b] - hangs.position[b]).norm());
    }
    EXPECT_LT(moved, 1e-9) << tolerance;
  }
  EXPECT_LT(before, 20);  // beside drums, which it may come near, it has more
}

/// Of a rope's nodes, bends that it holds with them.
struct Whole {
  double mass = 0.0;
  Vec2 moment = Vec2::Zero(), momentum = Vec2::Zero();  // kg m, kg m/s
  double kinetic = 0.0, potential = 0.0;                // J
};

Whole measure(const Scene& scene, const World& world) {
  Whole all;
  std::vector<Eigen::Matrix3d> carried;
  std::vector<Sleeve> sleeves;
  find_carried(world, carried, sleeves);
  const CableState& cable = world.cables[0];
  for (const Link& link : cable.links) {
    if (!is_strung(cable, link)) continue;
    const auto b = index(link.body);
    const double m = carried[b](0, 0);
    all.mass += m;
    all.moment += m * world.position[b];
    all.momentum += m * world.velocity[b];
    all.kinetic += 0.5 * m * world.velocity[b].squaredNorm();
  }
  for (std::size_t s = 1; s < cable.segments.size(); ++s) {
    if (is_held(cable, s)) all.moment += first_moment(cable, s);
  }
  all.potential = potential_energy(world, cable, scene.gravity);
  return all;
}

// Each change before an impact fits velocities to it: mass, centre and momentum stay, no cable is
// lost, and no energy comes from it.
TEST(AdaptSpans, EachChangeKeepsWhatItMust) {
  const Scene scene = between_drums(0.4, 79, 2e-3);
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, 0.05);
  World world = make_world(scene, measured());
  int splits = 0, merges = 0;
  for (int i = 0; i < 60; ++i) {
    for (const Link& link : world.cables[0].links) {
      if (is_strung(world.cables[0], link)) {
        world.velocity[index(link.body)] = {normal(random), normal(random)};
      }
    }
    Scene other = scene;
    other.cables[0].node_tolerance = i % 3 == 2 ? 1e-3 : 0.05 * (1 + i % 4);
    const Whole before = measure(other, world);
    const int nodes = live_nodes(world);
    BoxTree near;
    find_surroundings(other, world, near);
    const bool wants = wants_other_nodes(other, world, near, 0);
    const int changes = change_nodes(other, world, near, 0);
    EXPECT_EQ(wants, changes > 0);
    if (changes == 0) continue;
    (live_nodes(world) > nodes ? splits : merges) += 1;
    const Whole after = measure(other, world);
    constexpr double exact = 1e-11;
    EXPECT_NEAR(after.mass, before.mass, exact);
    EXPECT_LT((after.moment - before.moment).norm(), exact);
    EXPECT_LT((after.momentum - before.momentum).norm(), exact);
    EXPECT_NEAR(after.potential, before.potential, exact * g);
    EXPECT_LE(after.kinetic, before.kinetic * (1.0 + 1e-12));
    double length = 0.0;
    const CableState& cable = world.cables[0];
    for (std::size_t s = 1; s < cable.segments.size(); ++s) {
      length += material_of_span(cable, s) + cable.links[s].radius * cable.links[s].wrap;
      EXPECT_NEAR(cable.segments[s].length, cable.segments[s].rest_length, 1e-11);
    }
    EXPECT_NEAR(length, cable.length, 1e-13);
  }
  EXPECT_GT(splits, 5);
  EXPECT_GT(merges, 5);
}

// Taut, a stretch between rims has three pieces in the end; slack it hangs; drawn up it has few.
TEST(AdaptSpans, DrawnTautHasFew) {
  const Scene scene = build::crane(80, 16, 2e-3);
  World world = make_world(scene, measured());
  double lost = 0.0, gap = 0.0, stretch = 0.0;
  Workspace work;
  const auto nodes_at = [&](double time) {
    while (world.time() < time) {
      EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      if (!world.failure.empty()) break;
      lost = std::max(lost, world.diagnostics.cable_length_error);
      gap = std::max(gap, world.diagnostics.largest_gap_violation);
      stretch = std::max(stretch, world.diagnostics.largest_stretch);
    }
    return live_nodes(world);
  };
  EXPECT_LE(nodes_at(0.18), 10);
  EXPECT_LE(nodes_at(1.0), 12);
  EXPECT_LT(world.position[0].y(), 0.6);
  EXPECT_GT(nodes_at(2.0), 25);  // it hangs over the load, which has come to stand
  EXPECT_NEAR(world.position[0].y(), 0.2, 1e-6);
  EXPECT_LE(nodes_at(5.0), 30);  // waves run on it still
  EXPECT_GT(world.position[0].y(), 1.3);
  EXPECT_LT(lost, 1e-13);
  EXPECT_LT(gap, 1e-9);
  EXPECT_LT(stretch, 1e-8);
}

// A hoist runs as with all of its nodes, the nearer the smaller the tolerance; rims take nodes in
// and give them off beside those that spans hold. No energy is made.
TEST(AdaptSpans, AHoistRunsAsWithAllItsNodes) {
  const Course finest = run_measured(adapting_hoist(40, 16, 0.0), 1.2);
  double before = infinity;
  for (const double tolerance : {8e-3, 2e-3, 5e-4}) {
    const Course course = run_measured(adapting_hoist(40, 16, tolerance), 1.2);
    double off = 0.0;  // of the weights' heights
    for (const std::size_t weight : {0, 1}) {
      off = std::max(off, std::abs(course.end[3 * weight + 1] - finest.end[3 * weight + 1]));
    }
    EXPECT_LT(off, before) << tolerance;
    EXPECT_LT(off, 0.5 * tolerance);
    before = off;
    EXPECT_LE(course.gained, 1e-9 * course.at_play) << tolerance;
    EXPECT_LT(course.stretch, 1e-9) << tolerance;
  }
}

// What comes near is met by nodes, as if they had been there.
TEST(AdaptSpans, WhatFallsOnATautRopeMeetsItsNodes) {
  for (const int steps : {4, 16}) {
    Scene scene;
    scene.steps_per_frame = steps;
    scene.bodies.push_back(body("weight", BodyKind::free, 2.105, -1.5, 0.15, 30.0));
    scene.bodies.push_back(body("pulley", BodyKind::fixed_axle, 2.0, 0.0, 0.1, 2.0));
    scene.bodies.push_back(body("ball", BodyKind::free, 0.97, 0.6, 0.08, 1.0));
    scene.cables.push_back(
        cable(build::at(0.0, 0.105), {{1, -1, 0}}, Attachment{0, {0.0, 0.1}}, 0.005));
    scene.cables[0].mass_per_metre = 0.8;
    scene.cables[0].nodes = 63;
    scene.cables[0].node_tolerance = 2e-3;
    spread_nodes(scene);
    World world = make_world(scene, measured());
    Workspace work;
    const int start = live_nodes(world);
    int before_hit = 0;
    double first = 0.0, most = -infinity;
    bool hit = false;
    while (world.time() < 0.6) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      if (world.step == 1) first = world.diagnostics.energy;
      most = std::max(most, world.diagnostics.energy);
      const CableState& rope = world.cables[0];
      const bool touches = std::any_of(rope.links.begin(), rope.links.end(),
                                       [](const Link& link) { return link.body == 2; });
      hit = hit || touches;
      if (!hit && world.position[2].y() > 0.4) before_hit = live_nodes(world);
    }
    EXPECT_TRUE(hit);
    EXPECT_LT(before_hit, start / 2) << steps;
    EXPECT_LE(most, first + 1e-9);
  }
}

Scene random_rope(unsigned seed) {
  Scene scene = strung_rope(seed);
  Cable& rope = scene.cables[0];
  const bool may = !rope.closed && rope.axial_stiffness == infinity && rope.first_node >= 0;
  if (may) rope.node_tolerance = 1e-3 * (1 + seed % 5);
  return scene;
}

TEST(AdaptSpans, RandomRopesMakeNoEnergy) {
  int adapt = 0;
  for (unsigned seed = 0; seed < seeds_of(60U); ++seed) {
    for (const int steps : {1, 4, 16}) {
      Scene scene = random_rope(seed);
      scene.steps_per_frame = steps;
      if (scene.cables[0].node_tolerance == 0.0) continue;
      const Course course = run_measured(scene, 1.2);
      const double w = scene.cables[0].half_width;
      EXPECT_LE(course.gained, 2e-4 * course.at_play) << seed << ", " << steps;
      EXPECT_LE(course.gap, 1e-6 * w) << seed << ", " << steps;
      EXPECT_LE(course.stretch, w) << seed << ", " << steps;
      ++adapt;
    }
  }
  EXPECT_GT(adapt, seeds_of(90));
}

/// A load on a rope over a sheave, on whose other side a ball falls; the rope from either end.
Scene ball_on_hoist(bool other_end) {
  Scene scene;
  scene.bodies = {body("load", BodyKind::free, -1.3, -1.0, 0.15, 2.0),
                  body("sheave", BodyKind::fixed_axle, -1.0, 0.0, 0.2, 1.0),
                  body("ball", BodyKind::free, 0.2, 0.5, 0.15, 0.5)};
  Attachment load = on(0), wall = build::at(1.3, 0.0);
  load.point = {0.0, 0.12};
  scene.cables.push_back(other_end ? cable(wall, {{1, 1, 0}}, load, 0.02)
                                   : cable(load, {{1, -1, 0}}, wall, 0.02));
  scene.cables[0].mass_per_metre = 1.0;
  scene.cables[0].nodes = 20;
  scene.cables[0].node_tolerance = 4e-3;
  scene.steps_per_frame = 4;
  spread_nodes(scene);
  return scene;
}

// Which nodes go does not depend on which end of the rope is called its start.
TEST(AdaptSpans, MoveTheSameFromEitherEnd) {
  const Scene scene = ball_on_hoist(false), other = ball_on_hoist(true);
  World world = make_world(scene, measured()), reversed = make_world(other, measured());
  run(scene, world, 240);
  run(other, reversed, 240);
  EXPECT_GT(world.diagnostics.node_changes, 20);
  EXPECT_EQ(world.diagnostics.node_changes, reversed.diagnostics.node_changes);
  const int first = world.cables[0].first_node, nodes = world.cables[0].nodes;
  for (int b = 0; index(b) < world.bodies.size(); ++b) {
    const int twin = b < first ? b : 2 * first + nodes - 1 - b;
    const Vec2 apart = pinchlab::at(world.position, b) - pinchlab::at(reversed.position, twin);
    EXPECT_LT(apart.norm(), 1e-7) << b;
  }
}

TEST(AdaptSpans, StateIsAllInTheWorld) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    EXPECT_TRUE(is_all_state(random_rope(seed), Method::pinch, 200)) << seed;
  }
  EXPECT_TRUE(is_all_state(build::crane(40, 4, 2e-3), Method::pinch, 1000));
}

TEST(AdaptSpans, RefusesWhatDoesNotAdapt) {
  const auto refusal = [](auto change) -> std::string {
    Scene scene;
    scene.bodies.push_back(body("pulley", BodyKind::fixed_axle, 1.0, 0.0, 0.1));
    scene.bodies.push_back(body("weight", BodyKind::free, 1.12, -1.0, 0.1));
    scene.cables.push_back(cable(build::at(0.0, 0.0), {{0, -1, 0}}, on(1), 0.01));
    scene.cables[0].mass_per_metre = 0.8;
    scene.cables[0].nodes = automatic_nodes;
    scene.cables[0].node_tolerance = 1e-3;
    change(scene);
    return message_of<SceneError>([&scene] {
      spread_nodes(scene);
      make_world(scene, Method::pinch);
    });
  };
  EXPECT_EQ(refusal([](Scene&) {}), "");
  EXPECT_NE(refusal([](Scene& s) { s.cables[0].axial_stiffness = 1e5; }).find("neither stretch"),
            std::string::npos);
  EXPECT_NE(refusal([](Scene& s) { s.gravity.setZero(); }).find("gravity"), std::string::npos);
  EXPECT_NE(refusal([](Scene& s) { s.cables[0].nodes = 0; }).find("node tolerance"),
            std::string::npos);
  EXPECT_NE(refusal([](Scene& s) { s.cables[0].node_tolerance = -1.0; }).find("above 0"),
            std::string::npos);
  EXPECT_NE(refusal([](Scene& s) {
              s.cables[0] = cable({}, {{0, 1, 0}, {1, 1, 0}}, {}, 0.01);
              s.cables[0].closed = true;
              s.cables[0].mass_per_metre = 0.8;
              s.cables[0].nodes = 8;
              s.cables[0].node_tolerance = 1e-3;
            }).find("two ends"),
            std::string::npos);
}

}  // namespace
}  // namespace pinchlab::testing
