// SPDX-License-Identifier: GPL-3.0-or-later
// Cables with mass that run over bodies and hang between them: nodes that rims take in and give
// off.

#include "sim/cable/strung.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "demos/scenes/shape_scenes.h"
#include "sim/cable/cable.h"
#include "sim/cable/mass.h"
#include "sim/cable/sleeve.h"
#include "sim/make_world.h"
#include "sim/mirror.h"
#include "sim/nodes.h"
#include "sim/outline.h"
#include "sim/tangent.h"
#include "tests/sim/course.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using std::numbers::pi;

Scene with_nodes(Scene scene, int nodes) {
  scene.cables[0].nodes = nodes;
  spread_nodes(scene);
  return scene;
}

int live_nodes(const World& world) {
  const CableState& cable = world.cables[0];
  return static_cast<int>(
      std::count_if(cable.links.begin(), cable.links.end(),
                    [&cable](const Link& link) { return is_strung(cable, link); }));
}

constexpr double reach = 2.0, drum_radius = 0.3, half_width = 0.02;  // m

/// A rope between two drums that stand, 2 `reach` apart, to whose rims it is fastened.
Scene between_drums(double slack, int nodes, int steps) {
  Scene scene;
  scene.steps_per_frame = steps;
  const double rim = drum_radius + half_width;
  for (int i = 0; i < 2; ++i) {
    const double side = i == 0 ? -1.0 : 1.0;
    scene.bodies.push_back(
        body(i == 0 ? "left" : "right", BodyKind::fixed, side * reach, 0.0, drum_radius));
  }
  scene.cables.push_back(cable(Attachment{0, {-rim, 0.0}}, {{0, -1, 0}, {1, -1, 0}},
                               Attachment{1, {rim, 0.0}}, half_width));
  scene.cables[0].slack = slack;
  scene.cables[0].mass_per_metre = 1.5;
  return with_nodes(scene, nodes);
}

double lowest(const World& world, double from, double to) {
  double y = infinity;
  const CableState& cable = world.cables[0];
  for (const Link& link : cable.links) {
    if (!is_strung(cable, link)) continue;
    const double x = world.position[static_cast<std::size_t>(link.body)].x();
    if (x < from || x > to) continue;
    y = std::min(y, world.position[static_cast<std::size_t>(link.body)].y());
  }
  return y;
}

/// The lowest point of a catenary that leaves two discs as their tangent, of half the length
/// `reach` + slack / 2 less what lies on a disc, and its tension there over the weight of a metre.
struct Catenary {
  double low, a;
};
Catenary catenary(double slack) {
  // With the slope tan f at its ends: x = reach - R sin f, a sinh(x / a) = a tan f = length - R f.
  const double rim = drum_radius + half_width;
  double below = 1e-6, above = 1.5;
  const auto excess = [&](double f) {
    const double x = reach - rim * std::sin(f), a = x / std::asinh(std::tan(f));
    return a * std::tan(f) - (reach + 0.5 * slack - rim * f);
  };
  for (int k = 0; k < 200; ++k) {
    const double f = 0.5 * (below + above);
    (excess(f) < 0.0 ? below : above) = f;
  }
  const double f = below, a = (reach - rim * std::sin(f)) / std::asinh(std::tan(f));
  return {rim * std::cos(f) - a * (std::cosh(std::asinh(std::tan(f))) - 1.0), a};
}

TEST(Strung, HangsAtRestAsACatenaryThatLeavesDrums) {
  for (const double slack : {0.05, 0.4}) {
    for (const int nodes : {19, 39, 79}) {
      Scene scene = between_drums(slack, nodes, 4);
      World world = make_world(scene, measured());
      const Catenary exact = catenary(slack);
      // A node in the middle is lower than the curve, a level piece higher: by l^2 / 8 a at most.
      const double l = world.cables[0].length / (nodes + 1), most = l * l / (8.0 * exact.a);
      EXPECT_NEAR(lowest(world, -1.0, 1.0), exact.low, 2.0 * most) << slack << " " << nodes;
      const std::vector<Vec2> start = world.position;
      run(scene, world, 240);
      double moved = 0.0;
      for (std::size_t b = 0; b < start.size(); ++b) {
        moved = std::max(moved, (world.position[b] - start[b]).norm());
      }
      EXPECT_LT(moved, 1e-9) << slack << " " << nodes;
      double tension = infinity;
      for (const Segment& span : world.cables[0].segments) {
        if (span.length > 0.0) tension = std::min(tension, span.tension);
      }
      const double now = std::abs(tension / (1.5 * g * exact.a) - 1.0);
      EXPECT_LT(now, 0.8 / (nodes * nodes)) << slack << " " << nodes;
    }
  }
}

