// SPDX-License-Identifier: GPL-3.0-or-later
// Parts that cannot meet within a step are divided each by its own events:
// sim/motion/neighbourhoods.h.

#include "sim/motion/neighbourhoods.h"

#include "base/at.h"
#include "sim/workspace.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

TEST(Neighbourhoods, BallsBounceAsIfEachWereAlone) {
  constexpr int count = 120;  // five times as many as may rebound in a step of one of them
  const Scene scene = balls(count, height_of_ball);
  World world = make_world(scene, measured());
  std::vector<Scene> alone;
  std::vector<World> worlds;
  for (int i = 0; i < count; ++i) {
    Scene one = balls(1, height_of_ball);
    one.bodies[0] = scene.bodies[index(i)];
    one.walls = scene.walls;
    alone.push_back(one);
    worlds.push_back(make_world(one, measured()));
  }
  Workspace work;
  for (int k = 0; k < 60; ++k) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    for (int i = 0; i < count; ++i) {
      run(alone[index(i)], worlds[index(i)], 1);
      ASSERT_EQ(world.position[index(i)], worlds[index(i)].position[0])
          << "ball " << i << ", step " << k;
    }
  }
  EXPECT_EQ(world.diagnostics.clusters, 0);
  EXPECT_GT(world.diagnostics.events, count);
}

// All in one step of 17 ms, but at 120 times of it.
TEST(Neighbourhoods, HoweverManyLandInOneStepAllRebound) {
  constexpr int count = 120;
  const auto height = [](int i) { return 0.5 + 1e-4 * i; };
  const Scene scene = balls(count, height);
  World world = make_world(scene, measured());
  const double g = -scene.gravity.y();
  while (world.time() < 0.4) {
    run(scene, world, 1);
    for (int i = 0; i < count; ++i) {
      const double t0 = std::sqrt(2.0 * height(i) / g), t = world.time() - t0;
      const double exact = t < 0.0 ? height(i) - 0.5 * g * world.time() * world.time()
                                   : 0.8 * g * t0 * t - 0.5 * g * t * t;
      ASSERT_NEAR(world.position[index(i)].y() - 0.1, exact, 1e-8) << i << ", t = " << world.time();
    }
  }
  EXPECT_EQ(world.diagnostics.clusters, 0);
}

/// Balls that fall each on a taut span of its own.
Scene balls_on_spans(int count) {
  const auto height = [count](int i) { return 0.02 + 1e-3 * (7 * i % count); };
  Scene scene = balls(0, height_of_ball);
  scene.walls.clear();
  for (int i = 0; i < count; ++i) {
    scene.bodies.push_back(
        body(fmt::format("ball {}", i), BodyKind::free, i, 0.12 + height(i), 0.1, 1.0));
    scene.cables.push_back(cable(at(i - 0.4, 0.0), {}, at(i + 0.4, 0.0), 0.02));
    scene.cables.back().name = fmt::format("span {}", i);
    scene.cables.back().slack = 0.01;
  }
  return scene;
}

TEST(Neighbourhoods, BallsLandOnSpansAsIfEachWereAlone) {
  constexpr int count = 40;
  const Scene scene = balls_on_spans(count);
  World world = make_world(scene, measured());
  std::vector<Scene> alone(count, scene);
  std::vector<World> worlds;
  for (int i = 0; i < count; ++i) {
    alone[index(i)].bodies = {scene.bodies[index(i)]};
    alone[index(i)].cables = {scene.cables[index(i)]};
    worlds.push_back(make_world(alone[index(i)], measured()));
  }
  Workspace work;
  for (int k = 0; k < 120; ++k) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    for (int i = 0; i < count; ++i) {
      run(alone[index(i)], worlds[index(i)], 1);
      ASSERT_EQ(world.position[index(i)], worlds[index(i)].position[0])
          << "ball " << i << ", step " << k;
    }
  }
  EXPECT_GE(world.diagnostics.events, count);
  // The most pairs that an interval of one of them was tried with, however many there are.
  const std::size_t most = work.broad_phase.moving_pairs.capacity();
  EXPECT_GT(most, 0U);
  EXPECT_LE(most, 4U);
}

