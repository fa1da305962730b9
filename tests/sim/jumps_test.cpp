// SPDX-License-Identifier: GPL-3.0-or-later
// Forces that jump though nothing meets, at their time: friction where what slides comes to rest,
// motors where their table has a corner or their limit ends, discs and corners that come to a
// corner. Where motion is straight in between it is exact. (Boxes on slopes, balls that roll off
// tables and cables that slip to and fro: tests/analysis/experiments/convergence_test.cpp.)

#include <algorithm>
#include <numbers>

#include "demos/scenes/shape_scenes.h"
#include "sim/joints.h"
#include "sim/outline.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

World moved(Scene scene, int steps_per_frame, double seconds) {
  scene.steps_per_frame = steps_per_frame;
  World world = make_world(scene, measured());
  run(scene, world, static_cast<int>(std::lround(seconds * 60.0 * steps_per_frame)));
  EXPECT_EQ(world.diagnostics.fallbacks, 0) << steps_per_frame;
  return world;
}

/// Loads on a cable over a drum, body 0 of `scene`: bodies 1 and 2.
void hang_loads(Scene& scene, double left, double right, double mass_per_metre = 0.0) {
  const double R = scene.bodies[0].radius + build::cable_half_width;
  scene.bodies.push_back(body("left", BodyKind::rail, -R, -3.0, 0.1, left));
  scene.bodies.push_back(body("right", BodyKind::rail, R, -3.0, 0.1, right));
  scene.cables.push_back(cable(on(1), {{0, -1, 0}}, on(2)));
  scene.cables[0].mass_per_metre = mass_per_metre;
}

/// A drum whose motor swings to and fro, the cable with friction `mu` on it.
Scene swinging_drum(double mu) {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.5, 5.0));
  Body& drum = scene.bodies[0];
  drum.motor = {{0.0, 6.0}, {0.503, -6.0}, {1.01, 6.0}, {1.497, -6.0}};
  drum.driven_angular_velocity = 6.0;
  drum.cable_friction = mu;
  return scene;
}

// With backspin omega a disc slides with v' = -mu g and omega' = -2 mu g / r (I = m r^2 / 2) until
// v = -omega r, at t = (v + omega r) / (3 mu g), and then rolls.
TEST(Jumps, ADiscWithBackspinSlidesAndThenRolls) {
  const double r = 0.2, mu = 0.3, v = 1.0, omega = 20.0;
  Scene scene;
  scene.walls.push_back({{-5.0, 0.0}, {5.0, 0.0}, mu, 0.0});
  scene.bodies.push_back(body("disc", BodyKind::free, 0.0, r, r));
  Body& disc = scene.bodies[0];
  disc.contact_friction = mu;
  disc.velocity = {v, 0.0};
  disc.angular_velocity = omega;
  const double slides = (v + omega * r) / (3.0 * mu * g), rolls = v - mu * g * slides;
  const double way = v * slides - 0.5 * mu * g * slides * slides + rolls * (1.0 - slides);
  for (const int n : {1, 4, 16, 64}) {
    const World world = moved(scene, n, 1.0);
    EXPECT_NEAR(world.position[0].x(), way, 1e-10) << n;
    EXPECT_NEAR(world.velocity[0].x(), rolls, 1e-9) << n;
  }
}

