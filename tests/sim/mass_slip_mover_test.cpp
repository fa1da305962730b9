// SPDX-License-Identifier: GPL-3.0-or-later
// Cables with mass that slip on polygons and shapes of compounds that move.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "demos/scenes/shape_scenes.h"
#include "sim/cable/mass.h"
#include "sim/cable/sleeve.h"
#include "sim/compound.h"
#include "sim/outline.h"
#include "sim/tangent.h"
#include "tests/sim/course.h"
#include "tests/sim/image.h"
#include "tests/sim/momentum.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using build::regular_corners;
using std::numbers::pi;

constexpr double w = 0.01;  // m

Body mover(BodyKind kind, double x, double y, double mass, double inertia) {
  Body b = body("mover", kind, x, y, 0.3, mass);
  b.rail_axis = Vec2(0.6, 0.8);
  b.inertia = inertia;
  return b;
}

/// A bob on a rope over a polygon, or over two discs of a compound, to a weight. One that is free
/// hangs from a bar.
Scene swinging_over(int steps, double mu, BodyKind kind, int corners) {
  Scene scene;
  scene.steps_per_frame = steps;
  scene.bodies.push_back(body("bob", BodyKind::free, 1.0, -0.6, 0.05, 0.5));
  scene.bodies.push_back(body("weight", BodyKind::free, -0.3, -0.8, 0.05, 0.9));
  scene.bodies.push_back(mover(kind, 0.0, 0.0, 3.0, 0.05));
  if (corners > 0) {
    Body& b = scene.bodies[2];
    make_polygon(b, regular_corners(corners, 0.19 / std::cos(pi / corners)), 0.02);
    b.cable_friction = mu;
    scene.cables.push_back(cable(on(1), {{2, -1, 0}}, on(0), w));
  } else {
    Shape disc;
    disc.properties.cable_friction = mu;
    disc.properties.radius = 0.15;
    disc.place = {0.1, 0.05};
    Shape other = disc;
    other.properties.radius = 0.1;
    other.place = {-0.12, 0.0};
    add_shapes(scene, 2, std::array{disc, other});
    scene.cables.push_back(cable(on(1), {{4, -1, 0}, {3, -1, 0}}, on(0), w));
  }
  scene.cables[0].mass_per_metre = 0.5;
  if (kind == BodyKind::free) add_bar(scene, "bar", {-1, {0.0, 2.0}}, on(2));
  return scene;
}

constexpr std::array movers = {BodyKind::free, BodyKind::rail, BodyKind::fixed_axle};

// To round-off, until the rope comes to another corner or off one: what joins a corner there is not
// yet rubbed at.
TEST(MassSlipOnMovers, WhatSticksMovesAsIfItCouldNotSlip) {
  for (const BodyKind kind : movers) {
    for (const int corners : {0, 3, 4, 6}) {
      const Scene fast = swinging_over(16, infinity, kind, corners);
      const Scene sticking = swinging_over(16, 30.0, kind, corners);
      World a = make_world(fast, Method::pinch), b = make_world(sticking, Method::pinch);
      Workspace work_a, work_b;
      double apart = 0.0, turned = 0.0;
      for (int i = 0; a.changes == 0 && b.changes == 0 && i < 16 * 40; ++i) {
        ASSERT_EQ(step(fast, a, work_a), StepStatus::ok) << a.failure;
        ASSERT_EQ(step(sticking, b, work_b), StepStatus::ok) << b.failure;
        if (a.changes != 0 || b.changes != 0) break;
        for (std::size_t k = 0; k < 3; ++k) {
          apart = std::max(
              {apart, (a.position[k] - b.position[k]).norm(), std::abs(a.angle[k] - b.angle[k])});
        }
        turned = std::max(turned, std::abs(b.angle[2]));
      }
      EXPECT_LT(apart, 1e-9) << static_cast<int>(kind) << ", " << corners;
      EXPECT_GT(turned, 0.005) << static_cast<int>(kind) << ", " << corners;
    }
  }
}

