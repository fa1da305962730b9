// SPDX-License-Identifier: GPL-3.0-or-later
// Cables over the corners of polygons.

#include <algorithm>
#include <numbers>

#include "demos/scenes/shape_scenes.h"
#include "sim/cable/cable.h"
#include "sim/outline.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using build::box_corners;
using build::regular_corners;
using build::SquareDrum;
using build::turning_drum;

Body polygon(const char* name, BodyKind kind, const Vec2& position, std::vector<Vec2> corners,
             double mass = 1.0, double corner_radius = 0.0) {
  Body b = body(name, kind, position, 1.0, mass);
  make_polygon(b, std::move(corners), corner_radius);
  return b;
}

TEST(Outline, PlatesWithRoundedCornersAreExact) {
  const double a = 0.7, b = 0.4, r = 0.15;
  const Plate sharp = plate_of(box_corners(a, b), 0.0);
  EXPECT_NEAR(sharp.area, a * b, 1e-15);
  EXPECT_NEAR(sharp.second_moment, a * b * (a * a + b * b) / 12.0, 1e-15);
  // A rounded box is a wider and a higher one, less the core they share, and a disc in four parts,
  // whose centres lie 4 r / 3 pi from the corners along either axis.
  const Plate round = plate_of(box_corners(a, b), r);
  const double pi = std::numbers::pi, wide = a + 2.0 * r, high = b + 2.0 * r;
  const double off = 4.0 * r / (3.0 * pi), quarter = 0.25 * pi * r * r;
  const double own = 0.5 * quarter * r * r - quarter * 2.0 * off * off;
  const Vec2 centre(0.5 * a + off, 0.5 * b + off);
  EXPECT_NEAR(round.area, wide * b + a * high - a * b + 4.0 * quarter, 1e-15);
  EXPECT_NEAR(round.second_moment,
              wide * b * (wide * wide + b * b) / 12.0 + a * high * (a * a + high * high) / 12.0 -
                  sharp.second_moment + 4.0 * (own + quarter * centre.squaredNorm()),
              1e-15);
  EXPECT_NEAR(round.centre.norm(), 0.0, 1e-15);
  // A triangle's centre is the mean of its corners, wherever it lies; rounding moves it.
  const std::vector<Vec2> triangle = {{1.0, 2.0}, {2.0, 2.5}, {1.2, 3.1}};
  EXPECT_NEAR(
      (plate_of(triangle, 0.0).centre - (triangle[0] + triangle[1] + triangle[2]) / 3.0).norm(),
      0.0, 1e-14);
  // Of many corners it is a disc.
  const Plate disc = plate_of(regular_corners(2000, 0.5), 0.25);
  EXPECT_NEAR(disc.area, pi * 0.75 * 0.75, 1e-5);
  EXPECT_NEAR(disc.second_moment, 0.5 * pi * std::pow(0.75, 4), 1e-5);
}

TEST(Outline, TheWayOutIsTheNearest) {
  const std::vector<Vec2> corners = {{0.0, 0.0}, {2.0, 0.0}, {0.0, 1.0}};
  const auto expect = [&](const Vec2& point, double distance, const Vec2& normal) {
    const Outside out = outside_of(corners, point);
    EXPECT_NEAR(out.distance, distance, 1e-15);
    EXPECT_NEAR((out.normal - normal).norm(), 0.0, 1e-15);
  };
  expect({1.0, -0.5}, 0.5, {0.0, -1.0});
  expect({0.5, 0.1}, -0.1, {0.0, -1.0});
  expect({0.1, 0.4}, -0.1, {-1.0, 0.0});
  expect({3.0, 0.0}, 1.0, {1.0, 0.0});
  expect({-3.0, -4.0}, 5.0, {-0.6, -0.8});
  expect(Vec2(1.0, 0.5) + 0.2 * Vec2(1.0, 2.0).normalized(), 0.2, Vec2(1.0, 2.0).normalized());
}