// On a spring a box that slides swings about places that lie mu m g / k off the middle, now to this
// side, now to that, and stays where it comes to rest within both.
TEST(Jumps, ABoxOnASpringSwingsWithFrictionAndStays) {
  const double k = 40.0, m = 1.0, mu = 0.3, start = 0.5;
  Scene scene;
  scene.walls.push_back({{-5.0, 0.0}, {5.0, 0.0}, mu, 0.0});
  Body box = body("box", BodyKind::free, start, 0.1, 1.0, m);
  make_polygon(box, build::box_corners(0.4, 0.2), 0.0);
  box.contact_friction = mu;
  scene.bodies.push_back(box);
  add_spring(scene, "spring", on(0), at(-1.0, 0.1), k, 1.0, 0.0);
  const double off = mu * m * g / k, half_period = std::numbers::pi * std::sqrt(m / k);
  const auto place = [&](double t) {
    double from = start;
    while (std::abs(from) > off) {
      const double middle = from > 0.0 ? off : -off;
      if (t < half_period) return middle + (from - middle) * std::cos(t * std::sqrt(k / m));
      t -= half_period;
      from = 2.0 * middle - from;
    }
    return from;
  };
  EXPECT_LT(half_period, 1.0);
  double before = 0.0;
  for (int n = 1; n <= 32; n *= 2) {
    double error = 0.0;
    for (const double t : {0.3, 0.7, 1.1}) {
      error = std::max(error, std::abs(moved(scene, n, t).position[0].x() - place(t)));
    }
    if (n > 1) {
      EXPECT_GT(std::log2(before / error), 1.9) << n << " steps a frame, " << error << " m";
    }
    before = error;
    EXPECT_NEAR(moved(scene, n, 3.0).position[0].x(), place(3.0), 1e-6) << n;
  }
  EXPECT_LT(before, 1e-5);
}

// A motor that gives torque M at most brings drum and loads to its speed with
// (I + (m1 + m2) R^2) alpha = M - (m2 - m1) g R.
TEST(Jumps, AMotorWithALimitComesToItsSpeed) {
  const double M = 8.0, I = 0.625, m1 = 1.0, m2 = 1.2, speed = 3.0;
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.5, 5.0));
  scene.bodies[0].inertia = I;
  scene.bodies[0].driven_angular_velocity = speed;
  scene.bodies[0].torque_limit = M;
  hang_loads(scene, m1, m2);
  const double R = 0.5 + build::cable_half_width;
  const double alpha = (M - (m2 - m1) * g * R) / (I + (m1 + m2) * R * R), comes = speed / alpha;
  EXPECT_GT(comes, 0.3);
  const double turned = 0.5 * alpha * comes * comes + speed * (1.0 - comes);
  for (const int n : {1, 4, 16}) {
    const World world = moved(scene, n, 1.0);
    EXPECT_NEAR(world.angle[0], turned, 1e-10) << n;
    EXPECT_NEAR(world.position[2].y(), -3.0 + R * turned, 1e-10) << n;
  }
}

// Corners of the table and the limit together: what is straight between is exact at every step.
TEST(Jumps, AMotorsTableTurnsWithinSteps) {
  Scene scene = swinging_drum(infinity);
  scene.bodies[0].torque_limit = 8.0;
  hang_loads(scene, 1.0, 1.2);
  const World reference = moved(scene, 64, 2.0);
  for (const int n : {1, 3, 4, 16}) {
    const World world = moved(scene, n, 2.0);
    EXPECT_NEAR(world.position[1].y(), reference.position[1].y(), 1e-7) << n;
    EXPECT_NEAR(world.angle[0], reference.angle[0], 1e-7) << n;
  }
}

// Where the motor turns round, a blow of nothing is solved for. Its round-off is no energy made:
// else the cable would be held on the drum for that, and throw the loads.
TEST(Jumps, ACableSlipsOnUnderAPinchThroughAnEvent) {
  Scene scene = swinging_drum(0.2);
  hang_loads(scene, 1.0, 1.0);
  scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, 0.8, 0.2));
  scene.bodies[3].cable_friction = 0.2;
  const World reference = moved(scene, 64, 2.0);
  EXPECT_LT(std::abs(reference.velocity[1].y()), 2.5);
  for (const int n : {1, 2, 3, 4, 8, 16}) {
    const World world = moved(scene, n, 2.0);
    EXPECT_NEAR(world.position[1].y(), reference.position[1].y(), 1e-7) << n;
    EXPECT_NEAR(world.angle[3], reference.angle[3], 1e-6) << n;
  }
}

