// SPDX-License-Identifier: GPL-3.0-or-later
// Cables that may slip where they are pressed on to a polygon, or with one: no link of their own
// is there for what presses.

#include <numbers>

#include "demos/scenes/shape_scenes.h"
#include "sim/mirror.h"
#include "sim/outline.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using build::box_corners;

constexpr double quarter = 0.5 * std::numbers::pi;

/// What lies on a cable over a fixed beam, between a light weight on the left and a heavier one.
struct Pressed {
  double mu = 0.3;                              // of the beam, on its cable
  double grip = 0.2;                            // of what presses
  double light = 1.0, heavy = 8.0, mass = 2.0;  // kg, `mass` of what presses
  BodyKind kind = BodyKind::rail;
  bool box = true;  // else a disc

  /// Of tensions over one corner of the beam.
  double corner() const { return std::exp(mu * quarter); }
  /// m/s^2, at which the heavy weight sinks where `held` (N) holds the cable on the beam, and as
  /// much as `inertia` (kg) is to be moved along with it.
  double acceleration(double held, double inertia = 0.0) const {
    const double k = corner();
    return (g * (heavy / k - light * k) - held) / (heavy / k + light * k + inertia);
  }
};

constexpr double half_width = 0.05, press_radius = 0.2, top = 0.23;  // m

Scene scene_of(const Pressed& with) {
  Scene scene;
  Body beam = body("beam", BodyKind::fixed, 0.0, 0.0, 1.0, 1.0);
  make_polygon(beam, box_corners(1.6, 0.4), 0.03);
  beam.cable_friction = with.mu;
  scene.bodies.push_back(beam);
  scene.bodies.push_back(body("light", BodyKind::free, -0.88, -2.0, 0.1, with.light));
  scene.bodies.push_back(body("heavy", BodyKind::free, 0.88, -1.0, 0.1, with.heavy));
  Body press =
      body("press", with.kind, 0.0, top + 2.0 * half_width + press_radius, press_radius, with.mass);
  if (with.box) make_polygon(press, box_corners(2.0 * press_radius, 2.0 * press_radius), 0.0);
  press.cable_friction = with.grip;
  scene.bodies.push_back(press);
  scene.cables.push_back(cable(on(1), {{0, -1, 0}}, on(2)));
  scene.cables[0].half_width = half_width;
  return scene;
}

/// m/s^2, of a way from rest.
double acceleration(const World& world, double way) {
  return 2.0 * way / (world.time() * world.time());
}

World after_half_a_second(const Scene& scene, int steps_per_frame = 4) {
  Scene fine = scene;
  fine.steps_per_frame = steps_per_frame;
  World world = make_world(fine, measured());
  run(fine, world, 30 * steps_per_frame);
  return world;
}

double sunk(const World& world) {
  return -1.0 - world.position[2].y();
}

// Both the beam and the box rub on the cable: held = (mu + grip) M g.
TEST(PressedSlip, ABoxHoldsACableByTheFrictionOfBothItsSides) {
  for (const int steps_per_frame : {1, 4}) {
    for (const double heavy : {5.0, 8.0, 20.0}) {
      Pressed with;
      with.heavy = heavy;
      const World world = after_half_a_second(scene_of(with), steps_per_frame);
      const double a = with.acceleration((with.mu + with.grip) * with.mass * g);
      EXPECT_NEAR(acceleration(world, sunk(world)), a, 1e-10) << heavy;
      EXPECT_NEAR(world.position[3].y(), top + 0.3, 1e-12);
      EXPECT_EQ(world.diagnostics.fallbacks, 0);
    }
  }
}

// The box lies on the wider cable alone, whichever of the two comes first in the scene.
TEST(PressedSlip, AThinnerCableBesideThePressedOneSlipsFreely) {
  const Pressed with;
  const double alone = sunk(after_half_a_second(scene_of(with)));
  constexpr double thin = 0.03, side = 0.83 + thin;
  for (const bool first : {true, false}) {
    Scene scene = scene_of(with);
    scene.bodies.push_back(body("left", BodyKind::free, -side, -2.0, 0.1, with.light));
    scene.bodies.push_back(body("right", BodyKind::free, side, -1.0, 0.1, with.heavy));
    for (const std::size_t i : {1U, 2U, 4U, 5U}) scene.bodies[i].outlined = false;
    Cable beside = cable(on(4), {{0, -1, 0}}, on(5), thin);
    beside.name = "beside";
    scene.cables.insert(first ? scene.cables.begin() : scene.cables.end(), beside);
    const World world = after_half_a_second(scene);
    EXPECT_NEAR(sunk(world), alone, 1e-9) << first;
    EXPECT_NEAR(acceleration(world, -1.0 - world.position[5].y()), with.acceleration(0.0), 1e-6);
  }
}