/// The same rope between regular polygons of so many corners, of the drums' size, fastened beyond.
Scene between_polygons(int corners, double slack, BodyKind kind) {
  Scene scene;
  scene.steps_per_frame = 4;
  std::vector<Vec2> around;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2.0 * pi * (k + 0.5) / corners;
    around.emplace_back(drum_radius * std::cos(angle), drum_radius * std::sin(angle));
  }
  for (int i = 0; i < 2; ++i) {
    scene.bodies.push_back(
        body(i == 0 ? "left" : "right", kind, i == 0 ? -reach : reach, 0.0, drum_radius));
    make_polygon(scene.bodies.back(), around, 0.0);
  }
  scene.cables.push_back(
      cable(at(-reach - 0.6, -1.0), {{0, -1, 0}, {1, -1, 0}}, at(reach + 0.6, -1.0), half_width));
  scene.cables[0].slack = slack;
  scene.cables[0].mass_per_metre = 1.5;
  return with_nodes(scene, 60);
}

int corner_links(const World& world) {
  const std::vector<Link>& links = world.cables[0].links;
  return static_cast<int>(
      std::count_if(links.begin(), links.end(), [](const Link& link) { return link.corner >= 0; }));
}

// It lies along their sides, round more corners the deeper it hangs; sides have no nodes.
TEST(Strung, HangsAtRestFromPolygons) {
  const Scene tight = between_polygons(8, 0.02, BodyKind::fixed);
  EXPECT_LT(corner_links(make_world(tight, measured())), 8);
  for (const int corners : {3, 4, 8, 64}) {
    const Scene scene = between_polygons(corners, 2.0, BodyKind::fixed);
    World world = make_world(scene, measured());
    if (corners == 8) {
      EXPECT_GE(corner_links(world), 8);
    }
    const CableState& cable = world.cables[0];
    for (std::size_t i = 1; i + 1 < cable.links.size(); ++i) {
      if (!is_strung(cable, cable.links[i])) continue;
      EXPECT_FALSE(cable.links[i - 1].corner >= 0 && cable.links[i + 1].corner >= 0 &&
                   cable.links[i - 1].body == cable.links[i + 1].body);
    }
    const std::vector<Vec2> start = world.position;
    run(scene, world, 240);
    for (std::size_t b = 0; b < start.size(); ++b) {
      EXPECT_LT((world.position[b] - start[b]).norm(), 1e-9) << corners << ": " << b;
    }
    // (A node near a corner swings fast.)
    EXPECT_LE(world.diagnostics.intervals, 3 * 240) << corners;
  }
}

/// A belt on two drums that turn at `speed` (m/s along their rims).
Scene belt(double speed, int nodes, int steps) {
  Scene scene;
  scene.steps_per_frame = steps;
  for (int i = 0; i < 2; ++i) {
    scene.bodies.push_back(body(i == 0 ? "left" : "right", BodyKind::fixed_axle,
                                i == 0 ? -1.5 : 1.5, 0.0, drum_radius, 1.0));
    scene.bodies.back().driven_angular_velocity = speed / (drum_radius + half_width);
  }
  Cable loop = cable({}, {{0, 1, 0}, {1, 1, 0}}, {}, half_width);
  loop.closed = true;
  loop.slack = 0.3;
  loop.mass_per_metre = 1.0;
  scene.cables.push_back(loop);
  return with_nodes(scene, nodes);
}

// A chain that runs along itself keeps its shape, at any speed: T grows by rho v^2 (Routh 1892, *A
// treatise on the dynamics of a system of rigid bodies*, II, 597). Here it comes off one drum and
// goes on to the other, and drums that take nodes in and give them off shake it: in the mean.
TEST(Strung, ABeltHangsTheSameHoweverFastItRuns) {
  const auto tension_below = [](const World& world) {
    const std::vector<Segment>& spans = world.cables[0].segments;
    return std::min_element(spans.begin(), spans.end(),
                            [](const Segment& p, const Segment& q) {
                              return (p.tail + p.head).y() < (q.tail + q.head).y();
                            })
        ->tension;
  };
  const Scene at_rest = belt(0.0, 60, 4);
  World still = make_world(at_rest, measured());
  run(at_rest, still, 1);
  const double low = lowest(still, -0.2, 0.2), tension = tension_below(still);
  for (const double speed : {1.0, 4.0}) {
    const Scene scene = belt(speed, 60, 4);
    World world = make_world(scene, measured());
    Workspace work;
    double mean = 0.0;  // N, over the second second
    for (int i = 0; i < 480; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      if (i >= 240) mean += tension_below(world) / 240.0;
    }
    // More than once round, and every node that has come off is on again.
    EXPECT_GT(world.diagnostics.node_changes, speed * 2.0 / world.cables[0].length * 60.0);
    EXPECT_NEAR(lowest(world, -0.2, 0.2), low, 5e-3) << speed;
    EXPECT_NEAR(mean - tension, speed * speed, 1.5) << speed;
    EXPECT_LT(world.diagnostics.cable_length_error, 1e-11);
  }
}