TEST(Outline, OnlyConvexCornersCounterClockwiseAreTaken) {
  EXPECT_TRUE(is_convex(regular_corners(5, 1.0)));
  std::vector<Vec2> reversed = regular_corners(5, 1.0);
  std::reverse(reversed.begin(), reversed.end());
  EXPECT_FALSE(is_convex(reversed));
  EXPECT_FALSE(is_convex(std::vector<Vec2>{{0, 0}, {1, 0}}));
  EXPECT_FALSE(is_convex(std::vector<Vec2>{{0, 0}, {1, 0}, {2, 0}, {1, 1}}));
  EXPECT_FALSE(is_convex(std::vector<Vec2>{{0, 0}, {1, 0}, {1, 0}, {1, 1}}));
  EXPECT_FALSE(is_convex(std::vector<Vec2>{{0, 0}, {2, 0}, {0.5, 0.5}, {0, 2}}));
  std::vector<Vec2> star = regular_corners(5, 1.0);
  star = {star[0], star[2], star[4], star[1], star[3]};
  EXPECT_FALSE(is_convex(star));
  const auto refusal = [](const std::vector<Vec2>& corners) -> std::string {
    Scene scene;
    scene.bodies.push_back(polygon("p", BodyKind::free, Vec2::Zero(), corners));
    return message_of<SceneError>([&scene] { make_world(scene, Method::pinch); });
  };
  EXPECT_EQ(refusal(box_corners(1.0, 1.0)), "");
  EXPECT_NE(refusal({{0, 0}, {3, 0}, {0, 3}}).find("lies at [1, 1]"), std::string::npos);
  EXPECT_NE(refusal(regular_corners(65, 1.0)).find("3 to 64"), std::string::npos);
  EXPECT_NE(refusal({{0, 0}, {NAN, 0}, {0, 3}}).find("finite"), std::string::npos);
}

TEST(Corners, UnwindingFromASquareIsOfSecondOrder) {
  for (const double w : {0.05, 1e-3}) {
    SquareDrum drum;
    drum.half_width = w;
    const Vec2 exact = drum.bob_after(1.2);
    double before = 0.0;
    for (int n = 1; n <= 128; n *= 2) {
      const Scene scene = drum.scene(n);
      World world = make_world(scene, Method::pinch);
      EXPECT_EQ(world.cables[0].links.size(), 4u);
      run(scene, world, 72 * n);
      const double error = (world.position[1] - exact).norm();
      if (n > 1) {
        EXPECT_GT(std::log2(before / error), 1.9) << "w " << w << ", " << n << " steps a frame";
      }
      before = error;
    }
    EXPECT_LT(before, 1e-6);
  }
}

TEST(Corners, ATurningSquareDrumIsOfSecondOrder) {
  // Falling, it unwinds a side; thrown up, it winds some on and then off.
  for (const double speed : {0.0, 2.5}) {
    std::vector<Vec2> ends;
    for (int n = 1; n <= 256; n *= 2) {
      const Scene scene = turning_drum(box_corners(0.6, 0.6), speed, n);
      World world = make_world(scene, measured());
      EXPECT_EQ(world.cables[0].links.size(), 4u);
      Workspace work;
      double start = 0.0;
      for (int i = 0; i < 96 * n; ++i) {
        ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
        if (i == 1) start = world.diagnostics.energy;
        ASSERT_LT(world.diagnostics.cable_length_error, 1e-12);
        ASSERT_LT(world.diagnostics.largest_stretch, 1e-9);
      }
      EXPECT_GE(world.diagnostics.events, 1);
      EXPECT_LT(std::abs(world.diagnostics.energy - start), 2e-3 / (n * n));
      ends.push_back(world.position[1]);
    }
    for (std::size_t i = 2; i < ends.size(); ++i) {
      const double before = (ends[i - 1] - ends[i - 2]).norm();
      const double now = (ends[i] - ends[i - 1]).norm();
      EXPECT_GT(std::log2(before / now), 1.9) << "speed " << speed << ", at " << (1 << i);
    }
  }
}