// A cable's grip is a share of the friction of both: held = 0.5 (mu + 0.2) M g. With all of the
// beam's the weight would sink at 3.855 m/s^2 instead of 4.301.
TEST(PressedSlip, AWeakerGripHoldsByAsMuchLess) {
  const Pressed with;
  for (const double share : {1.0, 0.5, 0.0}) {
    Scene scene = scene_of(with);
    scene.cables[0].grip = share;
    const World world = after_half_a_second(scene);
    const double a = with.acceleration(share * (with.mu + with.grip) * with.mass * g);
    EXPECT_NEAR(acceleration(world, sunk(world)), a, 1e-10) << share;
  }
}

// The heaviest weight that it holds: m / k = light k + (mu + grip) M.
TEST(PressedSlip, ABoxHoldsAsMuchAsItsWeightAllows) {
  Pressed with;
  const double k = with.corner();
  const double most = k * (with.light * k + (with.mu + with.grip) * with.mass);
  for (const double share : {0.99, 0.9999, 1.0001, 1.01}) {
    with.heavy = share * most;
    const World world = after_half_a_second(scene_of(with));
    const double a = with.acceleration((with.mu + with.grip) * with.mass * g);
    if (share < 1.0) {
      EXPECT_NEAR(sunk(world), 0.0, 1e-12) << share;
    } else {
      EXPECT_NEAR(acceleration(world, sunk(world)), a, 1e-10) << share;
    }
  }
}

// A pinched disc that rolls: a = alpha (r + w), and I alpha / (r + w) of the cable's pull.
TEST(PressedSlip, ADiscRollsOnACableThatSlips) {
  const double lever = press_radius + half_width;
  for (const double grip : {0.2, 5.0, infinity}) {
    Pressed with;
    with.box = false;
    with.grip = grip;
    const World world = after_half_a_second(scene_of(with));
    const double inertia = 0.5 * with.mass * press_radius * press_radius;
    const double a = with.acceleration(with.mu * with.mass * g, inertia / (lever * lever));
    EXPECT_NEAR(acceleration(world, sunk(world)), a, 1e-10) << grip;
    const double lag = 0.5 * world.step_length;
    EXPECT_NEAR(world.angular_velocity[3] * lever, a * (world.time() - lag), 1e-10) << grip;
  }
  // With less grip it slides, and turns by mu N (r + w) / I.
  Pressed with;
  with.box = false;
  with.grip = 0.01;
  const World world = after_half_a_second(scene_of(with));
  const double rub = with.grip * with.mass * g;
  const double a = with.acceleration(with.mu * with.mass * g + rub);
  EXPECT_NEAR(acceleration(world, sunk(world)), a, 1e-10);
  EXPECT_NEAR(acceleration(world, world.angle[3]),
              rub * lever / (0.5 * with.mass * press_radius * press_radius), 1e-10);
}

// A box that is free is carried along by the cable, as far as its grip reaches.
TEST(PressedSlip, AFreeBoxIsCarriedAlong) {
  Pressed with;
  with.kind = BodyKind::free;
  for (const double heavy : {5.0, 20.0}) {
    with.heavy = heavy;
    const World world = after_half_a_second(scene_of(with));
    const double carried = with.acceleration(with.mu * with.mass * g, with.mass);
    const bool slips = carried > with.grip * g;
    const double a = slips ? with.acceleration((with.mu + with.grip) * with.mass * g) : carried;
    EXPECT_EQ(slips, heavy > 10.0);
    EXPECT_NEAR(acceleration(world, sunk(world)), a, 1e-10) << heavy;
    EXPECT_NEAR(acceleration(world, world.position[3].x()), slips ? with.grip * g : carried, 1e-10);
  }
}

/// A weight on a cable over a rounded corner of a beam, that a car of 1 kg holds level, and what
/// presses it in the middle of the corner.
Scene pressed_corner(double mu, bool box) {
  constexpr double round = 0.3;  // m
  Scene scene;
  Body beam = body("beam", BodyKind::fixed, 0.0, 0.0, 1.0, 1.0);
  make_polygon(beam, box_corners(2.0, 1.0), round);
  beam.cable_friction = mu;
  scene.bodies.push_back(beam);
  const double edge = 0.5 + round + half_width;
  scene.bodies.push_back(body("car", BodyKind::rail, -4.0, edge, 0.1, 1.0));
  scene.bodies[1].rail_axis = Vec2(1.0, 0.0);
  scene.bodies.push_back(body("weight", BodyKind::free, 1.0 + round + half_width, -2.0, 0.1, 4.0));
  const Vec2 outward = Vec2(1.0, 1.0).normalized();
  const Vec2 place = Vec2(1.0, 0.5) + (round + 2.0 * half_width + press_radius) * outward;
  Body press = body("press", BodyKind::rail, place.x(), place.y(), press_radius, 2.0);
  press.rail_axis = outward;
  press.angle = 0.25 * std::numbers::pi;
  if (box) make_polygon(press, box_corners(2.0 * press_radius, 2.0 * press_radius), 0.0);
  press.cable_friction = 0.0;
  scene.bodies.push_back(press);
  scene.cables.push_back(cable(on(1), {{0, -1, 0}}, on(2)));
  scene.cables[0].half_width = half_width;
  return scene;
}

