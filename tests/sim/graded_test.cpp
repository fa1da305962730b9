// SPDX-License-Identifier: GPL-3.0-or-later
// Pinches that are weaker by degrees (squeeze, grip), and motors that follow a table.

#include "sim/promises.h"
#include "sim/scene_error.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

constexpr double r = 0.5, w = 0.05, R = r + w;

double gap(const World& world, std::size_t a, std::size_t b) {
  return (world.position[b] - world.position[a]).norm() - world.bodies[a].radius -
         world.bodies[b].radius;
}

/// A roller of 1 kg above a drum that a fixed cable lies over.
Scene roller_above_drum(double height) {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, r, 10.0));
  scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, r + 0.25 + height, 0.25, 1.0));
  scene.cables.push_back(cable(at(-1.0, -2.0), {{0, -1, 0}}, at(1.0, -2.0), w));
  return scene;
}

class Squeeze : public ::testing::TestWithParam<double> {};

TEST_P(Squeeze, IsTheShareOfTheWidthThatABodySinksInBy) {
  const double squeeze = GetParam(), rest = (1.0 - squeeze) * 2.0 * w;
  for (const int steps_per_frame : {1, 4}) {
    Scene scene = roller_above_drum(2.0);  // hits at 6 m/s
    scene.steps_per_frame = steps_per_frame;
    scene.cables[0].squeeze = squeeze;
    World world = make_world(scene, measured());
    Workspace work;
    Promises promises(scene, world);
    for (int i = 0; i < 120 * steps_per_frame; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok);
      promises.note(scene, world);
      ASSERT_GE(gap(world, 0, 1), rest - 1e-12);
    }
    EXPECT_NEAR(gap(world, 0, 1), rest, 1e-12);
    ASSERT_EQ(world.contacts.size(), 1u);
    EXPECT_NEAR(world.contacts[0].normal_force, g, 1e-9);
    EXPECT_EQ(world.cables[0].links.size(), 5u);
    EXPECT_LT(world.diagnostics.cable_length_error, 1e-12);
    EXPECT_EQ(promises.broken(scene, world), std::vector<std::string>());
  }
}

// Between two drums that the cable crosses, where the tangent vanishes.
TEST_P(Squeeze, IsTheShareInTransitionalPinchesToo) {
  const double squeeze = GetParam(), rest = (1.0 - squeeze) * 2.0 * w;
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, r, 10.0));
  scene.bodies.push_back(
      body("roller", BodyKind::rail, 0.0, r + 0.25 + 2.0 * w + 0.05, 0.25, 20.0));
  scene.bodies.push_back(body("weight", BodyKind::free, -R, -3.0, 0.2, 1.0));
  scene.bodies[2].linear_drag = scene.bodies[2].angular_drag = 5.0;
  scene.cables.push_back(cable(on(2), {{0, -1, 0}, {1, 1, 0}}, at(-3.0, 0.9), w));
  scene.cables[0].squeeze = squeeze;
  World world = make_world(scene, measured());
  run(scene, world, 240 * 8);
  EXPECT_NEAR(gap(world, 0, 1), rest, 1e-9);
  EXPECT_LT(world.velocity[2].norm(), 1e-9);
  EXPECT_LT(world.diagnostics.largest_stretch, 1e-9);
}

// A roller that rolls down from the crown of a drum that turns, with a load on its cable: until the
// roller leaves the cable, what is lost in height is there in speed.
TEST_P(Squeeze, KeepsEnergy) {
  const double squeeze = GetParam(), D = r + 0.25 + (1.0 - squeeze) * 2.0 * w;
  Scene scene;
  scene.steps_per_frame = 8;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, r, 10.0));
  scene.bodies.push_back(
      body("roller", BodyKind::free, D * std::sin(0.3), D * std::cos(0.3), 0.25, 1.0));
  scene.bodies.push_back(body("load", BodyKind::free, -R, -2.0, 0.2, 1.0));
  scene.cables.push_back(cable(on(2), {{0, -1, 0}}, at(R, -2.0), w));
  scene.cables[0].squeeze = squeeze;
  World world = make_world(scene, measured());
  Workspace work;
  ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  const double start = world.diagnostics.energy;
  double most = start, least = start;
  while (world.time() < 1.0 && gap(world, 0, 1) < D - r - 0.25 + 1e-4) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    most = std::max(most, world.diagnostics.energy);
    least = std::min(least, world.diagnostics.energy);
  }
  EXPECT_GT(world.time(), 0.25);
  EXPECT_LT(world.position[1].y(), 0.8 * D) << "it has rolled down";
  EXPECT_LT(most - start, 1e-4 * g);
  EXPECT_LT(start - least, 1e-4 * g);
}