// A blow by which nothing meets, or next to nothing, says nothing of how the cable slides that it
// does not pull, and what its round-off seems to make is no energy: the rollers' pulleys, which
// cable without tension slips on under their pinches, would else be stopped at once by some steps
// and not by others.
TEST(Jumps, CableThatABlowDoesNotPullSlipsOn) {
  struct Run {
    int seed, steps, frames;
  };
  for (const auto& [seed, steps, frames] : {Run{8, 32, 35}, {29, 64, 37}, {38, 64, 49}}) {
    const Scene scene = random_scene(seed);
    const double seconds = frames / 60.0;
    const World one = after(scene, steps, seconds), other = after(scene, 2 * steps, seconds);
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      EXPECT_LT((one.position[b] - other.position[b]).norm(), 1e-4) << seed << " " << b;
      EXPECT_NEAR(one.angle[b], other.angle[b], 1e-3) << seed << " " << b;
    }
  }
}

// 2 to 9 cm off where nothing is located.
TEST(Jumps, ARopeWithMassSlipsToAndFro) {
  Scene scene = swinging_drum(0.2);
  hang_loads(scene, 1.0, 1.0, 0.2);
  const World reference = moved(scene, 64, 2.0);
  for (const int n : {2, 4, 8}) {
    const World world = moved(scene, n, 2.0);
    EXPECT_NEAR(world.position[1].y(), reference.position[1].y(), 1e-4 / n) << n;
  }
}

// What presses a cable on a polygon is thrown off by its corners.
TEST(Jumps, ARollerIsThrownByADrumOfSixCorners) {
  Scene scene = swinging_drum(0.2);
  make_polygon(scene.bodies[0], build::regular_corners(6, 0.5, 0.0), 0.0);
  hang_loads(scene, 1.0, 1.0);
  scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, 0.5 * std::sqrt(0.75) + 0.3, 0.2));
  scene.bodies[3].cable_friction = 0.2;
  const World reference = moved(scene, 64, 0.45);
  for (const int n : {4, 8, 16}) {
    const World world = moved(scene, n, 0.45);
    for (std::size_t b = 1; b < 4; ++b) {
      EXPECT_LT((world.position[b] - reference.position[b]).norm(), 2e-3 / n) << n << ' ' << b;
    }
  }
}

// It rolls and slips on the cable, which rolls and slips on the drum; corner after corner comes by
// below. Where an interval after an event differs from that before it friction holds in its middle
// all the same: held at its start it may stick where it slides.
TEST(Jumps, ARollerOnCornersThatPassIsOfSecondOrder) {
  const auto after = [](int n) { return moved(build::pressed_drum(n), n, 0.6).position; };
  const std::vector<Vec2> reference = after(512);
  double before = 0.0;
  for (int n = 2; n <= 32; n *= 2) {
    const std::vector<Vec2> places = after(n);
    double error = 0.0;
    for (std::size_t b = 1; b < 4; ++b) {
      error = std::max(error, (places[b] - reference[b]).norm());
    }
    if (n > 2) {
      EXPECT_GT(std::log2(before / error), 1.8) << n << " steps a frame, " << error << " m";
    }
    before = error;
  }
  EXPECT_LT(before, 1e-7);
}

/// The most energy that what rolls over an edge gains (J).
double gained(Scene scene, int steps_per_frame) {
  scene.steps_per_frame = steps_per_frame;
  World world = make_world(scene, measured());
  return play(scene, world, 0.6).energy_gain;
}

TEST(Jumps, RollingOverAnEdgeMakesNoEnergy) {
  Scene on_wall;
  Body ball = body("ball", BodyKind::free, -0.513, 0.2, 0.2);
  ball.velocity = {2.0, 0.0};
  ball.angular_velocity = -10.0;
  on_wall.bodies.push_back(ball);
  on_wall.walls.push_back({{-5.0, 0.0}, {0.0, 0.0}, 0.8, 0.0});
  Scene on_table;
  Body table = body("table", BodyKind::fixed, -1.0, -0.1, 1.0);
  make_polygon(table, build::box_corners(2.0, 0.2), 0.0);
  on_table.bodies = {table, ball};
  for (const int n : {1, 4, 16}) {
    EXPECT_LT(gained(on_wall, n), 1e-11) << n;
    EXPECT_LT(gained(on_table, n), 1e-11) << n;
  }
}