// A side keeps the strain that it comes on with: nothing of it is left behind to the span. (Of the
// arcs at corners, here of 1 mm, rims carry what is not stretched.)
TEST(Corners, AnElasticCableKeepsItsTensionThere) {
  for (const double stiffness : {100.0, 1000.0}) {
    Scene scene = turning_drum(box_corners(0.6, 0.6), 4.0, 64);
    scene.cables[0].axial_stiffness = stiffness;
    scene.cables[0].half_width = 0.001;
    World world = make_world(scene, measured());
    Workspace work;
    double start = 0.0, before = 0.0;
    std::size_t links = world.cables[0].links.size(), met = 0;
    for (int i = 0; i < 36 * 64; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      if (i == 1) start = world.diagnostics.energy;
      if (i > 1) {
        EXPECT_LT(std::abs(world.diagnostics.energy - start), 5e-3);
      }
      const CableState& cable = world.cables[0];
      const double tension = cable.segments.back().tension;
      if (cable.links.size() != links) {
        EXPECT_LT(std::abs(tension - before), 0.02 * stiffness * 0.04) << i;
        met += cable.links.size() - links;
      }
      links = cable.links.size();
      before = tension;
    }
    EXPECT_EQ(met, 2U);
  }
}

TEST(Corners, APolygonOfManyCornersTendsToTheDisc) {
  const auto end = [](const Scene& scene) {
    World world = make_world(scene, Method::pinch);
    run(scene, world, 60 * 16);
    return world.position[1];
  };
  const Vec2 round = end(turning_drum(0.5, 0.0, 16));
  for (const int corners : {8, 16, 32, 64}) {
    const double upright = std::numbers::pi / corners;
    const double error =
        (end(turning_drum(regular_corners(corners, 0.5, upright), 0.0, 16)) - round).norm();
    EXPECT_LT(error * corners * corners, 4.0) << corners;
    EXPECT_GT(error, 0.0) << corners;
  }
}

TEST(Corners, TheCapstanLawHoldsOverAllCorners) {
  const double mu = 0.3, k = std::exp(mu * std::numbers::pi), light = 1.0, heavy = 5.0;
  for (const int steps_per_frame : {1, 4}) {
    Scene scene;
    scene.steps_per_frame = steps_per_frame;
    Body beam = polygon("beam", BodyKind::fixed, Vec2::Zero(), box_corners(0.8, 0.4), 1.0, 0.03);
    beam.cable_friction = mu;
    scene.bodies.push_back(beam);
    scene.bodies.push_back(body("light", BodyKind::free, -0.48, -2.0, 0.1, light));
    scene.bodies.push_back(body("heavy", BodyKind::free, 0.48, -1.0, 0.1, heavy));
    scene.cables.push_back(cable(on(1), {{0, -1, 0}}, on(2)));
    World world = make_world(scene, Method::pinch);
    const int steps = 30 * steps_per_frame;
    run(scene, world, steps);
    const double a = g * (heavy - k * light) / (heavy + k * light), t = world.time();
    EXPECT_NEAR(world.position[2].y(), -1.0 - 0.5 * a * t * t, 1e-12);
    EXPECT_NEAR(world.position[1].y(), -2.0 + 0.5 * a * t * t, 1e-12);
    const std::vector<Segment>& s = world.cables[0].segments;
    EXPECT_NEAR(s.back().tension / s[1].tension, k, 1e-9);
  }
}

// Sides have no tension of their own, also those that were spans.
TEST(Corners, SidesHaveNoTension) {
  Scene scene;
  scene.bodies.push_back(polygon("drum", BodyKind::fixed_axle, Vec2::Zero(),
                                 {{0.28660, 0.08866}, {-0.22008, 0.20387}, {-0.06652, -0.29253}},
                                 3.0));
  scene.bodies.push_back(body("left", BodyKind::free, -0.5, -1.2, 0.1, 1.3));
  scene.bodies.push_back(body("right", BodyKind::free, 0.5, -1.5, 0.1, 1.0));
  scene.cables.push_back(cable(on(1), {{0, -1, 0}}, on(2), 0.02));
  const Vec2 centre = plate_of(scene.bodies[0].corners, 0.0).centre;
  for (Vec2& corner : scene.bodies[0].corners) corner -= centre;
  World world = make_world(scene, Method::pinch);
  const int links = world.cables[0].changes;
  for (int i = 0; i < 480; ++i) {
    run(scene, world, 1);
    const CableState& state = world.cables[0];
    for (std::size_t s = 1; s < state.links.size(); ++s) {
      if (!is_side(state.links[s - 1], state.links[s])) continue;
      ASSERT_EQ(state.segments[s].tension, 0.0) << i;
    }
  }
  EXPECT_GT(world.cables[0].changes, links);
}