// Before it the arc multiplies the tension, after it the arc multiplies what the pinch has added:
// m (g - a) = k (k c a + mu N) with k = e^(mu pi / 4), N = M g / sqrt(2).
TEST(PressedSlip, APinchInTheMiddleOfACornerCutsItsArc) {
  const double mu = 0.3, k = std::exp(0.5 * mu * quarter), force = 2.0 * g / std::sqrt(2.0);
  for (const bool box : {false, true}) {
    const Scene scene = pressed_corner(mu, box);
    const World world = after_half_a_second(scene);
    const double a = (4.0 * g - k * mu * force) / (4.0 + k * k);
    EXPECT_NEAR(acceleration(world, -2.0 - world.position[2].y()), a, 1e-9) << box;
    EXPECT_NEAR(acceleration(world, world.position[1].x() + 4.0), a, 1e-9) << box;
  }
}

/// A drum in place of the beam, with the same top, and a press that does not turn.
Scene on_a_drum(const Pressed& with, double mass_per_metre) {
  Scene scene = scene_of(with);
  scene.bodies[0] = body("drum", BodyKind::fixed, 0.0, top - 0.83, 0.83, 1.0);
  scene.bodies[0].cable_friction = with.mu;
  scene.bodies[3].inertia = 1e9;
  scene.cables[0].mass_per_metre = mass_per_metre;
  return scene;
}

// On a disc a box has no link, and a disc has one; both press it in the same way:
// m (g - a) = k (k light (g + a) + (mu + grip) N).
TEST(PressedSlip, OnADiscABoxPressesAsADiscDoes) {
  for (const double grip : {0.0, 0.2}) {
    for (const bool box : {false, true}) {
      Pressed with;
      with.grip = grip;
      with.box = box;
      const World world = after_half_a_second(on_a_drum(with, 0.0));
      EXPECT_EQ(world.cables[0].links.size(), box ? 3U : 5U);
      EXPECT_EQ(world.diagnostics.fallbacks, 0);
      const double a = with.acceleration((with.mu + grip) * with.mass * g);
      EXPECT_NEAR(acceleration(world, sunk(world)), a, 1e-9) << grip << " " << box;
    }
  }
}

// A rope with mass that may slip on the drum, under a box that does not turn and on which nothing
// slips: it stays, until the box is lifted.
TEST(PressedSlip, ABoxHoldsARopeOnADisc) {
  for (const double mass_per_metre : {0.0, 0.5}) {
    Pressed with;
    with.grip = infinity;
    for (const bool box : {false, true}) {
      with.box = box;
      Scene scene = on_a_drum(with, mass_per_metre);
      EXPECT_NEAR(sunk(after_half_a_second(scene)), 0.0, 1e-9) << mass_per_metre << " " << box;
      scene.bodies[3].velocity.y() = 3.0;  // away for 0.6 s
      EXPECT_GT(sunk(after_half_a_second(scene)), 0.1) << mass_per_metre << " " << box;
    }
  }
}

// A box that leaps off lets the cable go, and brakes it where it lands: the impact's friction is
// (mu + grip) of the momentum that it stops.
TEST(PressedSlip, ABoxThatLeapsOffLandsOnTheMovingCable) {
  Pressed with;
  with.heavy = 4.0;
  Scene scene = scene_of(with);
  constexpr double leap = 2.0;  // m/s
  scene.bodies[3].velocity.y() = leap;
  World world = make_world(scene, measured());
  run(scene, world, 240);
  const double k = with.corner(), both = (with.mu + with.grip) * with.mass;
  const double lands = 2.0 * leap / g, t = world.time() - lands;
  const double free = with.acceleration(0.0), held = with.acceleration(both * g);
  const double slows = both * leap / (with.heavy / k + with.light * k);
  const double speed = free * lands - slows;
  EXPECT_LT(held, 0.0);
  ASSERT_GT(speed + held * t, 0.0);
  EXPECT_NEAR(sunk(world), 0.5 * free * lands * lands + speed * t + 0.5 * held * t * t, 1e-9);
}

TEST(PressedSlip, ImageMovesAsTheImage) {
  for (const BodyKind kind : {BodyKind::rail, BodyKind::free}) {
    Pressed with;
    with.kind = kind;
    const Scene scene = scene_of(with);
    const World world = after_half_a_second(scene), image = after_half_a_second(mirrored(scene));
    for (std::size_t b = 0; b < world.position.size(); ++b) {
      EXPECT_NEAR(image.position[b].x(), -world.position[b].x(), 1e-12);
      EXPECT_NEAR(image.position[b].y(), world.position[b].y(), 1e-12);
    }
    for (std::size_t c = 0; c < world.contacts.size(); ++c) {
      EXPECT_EQ(static_cast<int>(image.contacts[c].slip),
                -static_cast<int>(world.contacts[world.contacts.size() - 1 - c].slip));
    }
  }
}

TEST(PressedSlip, FollowsFromTheWorldAlone) {
  for (const BodyKind kind : {BodyKind::rail, BodyKind::free}) {
    Pressed with;
    with.kind = kind;
    with.heavy = 5.0;
    EXPECT_TRUE(is_all_state(scene_of(with), Method::pinch, 120));
  }
}

}  // namespace
}  // namespace pinchlab::testing