/// What a box slides over the edge of, and off.
enum class Table { block, block_after_the_box, wall, block_that_slides };

/// The box, of which the corners are rounded by so much (m), after 0.8 s.
Vec2 slid_off(Table table, double rounded, int steps_per_frame) {
  constexpr double friction = 0.3;
  const auto plate = [&](const char* name, BodyKind kind, const Vec2& place, double mass,
                         const Vec2& size) {
    Body body = pinchlab::testing::body(name, kind, place.x(), place.y(), 1.0, mass);
    body.contact_friction = friction;
    make_polygon(body, build::box_corners(size.x() - 2.0 * rounded, size.y() - 2.0 * rounded),
                 rounded);
    return body;
  };
  Scene scene;
  const bool slides = table == Table::block_that_slides;
  if (slides) scene.walls.push_back({{-5.0, -0.2}, {5.0, -0.2}, friction, 0.0});
  if (table == Table::wall) {
    scene.walls.push_back({{-2.0, 0.0}, {0.0, 0.0}, friction, 0.0});
  } else {
    scene.bodies.push_back(
        plate("block", slides ? BodyKind::free : BodyKind::fixed, {-1.0, -0.1}, 3.0, {2.0, 0.2}));
  }
  Body box = plate("box", BodyKind::free, {-0.713, 0.1}, 1.0, {0.4, 0.2});
  box.velocity = {2.5, 0.0};
  const bool first = table == Table::block_after_the_box;
  scene.bodies.insert(first ? scene.bodies.begin() : scene.bodies.end(), box);
  const World world = moved(scene, steps_per_frame, 0.8);
  return first ? world.position.front() : world.position.back();
}

// What comes to the edge is let go there, and bears nothing beyond: by steps, that is an error of
// the first order, 1e-5 m at 128 a frame.
TEST(Jumps, ABoxThatSlidesOffATableIsLetGoAtItsEdge) {
  for (const Table table : {Table::block, Table::block_after_the_box, Table::wall}) {
    const Vec2 fine = slid_off(Table::block, 0.0, 512);
    const double coarse = (slid_off(table, 0.0, 4) - fine).norm();
    EXPECT_LE(coarse, 1e-4) << static_cast<int>(table);
    EXPECT_LE((slid_off(table, 0.0, 16) - fine).norm(), 1e-5) << static_cast<int>(table);
    EXPECT_LE((slid_off(table, 0.0, 128) - fine).norm(), 1e-7) << static_cast<int>(table);
  }
}

TEST(Jumps, SoIsOneOnABlockThatItDrags) {
  const Vec2 fine = slid_off(Table::block_that_slides, 0.0, 512);
  for (int steps = 8; steps <= 256; steps *= 2) {
    const double error = (slid_off(Table::block_that_slides, 0.0, steps) - fine).norm();
    EXPECT_LE(error, std::max(2e-3 / (steps * steps), 2e-7)) << steps;
  }
}

// Rounded corners turn the force over instead, and its rate jumps where they begin and end.
TEST(Jumps, SoIsOneWithRoundedCorners) {
  const Vec2 fine = slid_off(Table::block, 0.02, 512);
  EXPECT_LE((slid_off(Table::block, 0.02, 16) - fine).norm(), 1e-5);
  EXPECT_LE((slid_off(Table::block, 0.02, 128) - fine).norm(), 5e-7);
}