Scene box_on_wall(const Vec2& along, double friction) {
  Scene scene;
  Body crate = polygon("crate", BodyKind::free, Vec2::Zero(), box_corners(0.4, 0.3), 2.0);
  crate.angle = std::atan2(along.y(), along.x());
  crate.position = 0.15 * Vec2(-along.y(), along.x());
  crate.contact_friction = friction;
  scene.bodies.push_back(crate);
  scene.walls.push_back({-5.0 * along, 5.0 * along, friction, 0.0});
  return scene;
}

TEST(Corners, ABoxSlidesDownASlopeAsItShould) {
  const double slope = 0.5, mu = 0.3;
  const Vec2 along(std::cos(slope), -std::sin(slope));
  const Scene scene = box_on_wall(along, mu);
  World world = make_world(scene, Method::pinch);
  const Vec2 start = world.position[0];
  run(scene, world, 240);
  const double t = world.time(), a = g * (std::sin(slope) - mu * std::cos(slope));
  EXPECT_NEAR((world.position[0] - start - 0.5 * a * t * t * along).norm(), 0.0, 1e-9);
  EXPECT_NEAR(world.angle[0], -slope, 1e-12);
}

TEST(Corners, ABoxTopplesWhereItsWeightIsBeyondItsCorner) {
  // The tangent of the steepest slope on which it stands is width over height.
  const double steepest = std::atan2(0.4, 0.3);
  for (const double slope : {steepest - 0.01, steepest + 0.01}) {
    const Vec2 along(std::cos(slope), -std::sin(slope));
    const Scene scene = box_on_wall(along, 10.0);
    World world = make_world(scene, Method::pinch);
    run(scene, world, 240);
    const double turned = std::abs(world.angle[0] + slope);
    EXPECT_EQ(turned > 0.1, slope > steepest) << turned;
    if (slope < steepest) {
      EXPECT_LT(turned, 1e-9);
    }
  }
}

TEST(Corners, TenBoxesStandOnOneAnother) {
  for (const int steps_per_frame : {1, 4}) {
    Scene scene;
    scene.steps_per_frame = steps_per_frame;
    scene.walls.push_back({{-3.0, 0.0}, {3.0, 0.0}, 0.5, 0.0});
    for (int i = 0; i < 10; ++i) {
      const double x = 0.05 * (i % 3), y = 0.15 + 0.31 * i;  // they fall a little
      scene.bodies.push_back(polygon("box", BodyKind::free, {x, y}, box_corners(0.5, 0.3)));
      scene.bodies.back().name += std::to_string(i);
    }
    World world = make_world(scene, measured());
    run(scene, world, 180 * steps_per_frame);
    for (std::size_t b = 0; b < 10; ++b) {
      EXPECT_LT(world.velocity[b].norm(), 1e-9) << b;
      EXPECT_LT(std::abs(world.angular_velocity[b]), 1e-9) << b;
      EXPECT_NEAR(world.position[b].y(), 0.15 + 0.3 * static_cast<double>(b), 1e-8) << b;
    }
  }
}