// Pairs that are found for what moves alone are those that matter: all pairs give the same bits.
TEST(Neighbourhoods, PairsOfWhatMovesAreEnough) {
  const Scene scene = balls_on_spans(30);
  Configuration all = measured();
  all.detection = Detection::all_pairs;
  World world = make_world(scene, measured()), reference = make_world(scene, all);
  Workspace work, other;
  for (int k = 0; k < 120; ++k) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    ASSERT_EQ(step(scene, reference, other), StepStatus::ok);
    ASSERT_TRUE(same_state(world, reference)) << "step " << k;
  }
  EXPECT_GE(world.diagnostics.events, 30);
}

// A body of 1 kg hits one of 1 g, which flies twice as fast and meets a third far out of the
// first's reach, all in one step; far off a ball bounces, so that the step is divided. By then the
// third has come to the step's end, and is taken back.
TEST(Neighbourhoods, ThoseThatMeetAfterAllAreTakenBack) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  const auto add = [&scene](double x, double y, double mass, Vec2 velocity) {
    Body ball = body(fmt::format("ball {}", scene.bodies.size()), BodyKind::free, x, y, 0.02, mass);
    ball.restitution = 1.0;
    ball.contact_friction = 0.0;
    ball.velocity = velocity;
    scene.bodies.push_back(ball);
  };
  add(0.0, 0.0, 1.0, Vec2(10.0, 0.0));
  add(0.06, 0.0, 1e-3, Vec2::Zero());
  add(0.3, 0.0, 1e-3, Vec2::Zero());
  add(50.0, 0.07, 1.0, Vec2(0.0, -10.0));
  scene.walls.push_back({Vec2(49.0, 0.0), Vec2(51.0, 0.0), 0.0, 0.0});
  scene.walls[0].restitution = 1.0;
  scene.steps_per_frame = 1;
  World world = make_world(scene, measured());
  run(scene, world, 1);
  // Elastic: the light one goes on with v2 = 2 v M / (M + m), the third takes all of that.
  const double m = 1e-3, v2 = 2.0 * 10.0 / (1.0 + m), v1 = 10.0 * (1.0 - m) / (1.0 + m);
  const double first_hit = 0.02 / 10.0, second_hit = first_hit + 0.2 / v2;
  const double t = world.time();
  EXPECT_GT(t, second_hit);
  // The first then hits the second again, where that has stopped.
  const double third_hit = second_hit + (0.2 - v1 * (second_hit - first_hit)) / v1;
  ASSERT_GT(third_hit, t);
  EXPECT_NEAR(world.position[0].x(), 0.02 + v1 * (t - first_hit), 1e-9);
  EXPECT_NEAR(world.position[1].x(), 0.26, 1e-9);
  EXPECT_NEAR(world.position[2].x(), 0.3 + v2 * (t - second_hit), 1e-9);
  EXPECT_NEAR(world.position[3].y(), 0.02 + 10.0 * (t - 0.005), 1e-9);
  EXPECT_NEAR(world.velocity[2].x(), v2, 1e-9);
}

std::vector<int> neighbourhoods_of_bodies(const Scene& scene) {
  World world = make_world(scene, measured());
  Workspace work;
  fit(world, work);
  put_together(world, work.parts, work.neighbourhoods);
  work.start.position = world.position;
  work.start.velocity = world.velocity;
  if (!divide(scene, world, work)) return std::vector<int>(world.bodies.size(), 0);
  return work.neighbourhoods.of_body;
}

