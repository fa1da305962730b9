// SPDX-License-Identifier: GPL-3.0-or-later
// Links that come and go where bodies meet free spans.

#include "sim/outline.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

/// A cable between two weights over two pulleys, and a body shot at the span between them.
Scene shot(double speed, double offset, double radius, double slack) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  Body bullet = body("bullet", BodyKind::free, offset, -1.0, radius, 0.1);
  bullet.velocity = {0.0, speed};
  scene.bodies.push_back(bullet);
  scene.cables.push_back(cable(at(-2.0, 0.0), {}, at(2.0, 0.0), 0.02));
  scene.cables[0].slack = slack;
  return scene;
}

class Bullet : public ::testing::TestWithParam<std::tuple<double, double, double>> {};

TEST_P(Bullet, NeverPassesACable) {
  const auto [speed, offset, slack] = GetParam();
  Scene scene = shot(speed, offset, 0.05, slack);
  World world = make_world(scene, measured());
  Workspace work;
  // The cable reaches at most this far up: an ellipse about its ends.
  const double half = 0.5 * (4.0 + slack), highest = std::sqrt(half * half - 4.0) + 0.1;
  const double energy = 0.5 * 0.1 * speed * speed;
  for (int i = 0; i < 480; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    // A step may end beyond the cable by the step's own motion, while the link already pulls back.
    ASSERT_LT(world.position[0].y(), highest + speed * world.step_length) << i;
    if (speed * world.step_length > 0.5)
      continue;  // farther a step than the cable is wide: no orbit to keep
    ASSERT_LE(0.05 * world.velocity[0].squaredNorm(), energy * (1.0 + 1e-9)) << i;
  }
  EXPECT_LT(world.position[0].y(), highest) << "the body is on the side that it came from";
}

INSTANTIATE_TEST_SUITE_P(Speeds, Bullet,
                         ::testing::Combine(::testing::Values(1.0, 10.0, 100.0, 300.0),
                                            ::testing::Values(0.0, 0.7, -1.3),
                                            ::testing::Values(0.0, 0.05, 0.5)));

// Far faster than a step can follow (417 m a step, 4167 times the body's size): the cable still
// catches it. (Ten times as far from the middle, the fastest slides to the cable's end and off it
// within that step, in steps of a millionth as well.)
TEST(Spans, CatchesWhatCrossesWithinOneStep) {
  for (const double speed : {1e3, 1e4, 1e5}) {
    Scene scene = shot(speed, 0.03, 0.05, 0.1);
    World world = make_world(scene, measured());
    for (int i = 0; i < 3 && world.position[0].y() < 0.0; ++i) run(scene, world, 1);
    ASSERT_GT(world.position[0].y(), 0.0);
    ASSERT_EQ(world.cables[0].links.size(), 3u);
    EXPECT_EQ(world.cables[0].links[1].orientation, -1);
  }
}

TEST(Spans, TheCableGoesRoundTheSideThatTheBodyCameFrom) {
  for (const double side : {-1.0, 1.0}) {
    Scene scene = shot(5.0, 0.3, 0.1, 0.1);
    scene.bodies[0].position.y() = side;
    scene.bodies[0].velocity.y() = -5.0 * side;
    World world = make_world(scene, measured());
    for (int i = 0; i < 240 && world.cables[0].links.size() == 2; ++i) run(scene, world, 1);
    ASSERT_EQ(world.cables[0].links.size(), 3u);
    EXPECT_EQ(world.cables[0].links[1].orientation, side > 0.0 ? 1 : -1);
  }
}

TEST(Spans, ASpanThatSweepsOntoAFixedBodyWrapsIt) {
  Scene scene;
  scene.bodies.push_back(body("bob", BodyKind::free, -1.5, -1.0, 0.1, 1.0));
  scene.bodies.push_back(body("peg", BodyKind::fixed, 0.1, -0.8, 0.05, 1.0));
  scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0), 0.01));
  World world = make_world(scene, measured());
  bool wrapped = false, unwrapped = false;
  for (int i = 0; i < 240 * 3; ++i) {
    run(scene, world, 1);
    const bool now = world.cables[0].links.size() == 3;
    unwrapped = unwrapped || (wrapped && !now);
    wrapped = wrapped || now;
  }
  EXPECT_TRUE(wrapped);
  EXPECT_TRUE(unwrapped);
}