// A cable that starts on a square winch, lies over two of its corners and then slides over a
// pulley: the pulley's two tensions are e^(mu theta) apart while the winch holds and the weight is
// let down, with the angle by which the cable lies on it when the last step begins.
TEST(Corners, ACableWoundOverCornersSlidesElsewhere) {
  const double mu = 0.3;
  for (const bool from_start : {true, false}) {
    Scene scene;
    scene.bodies.push_back(
        polygon("winch", BodyKind::fixed_axle, Vec2::Zero(), box_corners(0.4, 0.4), 5.0));
    scene.bodies[0].driven_angular_velocity = 0.5;
    scene.bodies.push_back(body("pulley", BodyKind::fixed, 3.0, 0.25, 0.3));
    scene.bodies[1].cable_friction = mu;
    scene.bodies.push_back(body("weight", BodyKind::free, 3.35, -2.0, 0.1, 2.0));
    const Attachment rim{0, {0.0, -0.25}};
    scene.cables.push_back(from_start ? cable(rim, {{0, -1, 0}, {1, -1, 0}}, on(2))
                                      : cable(on(2), {{1, 1, 0}, {0, 1, 0}}, rim));
    World world = make_world(scene, Method::pinch);
    run(scene, world, 19);
    const std::vector<Segment>& s = world.cables[0].segments;
    const std::size_t last = s.size() - 1;
    const double wrap = world.cables[0].links[from_start ? last - 1 : 1].wrap;
    run(scene, world, 1);
    ASSERT_EQ(s.size(), last + 1);
    const double hangs = s[from_start ? last : 1].tension;
    const double winch = s[from_start ? last - 1 : 2].tension;
    EXPECT_NEAR(hangs, 2.0 * g, 0.5);
    EXPECT_EQ(world.cables[0].links.size(), 5U);
    EXPECT_NEAR(std::max(hangs / winch, winch / hangs), std::exp(mu * wrap), 1e-9);
  }
}

/// A polygon with its corners there.
Body polygon_of(const char* name, BodyKind kind, std::vector<Vec2> corners) {
  const Vec2 centre = plate_of(corners, 0.0).centre;
  for (Vec2& corner : corners) corner -= centre;
  return polygon(name, kind, centre, std::move(corners));
}

// A wedge comes down beside a post, under whose tip the cable runs that goes on from under the
// wedge's one corner: the other takes it off the tip as it comes past that. It went by beyond the
// end of the span, and the wedge stood across the cable from then on.
TEST(Corners, TakeACableOffATipThatTheyComePast) {
  for (const bool leaves : {true, false}) {
    Scene scene;
    scene.gravity = Vec2::Zero();
    scene.bodies.push_back(
        polygon_of("post", BodyKind::fixed, {{0.0, 0.0}, {0.5, 0.6}, {0.0, 0.8}}));
    scene.bodies.push_back(
        polygon_of("wedge", BodyKind::free, {{-0.8, 0.3}, {-0.08, 0.155}, {-0.4, 0.7}}));
    scene.bodies[1].velocity = {0.5, -1.0};
    const Attachment left = build::at(-2.0, 1.0), right = build::at(1.5, 0.5);
    scene.cables.push_back(leaves ? cable(left, {{1, 1, 0}, {0, 1, 0}}, right, 0.02)
                                  : cable(right, {{0, -1, 0}, {1, -1, 0}}, left, 0.02));
    scene.cables[0].slack = 2.0;
    for (const int steps : {1, 4, 16}) {
      const World world = after(scene, steps, 0.4);
      const std::vector<Link>& links = world.cables[0].links;
      ASSERT_EQ(links.size(), 4U) << steps;
      for (const std::size_t i : {1U, 2U}) EXPECT_EQ(links[i].body, 1) << steps;
      EXPECT_EQ(world.velocity[1], scene.bodies[1].velocity) << steps;
    }
  }
}

/// A disc on a cable that lies along the top of a fixed box, without slip on it; gravity slopes.
Scene disc_on_cable_on_box(double slope, double friction) {
  Scene scene;
  scene.gravity = g * Vec2(std::sin(slope), -std::cos(slope));
  scene.bodies.push_back(
      polygon("box", BodyKind::fixed, Vec2::Zero(), box_corners(6.0, 0.4), 1.0, 0.02));
  scene.bodies.push_back(body("disc", BodyKind::free, -2.0, 0.22 + 0.1 + 0.3, 0.3, 2.0));
  scene.bodies[1].cable_friction = friction;
  scene.cables.push_back(cable(build::at(-4.0, -0.5), {{0, -1, 0}}, build::at(4.0, -0.5)));
  return scene;
}