TEST(Neighbourhoods, AreOfWhatMayMeetInAStep) {
  Scene scene;
  add_pendulum(scene, 0.0);
  add_pendulum(scene, 5.0);
  scene.bodies.push_back(body("far", BodyKind::free, 0.5, 2.0, 0.1, 1.0));
  EXPECT_EQ(neighbourhoods_of_bodies(scene), (std::vector<int>{0, 1, 2}));
  scene.bodies.back().position.y() = 0.2;  // above the first one's rope
  EXPECT_EQ(neighbourhoods_of_bodies(scene), (std::vector<int>{0, 1, 0}));
  scene.bodies.back().position.y() = 2.0;
  scene.bodies.back().velocity = {0.0, -300.0};
  EXPECT_EQ(neighbourhoods_of_bodies(scene), (std::vector<int>{0, 1, 0}));
}

// Two weights over a pulley that does not turn: what presses on it may press a rope of theirs.
TEST(Neighbourhoods, ReachOverStaticPulleys) {
  Scene scene;
  scene.bodies.push_back(body("pulley", BodyKind::fixed, 0.0, 0.0, 0.5, 1.0));
  scene.bodies.push_back(body("left", BodyKind::free, -0.55, -3.0, 0.1, 1.0));
  scene.bodies.push_back(body("right", BodyKind::free, 0.55, -3.0, 0.1, 1.0));
  scene.bodies[0].cable_friction = 0.0;
  scene.cables.push_back(cable(on(1), {{0, -1, 0}}, on(2)));
  scene.bodies.push_back(body("roller", BodyKind::free, 0.0, 0.7005, 0.1, 1.0));
  scene.bodies.push_back(body("far", BodyKind::free, 9.0, 0.7, 0.1, 1.0));
  EXPECT_EQ(neighbourhoods_of_bodies(scene), (std::vector<int>{-1, 0, 0, 0, 1}));
}

/// The scene, and far from it balls that bounce.
Scene beside_balls(const Scene& scene) {
  Scene both = scene;
  const Scene others = balls(20, height_of_ball);
  for (Body ball : others.bodies) {
    ball.position.x() += 50.0;
    both.bodies.push_back(ball);
  }
  both.walls.push_back(others.walls[0]);
  both.walls.back().a.x() = 49.0;
  both.walls.back().b.x() = 71.0;
  return both;
}

/// Steps until another bit of the scene's motion, or its end.
int steps_as_alone(Scene scene, int steps_per_frame, int steps) {
  scene.steps_per_frame = steps_per_frame;
  const Scene both = beside_balls(scene);
  World alone = make_world(scene, measured()), beside = make_world(both, measured());
  Workspace work, other;
  for (int k = 0; k < steps; ++k) {
    EXPECT_EQ(step(scene, alone, work), StepStatus::ok) << alone.failure;
    EXPECT_EQ(step(both, beside, other), StepStatus::ok) << beside.failure;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      if (alone.position[b] != beside.position[b] || alone.angle[b] != beside.angle[b]) return k;
    }
  }
  EXPECT_GT(beside.diagnostics.events - alone.diagnostics.events, 20);
  return steps;
}

// What happens elsewhere changes no bit: not the intervals of a part, nor when its velocities are
// brought to the time of its positions, nor what is foreseen.
TEST(Neighbourhoods, EveryPartMovesAsBesideNothing) {
  Scene pendulum;
  add_pendulum(pendulum, 0.0);
  for (const int steps : {1, 4, 16}) {
    EXPECT_EQ(steps_as_alone(pendulum, steps, 60 * steps), 60 * steps) << steps;
    for (int seed = 0; seed < 20; ++seed) {
      EXPECT_EQ(steps_as_alone(random_scene(seed), steps, 60 * steps), 60 * steps)
          << "seed " << seed << ", " << steps << " steps a frame";
    }
  }
}

TEST(Neighbourhoods, AnotherWorkspaceGivesTheSameBits) {
  EXPECT_TRUE(is_all_state(balls(30, height_of_ball), measured(), 120));
  EXPECT_TRUE(is_all_state(balls_on_spans(30), measured(), 120));
}