// What a limited motor has to turn is the polygon alone: the rope that rubs on it has an inertia of
// its own, which its body only holds for it. Counted twice, it would hold back the start.
TEST(MassSlipOnMovers, WhatSticksIsTurnedByALimitedMotorAsIfItCouldNotSlip) {
  for (const int corners : {3, 4, 6}) {
    std::vector<double> ends[2];
    for (const int slips : {0, 1}) {
      Scene scene = swinging_over(16, slips == 1 ? 30.0 : infinity, BodyKind::fixed_axle, corners);
      scene.bodies[0].position = {0.3, -0.8};
      scene.bodies[2].driven_angular_velocity = -6.0;
      scene.bodies[2].torque_limit = 4.0;
      const Course course = run_measured(scene, 0.3);
      ends[slips] = course.end;
      EXPECT_GT(std::abs(course.end[8]), 0.2) << corners;
    }
    EXPECT_LT(largest_difference(ends[0], ends[1]), 1e-9) << corners;
  }
}

// Second order through corners that the rope comes off and on to.
TEST(MassSlipOnMovers, SwingsOnSecondOrder) {
  for (const BodyKind kind : movers) {
    for (const int corners : {0, 4, 6}) {
      for (const double mu : {0.0, 0.1}) {
        const Course exact = run_measured(swinging_over(256, mu, kind, corners), 0.7);
        double first = 0.0, last = 0.0;
        for (const int steps : {4, 8, 16, 32}) {
          const Course course = run_measured(swinging_over(steps, mu, kind, corners), 0.7);
          last = largest_difference(course.end, exact.end);
          if (steps == 4) first = last;
          EXPECT_LE(course.gained, 1e-3 / (steps * steps) * course.at_play) << steps;
        }
        EXPECT_GT(first / last, 40.0) << static_cast<int>(kind) << ", " << corners << ", " << mu;
      }
    }
  }
}

// Without friction, and until the rope comes to another corner, nothing is lost: what energy
// changes by falls with the square of the step.
TEST(MassSlipOnMovers, KeepsEnergyWhereNothingRubs) {
  for (const BodyKind kind : {BodyKind::rail, BodyKind::fixed_axle}) {
    for (const int corners : {0, 3}) {
      double error = 0.0;
      for (const int steps : {4, 16}) {
        const Scene scene = swinging_over(steps, 0.0, kind, corners);
        World world = make_world(scene, measured());
        const double now = energy_drift(scene, world, 6 * steps, [] {});
        EXPECT_EQ(world.changes, 0) << corners;
        EXPECT_GT(std::abs(world.cables[0].links[1].slip_speed), 0.02) << corners;
        if (error > 0.0) {
          EXPECT_GT(error / now, 14.5) << corners;
        }
        error = now;
      }
      EXPECT_LT(error, 1e-6);
    }
  }
}

/// Two weights on a rope over a square beam that goes up a rail, pulled by one that goes down: both
/// far heavier than the rope. Or over one that is fixed.
Scene over_beam(bool in_lift, double mu, double gravity) {
  Scene scene;
  scene.gravity = Vec2(0.0, -gravity);
  constexpr double heavy = 1e8, side = 0.4, out = 0.5 * side + w;
  scene.bodies.push_back(body("left", BodyKind::free, -out, -0.9, 0.05, 0.3));
  scene.bodies.push_back(body("right", BodyKind::free, out, -0.7, 0.05, 4.0));
  Body beam = body("beam", in_lift ? BodyKind::rail : BodyKind::fixed, 0.0, 0.0, 1.0, heavy);
  make_polygon(beam, regular_corners(4, 0.5 * side * std::numbers::sqrt2), 0.0);
  beam.rail_axis = Vec2(0.0, 1.0);
  beam.inertia = heavy;
  beam.cable_friction = mu;
  scene.bodies.push_back(beam);
  scene.cables.push_back(cable(on(0), {{2, -1, 0}}, on(1), w));
  scene.cables[0].mass_per_metre = 0.8;
  if (!in_lift) return scene;
  scene.bodies.push_back(body("falls", BodyKind::free, 3.0, -2.0, 0.1, 3.0 * heavy));
  scene.bodies.push_back(body("pulley", BodyKind::fixed, 1.5, 4.0, 1.5 - w));
  scene.bodies[4].cable_friction = 0.0;
  scene.cables.push_back(cable(on(2), {{4, -1, 0}}, on(3), w));
  return scene;
}

