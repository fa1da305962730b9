// SPDX-License-Identifier: GPL-3.0-or-later
// Elastic cables without mass on drums, smooth and rough, and round corners.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "demos/scenes/shape_scenes.h"
#include "sim/cable/cable.h"
#include "sim/cable/creep.h"
#include "sim/diagnostics.h"
#include "sim/outline.h"
#include "sim/tangent.h"
#include "tests/sim/course.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using std::numbers::pi;

constexpr double soft = 200.0;  // N: the weights of these scenes stretch it by a tenth
constexpr double radius = 0.3;  // m, of the cable's centre line on the drum

/// Weights of so many kg (`right` at a place) on a cable over a smooth drum.
Scene over_drum(int steps, double left, double right, const Vec2& at_right) {
  Scene scene;
  scene.steps_per_frame = steps;
  scene.bodies.push_back(body("left", BodyKind::free, -radius, -1.4, 0.05, left));
  scene.bodies.push_back(body("right", BodyKind::free, at_right.x(), at_right.y(), 0.05, right));
  scene.bodies.push_back(body("drum", BodyKind::fixed, 0.0, 0.0, radius - 0.01));
  scene.bodies[2].cable_friction = 0.0;
  scene.cables.push_back(cable(on(0), {{2, -1, 0}}, on(1), 0.01));
  scene.cables[0].axial_stiffness = soft;
  return scene;
}

// What came on to the drum left its stretch behind in the span, and made 0.18 J of 4 J at any step.
// With a weight that hangs straight down nothing pulls it aside.
TEST(Relax, ABobOverASmoothDrumSwingsOnSecondOrder) {
  const auto run_of = [](int steps) {
    return run_measured(over_drum(steps, 2.0, 1.5, {0.8, -1.0}), 0.5);
  };
  const Course coarse = run_of(4), fine = run_of(16);
  EXPECT_NEAR(coarse.energy / fine.energy, 16.0, 0.5);
  EXPECT_LT(fine.energy, 5e-5 * fine.at_play);
  EXPECT_NEAR(fine.end[0], -radius, 1e-12);
}

// Two equal weights go up and down as one on the whole of the cable M, what lies on the drum
// included: m y'' = m g - EA (2 y + pi r - M) / M, y being either's span and M = 2 y_0 + pi r.
TEST(Relax, WhatLiesOnASmoothDrumStretchesToo) {
  constexpr double m = 2.0, y = 1.4, material = 2.0 * y + pi * radius;
  const double omega = std::sqrt(2.0 * soft / (m * material));
  const auto error_of = [&](int steps) {
    const Scene scene = over_drum(steps, m, m, {radius, -y});
    World world = make_world(scene, measured());
    double largest = 0.0;
    for (int i = 0; i < 40 * steps; ++i) {
      run(scene, world, 1);
      const double fallen = g / (omega * omega) * (1.0 - std::cos(omega * world.time()));
      largest = std::max(largest, std::abs(-y - world.position[0].y() - fallen));
      largest = std::max(largest, std::abs(world.position[0].y() - world.position[1].y()));
    }
    return largest;
  };
  const double coarse = error_of(4), fine = error_of(16);
  EXPECT_NEAR(coarse / fine, 16.0, 0.5);
  EXPECT_LT(fine, 5e-5);
}

// A closed cable that slides all around: no rim holds it anywhere.
TEST(Relax, AClosedCableIsStretchedAllAround) {
  const auto swing_of = [](int steps) {
    Scene scene;
    scene.steps_per_frame = steps;
    scene.bodies.push_back(body("peg", BodyKind::fixed, 0.0, 0.0, 0.2));
    scene.bodies.push_back(body("weight", BodyKind::free, 0.0, -1.5, 0.3, 3.0));
    for (Body& one : scene.bodies) one.cable_friction = 0.0;
    Cable belt = cable({}, {{0, -1, 0}, {1, -1, 0}}, {}, 0.02);
    belt.closed = true;
    belt.axial_stiffness = soft;
    scene.cables.push_back(belt);
    World world = make_world(scene, measured());
    Workspace work;
    double first = 0.0, swing = 0.0;
    for (int i = 0; i < 60 * steps; ++i) {
      EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      if (i == 0) first = world.diagnostics.energy;
      swing = std::max(swing, std::abs(world.diagnostics.energy - first));
      EXPECT_LT(world.diagnostics.cable_length_error, 1e-13);
      const CableState& rope = world.cables[0];
      const double stretched = rope.segments[0].length / rope.segments[0].rest_length;
      for (std::size_t k = 0; k < 2; ++k) {
        const Segment& span = rope.segments[k];
        EXPECT_NEAR(span.length, stretched * span.rest_length, 1e-12);
        const double lies = wrapped_material(world, rope, k);
        EXPECT_NEAR(stored_length(rope.links[k]), stretched * lies, 1e-12);
      }
    }
    EXPECT_NEAR(world.position[1].x(), 0.0, 1e-12);
    return swing;
  };
  const double coarse = swing_of(4), fine = swing_of(16);
  EXPECT_NEAR(coarse / fine, 16.0, 0.5);
  EXPECT_LT(fine, 5e-4);
}