double height_after(int nodes, int steps) {
  const Scene scene = build::sagging_hoist(nodes, steps);
  World world = make_world(scene, measured());
  run(scene, world, 90 * steps);
  return world.position[0].y();
}

TEST(Strung, ConvergesWithStepsAndWithNodes) {
  const double fine = height_after(40, 64);
  for (const int steps : {1, 2, 4, 8, 16}) {
    EXPECT_NEAR(height_after(40, steps), fine, 2e-5) << steps;
  }
  const double finest = height_after(180, 4);
  EXPECT_NEAR(height_after(10, 4), finest, 2.5e-3);
  EXPECT_NEAR(height_after(20, 4), finest, 8e-4);
  EXPECT_NEAR(height_after(60, 4), finest, 1e-4);
}

// The rope comes to rest and goes back on both pulleys. Held fast until a rim had given off a
// quarter of a piece, nodes took 5 mm off the way.
TEST(Strung, RimsThatTurnBackLetNodesGo) {
  const double finest = height_after(190, 4);
  for (const int nodes : {44, 45, 46, 47, 48, 49, 50}) {
    EXPECT_NEAR(height_after(nodes, 4), finest, 3e-4) << nodes;
  }
  EXPECT_NEAR(height_after(11, 1), finest, 3e-3);
}

double greatest_tension(const World& world) {
  return std::ranges::max(world.cables[0].segments, {}, &Segment::tension).tension;
}

// As many as fit where no piece is shorter than 2 h sqrt(T / rho), so that finer steps have more
// and tell more; none shorter than twice the cable's width.
TEST(Strung, TheProgramChoosesAsManyNodesAsStepsCanFollow) {
  const double finest = height_after(190, 4);
  int before = 0;
  double error_before = infinity;
  for (const int steps : {1, 2, 4, 8}) {
    const Scene scene = build::sagging_hoist(automatic_nodes, steps);
    World world = make_world(scene, measured());
    Workspace work;
    double most = 0.0;
    for (int i = 0; i < 90 * steps; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      most = std::max(most, greatest_tension(world));
    }
    const double piece = world.cables[0].length / (scene.cables[0].nodes + 1);
    EXPECT_GE(piece, 2.0 * world.step_length * std::sqrt(most / scene.cables[0].mass_per_metre));
    EXPECT_GE(piece, 4.0 * half_width);
    EXPECT_GE(scene.cables[0].nodes, 2 * before);
    EXPECT_EQ(scene.cables[0].nodes % 2, 1);
    before = scene.cables[0].nodes;
    const double error = std::abs(world.position[0].y() - finest);
    EXPECT_LT(error, 0.5 * error_before) << steps;
    error_before = error;
  }
  EXPECT_LT(error_before, 5e-5);
}

TEST(Strung, ExpectsTheTensionWithWhichItHangs) {
  for (const double slack : {0.4, 0.05, 0.005, 0.0, -0.01}) {
    Scene scene = between_drums(std::max(slack, 0.01), 0, 4);
    scene.cables[0].slack = slack;
    scene.cables[0].nodes = automatic_nodes;
    scene.cables[0].linear_drag = 4.0;
    if (slack <= 0.0) scene.cables[0].axial_stiffness = 1e5;
    const double expected = expected_of(scene, std::array<std::size_t, 1>{0}).front().tension;
    spread_nodes(scene);
    World world = make_world(scene, measured());
    run(scene, world, 4 * 240);
    const double hangs = greatest_tension(world);
    EXPECT_GT(expected, hangs) << slack;
    // Stretched from the start it bears less than the sum of what either asks for.
    EXPECT_LT(expected, (slack < 0.0 ? 1.4 : 1.2) * hangs) << slack;
  }
}