// What accelerates up by a half of gravity presses as three halves of it do: round the corners, and
// along the top.
TEST(MassSlipOnMovers, SlidesInALiftAsUnderMoreGravity) {
  for (const double mu : {0.0, 0.1, 0.3}) {
    double error = 0.0;
    for (const int steps : {4, 16}) {
      Scene in_lift = over_beam(true, mu, g), fixed = over_beam(false, mu, 1.5 * g);
      in_lift.steps_per_frame = fixed.steps_per_frame = steps;
      World moves = make_world(in_lift, Method::pinch), stands = make_world(fixed, Method::pinch);
      run(in_lift, moves, 20 * steps);
      run(fixed, stands, 20 * steps);
      const Vec2& up = moves.position[2];
      EXPECT_NEAR(up.y(), 0.25 * g * moves.time() * moves.time(), 1e-6);
      double apart = 0.0;
      for (std::size_t b = 0; b < 2; ++b) {
        apart = std::max(apart, (moves.position[b] - up - stands.position[b]).norm());
      }
      if (error > 0.0) {
        EXPECT_TRUE(error / apart > 14.5) << mu << ": " << error << ", " << apart;
      }
      error = apart;
      EXPECT_GT(std::abs(stands.position[0].y() + 0.9), 0.05) << mu;
    }
    EXPECT_LT(error, 1e-6);
  }
}

// Two weights whirl about a polygon, or a compound, that flies and turns. Of the angular momentum
// what the rope's span loses as a corner divides it is left out: half of it is at either end. Of
// order 1.5 at least over a ladder of 16: where in a step a corner comes on makes errors uneven.
TEST(MassSlipOnMovers, KeepsMomentumInFreeFlight) {
  for (const int corners : {0, 5}) {
    for (const double mu : {0.0, 0.15}) {
      double error = 0.0;
      for (const int steps : {4, 64}) {
        Scene scene = swinging_over(steps, mu, BodyKind::free, corners);
        scene.cables.pop_back();
        scene.gravity = Vec2::Zero();
        scene.bodies[0].velocity = {-0.4, -2.0};
        scene.bodies[1].velocity = {0.8, -1.0};
        scene.bodies[2].velocity = {0.1, 1.0};
        scene.bodies[2].angular_velocity = -1.0;
        World world = make_world(scene, Method::pinch);
        run(scene, world, steps);
        const Eigen::Vector3d start = momentum_of(scene, world);
        run(scene, world, 15 * steps);
        Eigen::Vector3d change = momentum_of(scene, world) - start;
        if (corners > 0) {
          EXPECT_GT(world.changes, 0);
          change.z() = 0.0;
        }
        if (error > 0.0) {
          EXPECT_GT(error / change.norm(), 64.0) << corners << ", " << mu;
        }
        error = change.norm();
      }
      EXPECT_LT(error, 5e-8) << corners << ", " << mu;
    }
  }
}