/// A weight of 2 kg, 1 m below a drum that stands, on a cable from the world at its other side.
Scene over_bollard(int steps, double friction, double drag) {
  Scene scene;
  scene.steps_per_frame = steps;
  scene.bodies.push_back(body("weight", BodyKind::free, radius, -1.0, 0.05, 2.0));
  scene.bodies.push_back(body("drum", BodyKind::fixed, 0.0, 0.0, radius - 0.01));
  scene.bodies[0].linear_drag = drag;
  scene.bodies[1].cable_friction = friction;
  scene.cables.push_back(cable(at(-radius, -1.0), {{1, -1, 0}}, on(0), 0.01));
  scene.cables[0].axial_stiffness = soft;
  return scene;
}

// A braked weight sinks on an elastic cable that slides over a rough drum: at rest its strain is
// e1 = W / EA below it, e0 = e1 exp(-mu pi) at the other side, and what lies on the drum is
// R (pi - ln((1 + e1) / (1 + e0)) / mu) of material. It lay there unstretched before, and weights
// sank by 139 mm instead of 200 at mu = 0.3. So they did on what hardly weighs anything.
TEST(Relax, WhatSlidesOverARoughDrumIsStretchedAsItIsPulled) {
  for (const auto& [friction, mass_per_metre] :
       {std::pair(0.05, 0.0), {0.3, 0.0}, {1.0, 0.0}, {0.05, 1e-6}, {0.3, 1e-6}, {1.0, 1e-6}}) {
    for (const int steps : {1, 4, 16}) {
      Scene scene = over_bollard(steps, friction, 20.0);
      scene.cables[0].mass_per_metre = mass_per_metre;
      World world = make_world(scene, measured());
      const double all = world.cables[0].length;
      run(scene, world, 8 * 60 * steps);
      const double below = 2.0 * g / soft, above = below * std::exp(-friction * pi);
      const double lies = radius * (pi - std::log((1.0 + below) / (1.0 + above)) / friction);
      const double hangs = (all - 1.0 / (1.0 + above) - lies) * (1.0 + below);
      // What has mass lies on the drum in 24 parts, each stretched as at its middle.
      const double rounding = mass_per_metre == 0.0 ? 1e-6 : 1e-4;
      EXPECT_NEAR(wrapped_material(world, world.cables[0], 1), lies, rounding) << friction;
      EXPECT_NEAR(-world.position[0].y(), hangs, 2.0 * rounding) << friction;
      EXPECT_EQ(world.diagnostics.fallbacks, 0) << friction << ", " << steps;
    }
  }
}

// Dropped, it bounces until friction holds the cable. If what lies on the drum kept the strain that
// it had come on with while it slides, half of the energy at play would come from nothing.
TEST(Relax, RoughDrumsMakeNoEnergy) {
  for (const double friction : {0.02, 0.1, 0.3, 1.0, 3.0}) {
    for (const int steps : {1, 4, 16}) {
      const Course course = run_measured(over_bollard(steps, friction, 0.0), 4.0);
      EXPECT_LE(course.gained, 1e-6 * course.at_play) << friction << ", " << steps;
    }
  }
}