/// A ball that lands, and beside it what more bodies there are.
Scene landing(const std::vector<Body>& more) {
  Scene scene;
  Body ball = body("ball", BodyKind::free, 0.0, 0.1015, 0.1, 1.0);
  ball.restitution = 0.4;
  scene.bodies = {ball};
  scene.bodies.insert(scene.bodies.end(), more.begin(), more.end());
  scene.walls.push_back({Vec2(-1.0, 0.0), Vec2(1.0, 0.0), 0.0, 0.0});
  scene.steps_per_frame = 1;
  return scene;
}

// Discs that collide in the same round have contacts found anew, of the ball as well: it hops on
// all the same.
TEST(Neighbourhoods, ReboundsAreKeptWhateverIsThrownElsewhere) {
  Body hit = body("hit", BodyKind::free, 5.0, 5.0, 0.1, 1.0);
  Body fast = body("fast", BodyKind::free, 4.55, 5.0, 0.1, 100.0);
  hit.restitution = fast.restitution = 1.0;
  fast.velocity = {10.0, 0.0};
  const Scene alone = landing({}), beside = landing({hit, fast});
  World one = make_world(alone, measured()), both = make_world(beside, measured());
  Workspace first, second;
  for (int i = 0; i < 8; ++i) {
    ASSERT_EQ(step(alone, one, first), StepStatus::ok);
    ASSERT_EQ(step(beside, both, second), StepStatus::ok);
    ASSERT_EQ(one.position[0], both.position[0]) << i;
    ASSERT_EQ(one.velocity[0], both.velocity[0]) << i;
  }
  EXPECT_EQ(both.diagnostics.events, one.diagnostics.events + 1);
}

/// A weight that sleeps between two cables, a ball that falls on one of them in step 49, and, with
/// `chain`, discs far away that make each other ten times as fast in that step, and so cross.
Scene sleeper(bool chain) {
  Scene scene;
  const double t = 48.0 / 60.0;
  const double over = 0.11 * std::sqrt(5.0) / 2.0;  // m, above the span where the ball meets it
  const double fallen = 0.5 * g * (t + 0.002) * (t + 0.002);
  scene.bodies = {body("weight", BodyKind::free, 0.0, -1.0, 0.1, 1.0),
                  body("ball", BodyKind::free, -1.0, -0.5 + over + fallen, 0.1, 1.0)};
  scene.cables = {cable(at(-2.0, 0.0), {}, on(0), 0.01), cable(at(2.0, 0.0), {}, on(0), 0.01)};
  scene.cables[1].name = "right";
  const auto disc = [&scene](const char* name, double x, double speed, double mass) {
    Body body = build::body(name, BodyKind::free, x, 20.0, 0.1, mass);
    body.restitution = 1.0;
    body.velocity = {speed, 0.0};
    scene.bodies.push_back(body);
  };
  if (chain) {
    disc("heavy", 99.8 - 20.0 * (t + 0.003), 20.0, 100.0);
    disc("first", 100.0, 0.0, 1.0);
    disc("light", 100.358, 0.0, 0.01);
    disc("last", 101.758, 0.0, 1.0);
  }
  scene.steps_per_frame = 1;
  return scene;
}

TEST(Neighbourhoods, AStepThatIsTakenBackPutsBackWhatWasWoken) {
  const Scene alone = sleeper(false), beside = sleeper(true);
  World one = make_world(alone, Method::pinch), both = make_world(beside, Method::pinch);
  Workspace first, second;
  for (int i = 0; i < 55; ++i) {
    ASSERT_EQ(step(alone, one, first), StepStatus::ok);
    ASSERT_EQ(step(beside, both, second), StepStatus::ok);
    ASSERT_LT((one.position[0] - both.position[0]).norm(), 1e-3) << "step " << i + 1;
  }
}

}  // namespace
}  // namespace pinchlab::testing