// What the pulleys take in they give off again, on the other side. Energy is lost, the less the
// more nodes there are, and none is made.
TEST(Strung, WhatRimsTakeInTheyGiveOffAgain) {
  for (const int nodes : {40, 160}) {
    const Scene scene = build::sagging_hoist(nodes, 4);
    World world = make_world(scene, measured());
    const int at_start = live_nodes(world);
    Workspace work;
    double start = 0.0, gained = 0.0, at_play = 0.0;
    int fewest = at_start;
    for (int i = 0; i < 60 * 4 * 19 / 10; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      if (i == 0) start = world.diagnostics.energy;
      gained = std::max(gained, world.diagnostics.energy - start);
      at_play = std::max(at_play, start - potential_energy(scene, world));
      EXPECT_LT(world.diagnostics.cable_length_error, 1e-12);
      EXPECT_LT(world.diagnostics.largest_stretch, 1e-6 * half_width);
      fewest = std::min(fewest, live_nodes(world));
    }
    EXPECT_GE(world.diagnostics.node_changes, nodes / 4);
    EXPECT_GE(fewest, at_start - nodes / 10);
    EXPECT_LT(gained, 1e-9 * at_play);
    EXPECT_LT(start - world.diagnostics.energy, (nodes == 40 ? 1e-3 : 1e-4) * at_play);
    EXPECT_EQ(world.diagnostics.fallbacks, 0);
  }
}

// A pluck's energy dies away as e^(-c t) where drag is c.
TEST(Strung, DragQuietsARope) {
  const auto energy_left = [](double drag, bool plucked) {
    Scene scene = between_drums(0.05, 39, 4);
    for (Body& b : scene.bodies) {
      if (b.node) b.linear_drag = drag;
    }
    World world = make_world(scene, measured());
    for (const Link& link : world.cables[0].links) {
      if (!plucked || !is_strung(world.cables[0], link)) continue;
      const auto node = static_cast<std::size_t>(link.body);
      world.velocity[node] = {0.0, 0.3 * world.position[node].x()};
    }
    Workspace work;
    std::array<double, 2> most{-infinity, -infinity};  // J, in the first second, and two later
    for (int i = 0; i < 720; ++i) {
      EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      if (i < 240) most[0] = std::max(most[0], world.diagnostics.energy);
      if (i >= 480) most[1] = std::max(most[1], world.diagnostics.energy);
    }
    return most;
  };
  const double rest = energy_left(0.0, false)[0];
  const auto freely = energy_left(0.0, true), dragged = energy_left(2.0, true);
  EXPECT_GT(freely[0] - rest, 0.05);
  EXPECT_GT((freely[1] - rest) / (freely[0] - rest), 0.8);
  EXPECT_LT((dragged[1] - rest) / (dragged[0] - rest), 1.2 * std::exp(-2.0 * 2.0));
}

/// In free flight: two bodies that a slack belt joins, and a third that runs into it.
TEST(Strung, KeepsMomentum) {
  double least = infinity;
  for (const int steps : {4, 16, 64}) {
    Scene scene;
    scene.steps_per_frame = steps;
    scene.gravity = Vec2::Zero();
    scene.bodies.push_back(body("first", BodyKind::free, -0.6, 0.0, 0.2, 1.0));
    scene.bodies.push_back(body("second", BodyKind::free, 0.6, 0.1, 0.25, 2.0));
    scene.bodies.push_back(body("third", BodyKind::free, 0.0, 0.5, 0.1, 0.5));
    scene.bodies[0].angular_velocity = 2.0;
    scene.bodies[1].velocity = {0.4, 0.3};
    scene.bodies[2].velocity = {0.2, -3.0};
    Cable loop = cable({}, {{0, 1, 0}, {1, 1, 0}}, {}, 0.01);
    loop.closed = true;
    loop.mass_per_metre = 0.9;
    scene.cables.push_back(loop);
    scene = with_nodes(scene, 20);
    World world = make_world(scene, measured());
    Workspace work;
    const auto momentum = [&] {
      const Velocities now = velocities_now(scene, world, work);
      std::vector<Eigen::Matrix3d> carried;
      std::vector<Sleeve> sleeves;
      find_carried(world, carried, sleeves);
      Vec2 sum = Vec2::Zero();
      for (std::size_t b = 0; b < world.bodies.size(); ++b) {
        const Eigen::Vector3d v(now.linear[b].x(), now.linear[b].y(), now.angular[b]);
        sum += world.bodies[b].mass * v.head<2>() + (carried[b] * v).head<2>();
      }
      return sum;
    };
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    const Vec2 first = momentum();
    double most = 0.0;
    for (int i = 0; i < 15 * steps; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      most = std::max(most, (momentum() - first).norm());
    }
    EXPECT_GT(world.diagnostics.node_changes, 0);
    EXPECT_LT(most, 2e-2) << steps;
    least = std::min(least, most);
  }
  EXPECT_LT(least, 2e-3);
}