// A polygon of n corners tends to the disc as 1 / n^2, friction and all. Under a heavy rope that it
// slips through it does so as 1 / n, as each corner strikes the rope.
TEST(MassSlipOnMovers, APolygonOfManyCornersMovesAsADisc) {
  const auto end = [](int corners, BodyKind kind, double density, double mu) {
    Scene scene;
    scene.bodies.push_back(body("left", BodyKind::free, -0.2, -0.5, 0.05, 0.4));
    scene.bodies.push_back(body("right", BodyKind::free, 0.2, -0.5, 0.05, 1.0));
    Body b = body("mover", kind, 0.0, 0.0, 0.2 - w, 2.0);
    b.rail_axis = Vec2(0.0, 1.0);
    b.inertia = 0.04;
    b.angular_velocity = 6.0;
    b.cable_friction = mu;
    if (corners > 0) make_polygon(b, regular_corners(corners, 0.2 - w - 0.05), 0.05);
    scene.bodies.push_back(b);
    scene.cables.push_back(cable(on(0), {{2, -1, 0}}, on(1), w));
    scene.cables[0].mass_per_metre = density;
    if (kind == BodyKind::rail) add_spring(scene, "spring", {-1, {0.0, 1.0}}, on(2), 400.0, 0.9, 0);
    return run_measured(scene, 0.4).end;
  };
  for (const BodyKind kind : {BodyKind::fixed_axle, BodyKind::rail}) {
    for (const double mu : {0.0, 0.2}) {
      const auto error = [&](int corners, double density) {
        return largest_difference(end(corners, kind, density, mu), end(0, kind, density, mu));
      };
      EXPECT_GT(error(30, 1e-3) / error(60, 1e-3), 3.5) << mu;
      EXPECT_LT(error(60, 1e-3), 1e-3) << mu;
      if (mu == 0.0) {
        EXPECT_NEAR(error(30, 0.8) / error(60, 0.8), 2.0, 0.1);
      }
    }
  }
}