INSTANTIATE_TEST_SUITE_P(Shares, Squeeze, ::testing::Values(0.0, 0.1, 0.25, 0.5, 0.75, 1.0));

TEST(SqueezeOfOne, IsPinchWithoutContactBitForBit) {
  for (const int seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
    Scene scene = random_scene(seed);
    World without = make_world(scene, Method::pinch_no_contact);
    for (Cable& c : scene.cables) c.squeeze = 1.0;
    World squeezed = make_world(scene, Method::pinch);
    run(scene, without, 240);
    run(scene, squeezed, 240);
    EXPECT_EQ(without.position, squeezed.position) << seed;
    EXPECT_EQ(without.angle, squeezed.angle) << seed;
  }
}

TEST(Squeeze, AndGripAreSharesFromNoneToAll) {
  for (const double wrong : {-0.1, 1.1, std::nan("")}) {
    Scene scene = roller_above_drum(0.5);
    scene.cables[0].squeeze = wrong;
    EXPECT_THROW(make_world(scene, Method::pinch), SceneError);
    scene.cables[0].squeeze = 0.0;
    scene.cables[0].grip = wrong;
    EXPECT_THROW(make_world(scene, Method::pinch), SceneError);
  }
}

/// A roller driven clockwise that lies on the cable over a frictionless drum, with a load at either
/// end.
Scene driven_roller(double mu, double grip) {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, r, 5.0));
  scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, r + 0.25 + 2.0 * w, 0.25, 2.0));
  scene.bodies.push_back(body("left", BodyKind::free, -R, -2.0, 0.2, 1.0));
  scene.bodies.push_back(body("right", BodyKind::free, R, -2.0, 0.2, 1.0));
  scene.bodies[0].cable_friction = 0.0;
  scene.bodies[1].cable_friction = mu;
  scene.bodies[1].driven_angular_velocity = -50.0;
  scene.cables.push_back(cable(on(2), {{0, -1, 0}}, on(3)));
  scene.cables[0].grip = grip;
  return scene;
}

// The roller's friction moves the two loads alone: a = grip mu N / (2 m).
TEST(Grip, IsAFactorOnThePinchsFriction) {
  const double mu = 0.25;
  for (const double grip : {0.0, 0.25, 0.5, 1.0}) {
    const Scene scene = driven_roller(mu, grip);
    World world = make_world(scene, measured());
    const double y = world.position[2].y();
    run(scene, world, 240);
    EXPECT_NEAR(y - world.position[2].y(), 0.5 * grip * mu * 2.0 * g / 2.0, 1e-10) << grip;
  }
}

// A wheel over which the cable slips is held by capstan friction and by what presses it: a roller
// of no friction, here. Tensions differ by grip mu N + the arcs' share.
TEST(Grip, IsAFactorOnTheWrappedBodysFrictionToo) {
  const double mu = 0.1, press = 5.0;
  for (const double grip : {0.0, 0.5, 1.0}) {
    Scene scene = driven_roller(0.0, grip);
    scene.bodies[0].cable_friction = mu;
    scene.bodies[0].kind = BodyKind::fixed;
    scene.bodies[1].mass = press;
    scene.bodies[3].mass = 3.0;
    scene.bodies[2].position.y() = -4.0;
    World world = make_world(scene, measured());
    const double y = world.position[3].y();
    run(scene, world, 240);
    // T1 = m1 (g + a) -> e^(mu pi / 2) -> + grip mu N -> e^(mu pi / 2) = T2 = m2 (g - a)
    const double k = std::exp(0.5 * mu * std::numbers::pi), m1 = 1.0, m2 = 3.0;
    const double a = (m2 * g - k * k * m1 * g - k * grip * mu * press * g) / (m2 + k * k * m1);
    EXPECT_NEAR(y - world.position[3].y(), 0.5 * a, 1e-9) << grip;
  }
}

TEST(Grip, OfNoneLetsARollerWithoutSlipTurnFreely) {
  for (const double grip : {0.0, 1.0}) {
    Scene scene = driven_roller(infinity, grip);
    scene.bodies[1].driven_angular_velocity = -5.0;
    World world = make_world(scene, measured());
    const double y = world.position[3].y();
    run(scene, world, 24);
    EXPECT_NEAR(world.position[3].y() - y, grip * 5.0 * (0.25 + w) * 0.1, 1e-12) << grip;
  }
}

}  // namespace
}  // namespace pinchlab::testing