/// At 1, 4 and 16 steps a frame. What the energy rises by is the swing of leapfrog's.
void expect_sound_at_any_step(unsigned seed, Scene scene) {
  for (const int steps : {1, 4, 16}) {
    scene.steps_per_frame = steps;
    expect_sound(scene, run_measured(scene, 1.2), 2e-4, seed);
  }
}

TEST(RandomStrung, StaysFiniteAndMakesNoEnergy) {
  for (unsigned seed = 0; seed < seeds_of(60U); ++seed) {
    expect_sound_at_any_step(seed, strung_rope(seed));
  }
}

// Nodes that rims hold slip with the rope there.
TEST(RandomStrung, SlipsOverPegsThatAreFixed) {
  for (unsigned seed = 0; seed < seeds_of(20U); ++seed) {
    Scene scene = strung_rope(seed);
    for (Body& b : scene.bodies) {
      if (!b.name.starts_with("pulley")) continue;
      b.kind = BodyKind::fixed;
      b.cable_friction = Random(seed + 5).uniform(0.0, 0.4);
    }
    expect_sound_at_any_step(seed, scene);
  }
}

TEST(RandomStrung, AClearedWorkspaceChangesNoBit) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    EXPECT_TRUE(is_all_state(strung_rope(seed), Method::pinch, 200)) << seed;
  }
}

// Events that take effect at the steps follow no node to a rim: there the rope is straight.
TEST(Strung, IsStraightWhereEventsAreAtTheSteps) {
  const Scene scene = build::sagging_hoist(40, 4);
  World world = make_world(scene, Method::cable);
  EXPECT_EQ(live_nodes(world), 0);
  run(scene, world, 60);
  Scene straight = scene;
  straight.cables[0].nodes = 0;
  straight.cables[0].first_node = -1;
  World other = make_world(straight, Method::cable);
  run(straight, other, 60);
  EXPECT_EQ(world.position[0], other.position[0]);
}

TEST(Strung, RefusesWhatItCannotHang) {
  const auto refusal = [](auto change) -> std::string {
    Scene scene = between_drums(0.4, 40, 4);
    change(scene);  // its nodes follow its bodies: what is added comes behind them
    return message_of<SceneError>([&scene] { make_world(scene, Method::pinch); });
  };
  EXPECT_EQ(refusal([](Scene&) {}), "");
  const auto tighten = [](Scene& s) { s.cables[0].slack = 0.0; };
  EXPECT_NE(refusal(tighten).find("between body 'left' and body 'right', which hold it fast"),
            std::string::npos);
  EXPECT_EQ(refusal([&](Scene& s) {
              tighten(s);
              s.bodies[1].kind = BodyKind::fixed_axle;
            }),
            "");
  EXPECT_EQ(refusal([&](Scene& s) {
              tighten(s);
              s.gravity = Vec2::Zero();
            }),
            "");
  // What turns one way tightens either side.
  EXPECT_NO_THROW(make_world(between_polygons(4, 0.3, BodyKind::fixed_axle), Method::pinch));
  EXPECT_THROW(make_world(between_polygons(4, 0.0, BodyKind::fixed_axle), Method::pinch),
               SceneError);
  EXPECT_NE(refusal([](Scene& s) { s.cables[0].nodes = 41; }).find("its nodes"), std::string::npos);
  EXPECT_NE(refusal([](Scene& s) { s.cables[0].first_node = 1; }).find("its nodes"),
            std::string::npos);
  EXPECT_NE(refusal([](Scene& s) {
              s.bodies.push_back(body("in the way", BodyKind::fixed, 0.0, -0.4, 0.1));
            }).find("as it hangs at the start the cable runs through body 'in the way'"),
            std::string::npos);
  EXPECT_NE(refusal([](Scene& s) {
              s.walls.push_back({Vec2(-3.0, -0.4), Vec2(3.0, -0.4), 0.5, 0.0});
            }).find("as it hangs at the start the cable runs through wall 0"),
            std::string::npos);
}

}  // namespace
}  // namespace pinchlab::testing