/// Two weights on a cable over a drum that stands, or over so many pegs in its place, each of which
/// holds the cable by itself, in spans that are a part of the drum's rim each.
Scene over_pegs(int steps, double friction, int pegs) {
  constexpr double thick = 0.002, thin = 0.004;  // m, half the cable, and a peg
  Scene scene;
  scene.steps_per_frame = steps;
  scene.bodies.push_back(body("left", BodyKind::free, -radius, -1.5, 0.1, 1.0));
  scene.bodies.push_back(body("right", BodyKind::free, radius, -1.0, 0.1, 2.0));
  std::vector<Wrap> wraps;
  const auto add = [&](double x, double y, double r) {
    wraps.push_back({static_cast<int>(scene.bodies.size()), -1, 0});
    scene.bodies.push_back(body(fmt::format("peg {}", wraps.size()), BodyKind::fixed, x, y, r));
    scene.bodies.back().cable_friction = friction;
  };
  if (pegs == 0) add(0.0, 0.0, radius - thick);
  for (int i = 0; i < pegs; ++i) {
    const double angle = pi * (1.0 - static_cast<double>(i) / (pegs - 1));
    const double from = radius - thin - thick;
    add(from * std::cos(angle), from * std::sin(angle), thin);
  }
  scene.cables.push_back(cable(on(0), wraps, on(1), thick));
  scene.cables[0].axial_stiffness = 2.5 * soft;
  scene.cables[0].creep = pegs == 0;
  return scene;
}

// The weights swing, and the cable slides on a part of the drum, or on all of it, to and fro: as
// over many pegs (over more than twenty it stuck: they come to slide one after another, which took
// more rounds than a solve has). Where rims carried what is not stretched it slid by a tenth to two
// thirds less.
TEST(Relax, ARoughDrumIsLikeManyPegs) {
  for (const double friction : {0.1, 0.2, 0.3}) {
    const auto sunk_by = [friction](int pegs) {
      const Scene scene = over_pegs(16, friction, pegs);
      World world = make_world(scene, measured());
      run(scene, world, 24 * 16);
      EXPECT_EQ(world.diagnostics.fallbacks, 0) << friction << ", " << pegs;
      return -1.0 - world.position[1].y();
    };
    for (const int many : {12, 48}) {
      const double drum = sunk_by(0), pegs = sunk_by(many);
      EXPECT_NEAR(drum, pegs, 0.03 * pegs) << friction << ", " << many;
    }
  }
}

TEST(Relax, WhatSlidesDoesSoOnSecondOrder) {
  const auto end_of = [](int steps) {
    Scene scene = over_pegs(steps, 0.05, 0);
    scene.bodies[1].mass = 4.0;
    World world = make_world(scene, measured());
    run(scene, world, 14 * steps);
    return world.position[1].y();
  };
  const double a = end_of(4), b = end_of(8), c = end_of(16), d = end_of(32);
  EXPECT_NEAR((a - b) / (b - c), 4.0, 0.2);
  EXPECT_NEAR((b - c) / (c - d), 4.0, 0.2);
}

// e^(mu theta) is more than numbers can tell: the cable is held, or pulled at by nothing.
TEST(Relax, ADrumMayBeAsRoughAsItLikes) {
  for (const double friction : {300.0, 1e9}) {
    const Course course = run_measured(over_bollard(4, friction, 0.0), 2.0);
    EXPECT_LE(course.gained, 1e-3 * course.at_play) << friction;
    EXPECT_LT(course.end[1], -1.0) << friction;
  }
}

/// A weight on a cable that a square winch takes in.
Scene square_winch(int steps) {
  Scene scene;
  scene.steps_per_frame = steps;
  scene.bodies.push_back(body("weight", BodyKind::free, 0.21, -2.0, 0.05, 2.0));
  Body winch = body("winch", BodyKind::fixed_axle, 0.0, 0.0, 0.2);
  make_polygon(winch, build::box_corners(0.2, 0.2), 0.0);
  winch.inertia = 1.0;
  winch.angular_velocity = 6.0;
  scene.bodies.push_back(winch);
  scene.cables.push_back(cable({1, {-0.2, 0.0}}, {{1, -1, 0}}, on(0), 0.03));
  scene.cables[0].axial_stiffness = soft;
  return scene;
}

// Corners carry on what comes on to them as stretched as it came, like discs. They carried it
// unstretched: 0.18 J came from nothing at any step.
TEST(Relax, CornersThatHoldACableCreep) {
  for (const int steps : {4, 16, 64}) {
    const Course course = run_measured(square_winch(steps), 0.5);
    EXPECT_LT(course.gained, 0.005 / (steps * steps)) << steps;
  }
}

}  // namespace
}  // namespace pinchlab::testing