// At a pinch a cable rolls by its centre line: without slip v = omega (r + w), and a = g sin(slope)
// / (1 + I / m (r + w)^2); with little friction it slides, at a = g (sin - mu cos).
TEST(Corners, WhatPressesACableOnASideRollsOnItOrRubs) {
  const double slope = 0.3, inertia = 0.5 * 2.0 * 0.3 * 0.3, lever = 0.35;
  for (const double friction : {infinity, 0.5, 0.04, 0.0}) {
    const Scene scene = disc_on_cable_on_box(slope, friction);
    World world = make_world(scene, measured());
    run(scene, world, 240);
    const double t = world.time(), v = world.velocity[1].x(), w = world.angular_velocity[1];
    const bool rolls = friction > 0.2;
    const double a = rolls ? g * std::sin(slope) / (1.0 + inertia / (2.0 * lever * lever))
                           : g * (std::sin(slope) - friction * std::cos(slope));
    EXPECT_NEAR(world.position[1].x(), -2.0 + 0.5 * a * t * t, 1e-9) << friction;
    EXPECT_NEAR(world.position[1].y(), 0.62, 1e-12);
    if (rolls) {
      EXPECT_NEAR(v, -w * lever, 1e-9) << friction;
    }
    if (friction == 0.0) {
      EXPECT_EQ(w, 0.0);
    }
  }
}

// A crate on the cable of a drum stands on it as on rubber: it turns with the drum about its axle.
TEST(Corners, ACrateStandsOnACableOnADisc) {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.5, 1.0));
  scene.bodies[0].driven_angular_velocity = -0.1;
  scene.bodies.push_back(
      polygon("crate", BodyKind::free, {0.0, 0.6 + 0.15}, box_corners(0.4, 0.3)));
  scene.cables.push_back(cable(build::at(-0.55, -3.0), {{0, -1, 0}}, build::at(0.55, -3.0)));
  scene.cables[0].slack = 4.0;  // enough to run
  World world = make_world(scene, Method::pinch);
  run(scene, world, 120);
  // Where it touches, the crate's side and the cable's centre line have one speed.
  const double lever = 0.55;
  const Vec2 n = Vec2(-std::sin(world.angle[1]), std::cos(world.angle[1]));
  const Vec2 along(n.y(), -n.x());
  const double crate = along.dot(world.velocity[1]) - world.angular_velocity[1] * -(0.15 + 0.05);
  EXPECT_NEAR(crate, 0.1 * lever, 0.02);
}

// Ten boxes, each with a slack cable over its top on which the next one stands.
TEST(Corners, TenBoxesStandOnCablesOnOneAnother) {
  const double w = 0.01;
  Scene scene;
  scene.walls.push_back({{-3.0, 0.0}, {3.0, 0.0}, 0.5, 0.0});
  for (int i = 0; i < 10; ++i) {
    const double y = 0.15 + (0.3 + 2.0 * w) * i;
    scene.bodies.push_back(
        polygon("box", BodyKind::free, {0.02 * (i % 3), y}, box_corners(0.5, 0.3)));
    scene.bodies.back().name += std::to_string(i);
    if (i == 9) continue;
    scene.cables.push_back(
        cable(build::at(-1.0, y - 0.1), {{i, -1, 0}}, build::at(1.0, y - 0.1), w));
    scene.cables.back().name = std::to_string(i);
    scene.cables.back().slack = 0.01;
  }
  World world = make_world(scene, measured());
  run(scene, world, 720);
  for (std::size_t b = 0; b < 10; ++b) {
    EXPECT_LT(world.velocity[b].norm(), 1e-9) << b;
    EXPECT_LT(std::abs(world.angular_velocity[b]), 1e-9) << b;
    EXPECT_NEAR(world.position[b].y(), 0.15 + (0.3 + 2.0 * w) * static_cast<double>(b), 1e-6 * w)
        << b;
  }
}

}  // namespace
}  // namespace pinchlab::testing