// A body that lies on a taut cable with next to no wrap makes and loses its link again and again.
// It must neither gain energy nor fall through.
TEST(Spans, ChatterIsHarmless) {
  Scene scene;
  scene.bodies.push_back(body("bead", BodyKind::free, 0.0, 0.121, 0.1, 0.1));
  scene.bodies.push_back(body("weight", BodyKind::free, 2.52, -2.0, 0.3, 10.0));
  scene.bodies.push_back(body("pulley", BodyKind::fixed_axle, 2.0, -0.52, 0.5, 1.0));
  scene.cables.push_back(cable(at(-2.0, 0.0), {{2, -1, 0}}, on(1), 0.02));
  scene.bodies[0].restitution = 0.9;
  World world = make_world(scene, measured());
  int changes = 0;
  std::size_t links = world.cables[0].links.size();
  for (int i = 0; i < 240 * 20; ++i) {
    run(scene, world, 1);
    if (world.cables[0].links.size() != links) ++changes;
    links = world.cables[0].links.size();
    if (std::abs(world.position[0].x()) < 1.8) {
      ASSERT_GT(world.position[0].y(), -0.5) << i;
      ASSERT_LT(world.position[0].y(), 0.15) << i;
    }
    ASSERT_LT(world.diagnostics.cable_length_error, 1e-12);
  }
  EXPECT_GT(changes, 10) << "the link does come and go";
}

TEST(Spans, WallsHoldBodiesFromBothSides) {
  for (const double side : {-1.0, 1.0}) {
    Scene scene;
    scene.gravity = Vec2(0.0, -9.81 * side);
    Body ball = body("ball", BodyKind::free, 0.0, side, 0.1, 1.0);
    ball.velocity = {0.3, -200.0 * side};
    scene.bodies.push_back(ball);
    scene.walls.push_back({Vec2(-50.0, 0.0), Vec2(50.0, 0.0), 0.5, 0.0});
    World world = make_world(scene, measured());
    for (int i = 0; i < 480; ++i) {
      run(scene, world, 1);
      ASSERT_GE(world.position[0].y() * side, 0.1 - 1e-12) << i;
    }
    EXPECT_NEAR(world.position[0].y() * side, 0.1, 1e-12);
    EXPECT_NEAR(world.velocity[0].x(), -world.angular_velocity[0] * 0.1 * side, 1e-9) << "rolls";
  }
}

TEST(Spans, BouncesByItsRestitution) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  Body ball = body("ball", BodyKind::free, 0.0, 1.0, 0.1, 1.0);
  ball.velocity = {0.0, -3.0};
  ball.restitution = 0.5;
  scene.bodies.push_back(ball);
  scene.walls.push_back({Vec2(-5.0, 0.0), Vec2(5.0, 0.0), 0.5, 0.0});
  World world = make_world(scene, measured());
  run(scene, world, 240);
  EXPECT_NEAR(world.velocity[0].y(), 1.5, 1e-12);
}

// A bar that a motor turns into a taut cable meets it wherever events take effect.
TEST(Spans, AreMetByCornersThatTurn) {
  for (const double speed : {-5.0, -10.0, -20.0, -30.0}) {
    Scene scene;
    scene.steps_per_frame = 1;
    Body bar = body("bar", BodyKind::fixed_axle, 0.0, 0.0, 0.1, 10.0);
    make_polygon(bar, {{-0.05, -1.0}, {0.05, -1.0}, {0.05, 1.0}, {-0.05, 1.0}}, 0.0);
    bar.driven_angular_velocity = speed;
    scene.bodies = {bar, body("weight", BodyKind::free, 0.9, -2.0, 0.2, 1.0)};
    scene.cables.push_back(cable(at(0.9, 3.0), {}, on(1), 0.01));
    const auto step_of_link = [&scene](Events events) {
      Configuration configuration = Method::pinch;
      configuration.events = events;
      World world = make_world(scene, configuration);
      Workspace work;
      for (int i = 1; i <= 20; ++i) {
        EXPECT_EQ(step(scene, world, work), StepStatus::ok);
        if (world.cables[0].links.size() > 2) return i;
      }
      return 0;
    };
    const int located = step_of_link(Events::located);
    EXPECT_GT(located, 0) << speed;
    EXPECT_EQ(step_of_link(Events::at_steps), located) << speed;
  }
}

}  // namespace
}  // namespace pinchlab::testing