// A disc runs into another, which runs into a third: friction between them lifts two by some
// millionths of a metre, for two milliseconds. Held down for that they end 0.02 mm elsewhere.
TEST(Jumps, WhatABlowLiftsComesDownAtATimeOfItsOwn) {
  const auto after = [](int steps_per_frame) {
    Scene scene;
    scene.walls.push_back({{-5.0, 0.0}, {5.0, 0.0}, 0.3, 0.0});
    for (int i = 0; i < 3; ++i) {
      Body disc = body("disc " + std::to_string(i), BodyKind::free, 0.41 * i, 0.2, 0.2, 1.0 + i);
      disc.velocity = {2.0 - 2.0 * i, 0.0};
      disc.contact_friction = 0.3;
      scene.bodies.push_back(disc);
    }
    return moved(scene, steps_per_frame, 1.0);
  };
  const World fine = after(256);
  for (const int n : {8, 16, 64}) {
    const World world = after(n);
    EXPECT_EQ(world.diagnostics.events, fine.diagnostics.events) << n;
    for (std::size_t b = 0; b < 3; ++b) {
      EXPECT_LE((world.position[b] - fine.position[b]).norm(), 1e-8) << n;
    }
  }
}

// A tall box slides, trips over its leading corner, and that slides off the table meanwhile: what
// has borne the box is gone past the table's end, but not before.
TEST(Jumps, ABoxThatTripsSlidesOffATable) {
  const auto after = [](int steps_per_frame) {
    Scene scene;
    scene.walls.push_back({{-2.0, 0.0}, {0.0, 0.0}, 0.5, 0.0});
    Body box = body("box", BodyKind::free, -0.3, 0.12, 1.0, 2.4);
    make_polygon(box, build::box_corners(0.094, 0.24), 0.0);
    box.velocity = {2.63, 0.0};
    scene.bodies.push_back(box);
    return moved(scene, steps_per_frame, 0.35);
  };
  const Vec2 fine = after(1024).position[0];
  for (const int n : {4, 16, 64}) {
    EXPECT_LE((after(n).position[0] - fine).norm(), 1e-3 / (n * n)) << n;
  }
}

// A roller that presses a cable without slip on to a drum rolls on the circle of radius D = R + r +
// 2 w, by its own radius to the cable's centre line, rho = r + w: with kappa = I / (m rho^2), speed
// v at the angle phi from the top, and v_0 and phi_0 first,
//     (1 + kappa) (v^2 - v_0^2) / 2 = g D (cos phi_0 - cos phi),
// and it leaves where v^2 = g D cos phi. What holds it along the cable until then is no friction
// that fades with the force that presses.
TEST(Jumps, ARollerLeavesADrumThatItRollsOn) {
  const double R = 0.3, r = 0.2, w = build::cable_half_width, m = 0.5, speed = 0.5, angle = 0.2;
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed, 0.0, 0.0, R));
  const double D = R + r + 2.0 * w, rho = r + w;
  scene.bodies.push_back(
      body("roller", BodyKind::free, D * std::sin(angle), D * std::cos(angle), r, m));
  Body& roller = scene.bodies[1];
  roller.velocity = speed * Vec2(std::cos(angle), -std::sin(angle));
  roller.angular_velocity = -speed / rho;
  scene.cables.push_back(cable(at(-R - w, -1.0), {{0, -1, 0}}, at(R + w, -1.0)));
  const double kappa = inertia_of(roller) / (m * rho * rho);
  const double cosine =
      (std::cos(angle) + (1.0 + kappa) * speed * speed / (2.0 * g * D)) * 2.0 / (3.0 + kappa);
  const double turning = -std::sqrt(g * D * cosine) / rho;
  const Vec2 fine = moved(scene, 512, 0.45).position[1];
  for (const int n : {4, 16, 64}) {
    const World world = moved(scene, n, 0.45);
    EXPECT_NEAR(world.angular_velocity[1], turning, 0.01 / (n * n)) << n;
    EXPECT_LE((world.position[1] - fine).norm(), 5e-4 / (n * n)) << n;
  }
}

}  // namespace
}  // namespace pinchlab::testing