/// The scene's rope over polygons and compounds that are fixed, turn, or move along rails.
Scene over_movers(Scene scene, unsigned seed) {
  Random random(seed + 4000);
  const std::size_t count = scene.bodies.size();
  for (std::size_t i = 0; i < count; ++i) {
    Body& b = scene.bodies[i];
    const int what = random.below(4);
    if (!b.name.starts_with("pulley") || what == 0) continue;
    b.kind = what == 1 ? BodyKind::fixed : what == 2 ? BodyKind::fixed_axle : BodyKind::rail;
    const double along = random.uniform(0.0, pi);
    b.rail_axis = Vec2(std::cos(along), std::sin(along));
    b.mass = random.uniform(1.0, 30.0);
    b.inertia = 0.5 * b.mass * b.radius * b.radius;
    b.angle = random.uniform(0.0, 2.0 * pi);
    const double mu = random.below(3) == 0 ? 0.0 : random.uniform(0.02, 0.6);
    const double rounded = random.below(3) == 0 ? 0.0 : random.uniform(0.0, 0.05);
    const std::vector<Vec2> corners = regular_corners(3 + random.below(6), b.radius);
    if (random.below(3) > 0) {
      make_polygon(b, corners, rounded);
      b.cable_friction = mu;
      continue;
    }
    Shape shape;
    shape.properties.cable_friction = mu;
    shape.properties.radius = b.radius;
    if (random.below(2) == 0) make_polygon(shape.properties, corners, rounded);
    shape.place = 0.3 * b.radius * Vec2(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    const int first = static_cast<int>(scene.bodies.size());
    add_shapes(scene, static_cast<int>(i), std::array{shape});
    for (Wrap& wrap : scene.cables[0].wraps) {
      if (wrap.body == static_cast<int>(i)) wrap.body = first;
    }
  }
  return scene;
}

Scene slipping_over_movers(unsigned seed) {
  Scene scene = slipping_rope(seed);
  scene.cables[0].axial_stiffness = infinity;
  return over_movers(scene, seed);
}

// The same bounds as on discs (RandomMassSlip).
TEST(RandomMassSlipOnMovers, StaysFiniteAndMakesNoEnergy) {
  int carried_round = 0;
  for (unsigned seed = 0; seed < seeds_of(120U); ++seed) {
    for (const int steps : {1, 4, 16}) {
      Scene scene = slipping_over_movers(seed);
      scene.steps_per_frame = steps;
      std::vector<Sleeve> sleeves;
      const World start = make_world(scene, Method::pinch);
      list_sleeves(start, 0, sleeves);
      for (const Sleeve& one : sleeves) carried_round += is_carried_round(start, one) ? 1 : 0;
      expect_sound(scene, run_measured(scene, 1.5), swing_of_heavy_ropes / (steps * steps), seed);
    }
  }
  EXPECT_GT(carried_round, seeds_of(300));
}

// The same ropes as far as they stretch. As for discs (RandomMassSlip.StretchesAndMakesNoEnergy):
// seed 161 made 650 times the energy at play at 16 steps a frame.
TEST(RandomMassSlipOnMovers, StretchesAndMakesNoEnergy) {
  int ran = 0;
  const auto run_of = [&ran](unsigned seed, int steps) {
    Scene scene = over_movers(slipping_rope(seed), seed);
    if (!(scene.cables[0].axial_stiffness < infinity)) return;
    scene.steps_per_frame = steps;
    const Course course = run_measured(scene, 1.5);
    EXPECT_LE(course.gained, (steps == 1 ? 5e-3 : 3e-4) * course.at_play) << seed << ", " << steps;
    EXPECT_LE(course.gap, 1e-6 * scene.cables[0].half_width) << seed << ", " << steps;
    ++ran;
  };
  for (unsigned seed = 0; seed < seeds_of(60U); ++seed) {
    for (const int steps : {1, 4, 16}) run_of(seed, steps);
  }
  EXPECT_GT(ran, seeds_of(45));
  run_of(161, 16);
  for (const unsigned seed : {294U, 303U, 359U}) run_of(seed, 1);
}

/// The same rope, hanging by nodes: on what slips, or on what does not.
Scene strung_over_movers(unsigned seed, bool slips) {
  Scene scene = over_movers(slipping_rope(seed), seed);
  scene.cables[0].axial_stiffness = infinity;
  scene.cables[0].nodes = 12 + static_cast<int>(seed) % 20;
  for (Body& b : scene.bodies) {
    if (!slips) b.cable_friction = infinity;
  }
  spread_nodes(scene);
  return scene;
}

// As of ropes over discs (RandomStrung).
TEST(RandomMassSlipOnMovers, HangsByNodesAndMakesNoEnergy) {
  for (unsigned seed = 0; seed < seeds_of(30U); ++seed) {
    for (const int steps : {1, 4, 16}) {
      Scene scene = strung_over_movers(seed, true);
      scene.steps_per_frame = steps;
      expect_sound(scene, run_measured(scene, 1.2), 2e-4, seed);
    }
  }
}

// A corner beside the span into which a rim gives off a node: it was taken to have come from where
// it had been before the interval, past the span where that is now, and the rope to go round its
// other side.
TEST(RandomMassSlipOnMovers, ANodeIsGivenOffBesideACorner) {
  for (const auto& [seed, steps, slips] :
       std::vector<std::tuple<unsigned, int, bool>>{{0, 1, true},
                                                    {2, 1, true},
                                                    {18, 4, true},
                                                    {44, 1, true},
                                                    {9, 1, false},
                                                    {5, 1, false}}) {
    Scene scene = strung_over_movers(seed, slips);
    scene.steps_per_frame = steps;
    expect_sound(scene, run_measured(scene, 1.2), 2e-4, seed);
  }
  for (const unsigned seed : {0U, 9U, 36U}) {  // elastic ones made 0.6 to 48 times what is at play
    Scene scene = strung_over_movers(seed, true);
    scene.cables[0].axial_stiffness = slipping_rope(seed).cables[0].axial_stiffness;
    ASSERT_LT(scene.cables[0].axial_stiffness, infinity);
    scene.steps_per_frame = 1;
    const Course course = run_measured(scene, 1.2);
    EXPECT_LE(course.gained, 1e-3 * course.at_play) << seed;
  }
}

TEST(RandomMassSlipOnMovers, AClearedWorkspaceChangesNoBit) {
  for (unsigned seed = 0; seed < seeds_of(30U); ++seed) {
    EXPECT_TRUE(is_all_state(slipping_over_movers(seed), Method::pinch, 200)) << seed;
  }
}

// Corners that are turned by an angle lie elsewhere by round-off than those turned back, and
// what is met by a hair is so as much earlier or later.
TEST(RandomMassSlipOnMovers, ImageMovesAsTheImage) {
  for (unsigned seed = 0; seed < seeds_of(30U); ++seed) {
    expect_moves_as_image(slipping_over_movers(seed), 120, 1e-8, seed);
  }
}

}  // namespace
}  // namespace pinchlab::testing
