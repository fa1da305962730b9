// SPDX-License-Identifier: GPL-3.0-or-later
// The tension of cables with mass, and what flows through their spans.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/joints.h"
#include "sim/make_world.h"
#include "tests/sim/momentum.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using std::numbers::pi;

constexpr double radius = 0.2, half_width = 0.01, rim = radius + half_width;  // m
constexpr double distance = 2.0;                                              // m
constexpr double density = 2.0;                                               // kg/m

/// A belt about two pulleys of one size that turn at `turning` (rad/s), without gravity.
Scene belt(double turning, double stiffness, int steps) {
  Scene scene;
  scene.steps_per_frame = steps;
  scene.gravity = Vec2::Zero();
  scene.bodies = {body("first", BodyKind::free, 0.0, 0.0, radius, 2.0),
                  body("second", BodyKind::free, distance, 0.0, radius, 2.0)};
  for (Body& pulley : scene.bodies) pulley.angular_velocity = turning;
  Cable loop = cable({}, {{0, 1, 0}, {1, 1, 0}}, {}, half_width);
  loop.closed = true;
  loop.mass_per_metre = density;
  loop.axial_stiffness = stiffness;
  scene.cables.push_back(loop);
  return scene;
}

/// Both are driven, the second along a rail, on which a spring of 20 N/m pulls it away from 12 m
/// off.
Scene pulled_belt(double turning, double stiffness, bool creeps, double friction) {
  Scene scene = belt(turning, stiffness, 4);
  scene.bodies[0].kind = BodyKind::fixed_axle;
  scene.bodies[1].kind = BodyKind::rail;
  scene.bodies[1].rail_axis = {1.0, 0.0};
  scene.bodies[1].linear_drag = 20.0;
  for (Body& pulley : scene.bodies) {
    pulley.driven_angular_velocity = turning;
    pulley.cable_friction = friction;
  }
  scene.cables[0].creep = creeps;
  add_spring(scene, "spring", on(1), {-1, {12.0, 0.0}}, 20.0, 5.0, 0.0);
  return scene;
}
double pull_at(double x) {
  return 20.0 * (7.0 - x);
}

/// Where the driven pulley is at rest. The tension T of a belt that runs at w turns what passes a
/// rim round, so that it holds the pulley by T - rho w^2 on either side, rho being of the belt as
/// stretched. That is by what it has got longer for its length at the start: all of it where rims
/// carry stretched cable over, else its spans.
double rest_of(double w, double stiffness, bool creeps) {
  const double own = 2.0 * distance + (creeps ? 2.0 * pi * rim : 0.0);
  double low = distance, high = distance + 1.0;
  for (int k = 0; k < 100; ++k) {
    const double x = 0.5 * (low + high), strain = 2.0 * (x - distance) / own;
    const double flux = density * w * w / (creeps ? 1.0 + strain : 1.0);
    (2.0 * (stiffness * strain - flux) < pull_at(x) ? low : high) = x;
  }
  return low;
}

// The row's force was T - rho w^2, by which the belt was stretched: at 4.2 m/s 0.017 for 0.028.
TEST(MassTension, ABeltAtSpeedIsStretchedByItsTension) {
  for (const bool creeps : {false, true}) {
    for (const double friction : {infinity, 0.3}) {
      for (const double turning : {20.0, 30.0}) {
        const Scene scene = pulled_belt(turning, 3000.0, creeps, friction);
        World world = make_world(scene, Method::pinch);
        run(scene, world, 6 * 60 * 4);
        const double x = rest_of(turning * rim, 3000.0, creeps);
        EXPECT_NEAR(world.position[1].x(), x, 1e-6) << creeps << ' ' << friction << ' ' << turning;
        for (const Segment& span : world.cables[0].segments) {
          const double strain = span.length / span.rest_length - 1.0;
          EXPECT_NEAR(span.tension, 3000.0 * strain, 1e-3) << creeps << ' ' << friction;
        }
      }
    }
  }
}

// A caterpillar's track, kept tight by a spring between its wheels: T = F / 2 + rho w^2, however
// fast it goes as a whole. The row's force was less by rho w V on one side, none at V = 3 m/s, so
// that the track was slack there, and the wheels 0.1 m nearer to each other after half a second.
TEST(MassTension, IsTheSameInAFrameThatMoves) {
  constexpr double w = 3.0;
  for (const double stiffness : {infinity, 2e4}) {
    for (const Vec2& speed : {Vec2(0.0, 0.0), Vec2(3.0, 0.0), Vec2(-20.0, 5.0)}) {
      for (const int steps : {1, 4}) {
        Scene scene = belt(-w / rim, stiffness, steps);
        for (Cable& track : scene.cables) {
          for (Wrap& wrap : track.wraps) wrap.orientation = -1;
          track.slack = stiffness < infinity ? -30.0 / stiffness * 2.0 * distance : 0.0;
          track.creep = false;
        }
        for (Body& wheel : scene.bodies) wheel.velocity = speed;
        add_spring(scene, "spring", on(0), on(1), 100.0, distance + 0.24, 0.0);
        World world = make_world(scene, Method::pinch);
        run(scene, world, 30 * steps);
        const double allowed = stiffness < infinity ? 1e-4 : 1e-9;
        for (const std::size_t b : {0U, 1U}) {
          const Vec2 moved = world.position[b] - scene.bodies[b].position;
          EXPECT_LT((moved - world.time() * speed).norm(), allowed)
              << stiffness << ' ' << speed.x();
        }
        for (const Segment& span : world.cables[0].segments) {
          EXPECT_NEAR(span.tension, 12.0 + density * w * w, 1e4 * allowed) << speed.x();
        }
      }
    }
  }
}

// A rope of L metres over a pulley, with equal weights M, 6 m down on either side and running at w:
// x = w / k sinh k t, k^2 = 2 rho g / (2 M + rho L + I / R^2), also where the pulley is carried up,
// as heavy as what balances it.
TEST(MassTension, ARopeRunsOverAPulleyThatIsCarriedUp) {
  constexpr double weight = 3.0, inertia = 0.1, hangs = 6.0, w = 6.0, time = 0.5, heavy = 1e9;
  constexpr double carried = 2.0 * weight + density * (2.0 * hangs + pi * rim);  // kg
  for (const double lifted : {0.0, 15.0, -15.0}) {
    double error = 0.0;
    for (const int steps : {1, 4}) {
      Scene scene;
      scene.steps_per_frame = steps;
      scene.bodies = {body("pulley", BodyKind::rail, 0.0, 0.0, radius, heavy),
                      body("first", BodyKind::rail, rim, -hangs, 0.05, weight),
                      body("second", BodyKind::rail, -rim, -hangs, 0.05, weight),
                      body("balance", BodyKind::rail, 2.0, 0.0, radius, heavy + carried),
                      body("peg", BodyKind::fixed, 1.0, 40.0, 1.0 - half_width)};
      scene.bodies[0].inertia = inertia;
      scene.bodies[0].angular_velocity = w / rim;
      scene.bodies[4].cable_friction = 0.0;
      const std::array<double, 4> up{lifted, lifted + w, lifted - w, -lifted};
      for (std::size_t b = 0; b < up.size(); ++b) {
        scene.bodies[b].rail_axis = {0.0, 1.0};
        scene.bodies[b].velocity = {0.0, up[b]};
      }
      scene.cables.push_back(cable(on(1), {{0, 1, 0}}, on(2), half_width));
      scene.cables[0].mass_per_metre = density;
      scene.cables.push_back(cable(on(0), {{4, -1, 0}}, on(3), half_width));
      World world = make_world(scene, Method::pinch);
      run(scene, world, static_cast<int>(std::lround(time * 60.0)) * steps);
      const double k = std::sqrt(2.0 * density * g / (carried + inertia / (rim * rim)));
      const double x = world.position[1].y() - world.position[0].y() + hangs;
      const double now = std::abs(x - w / k * std::sinh(k * time));
      if (error > 0.0) {
        EXPECT_GT(error / now, 14.0) << lifted;
      }
      error = now;
    }
    EXPECT_LT(error, 1e-4) << lifted;
  }
}

/// Two pulleys on which a belt runs, kept apart by a spring, in free flight, whirling.
Scene whirling_belt(double friction, double stiffness, int steps) {
  Scene scene = belt(20.0, stiffness, steps);
  scene.bodies[0].velocity = {1.0, -0.6};
  scene.bodies[1].velocity = {1.0, 1.1};
  for (Body& pulley : scene.bodies) pulley.cable_friction = friction;
  scene.cables[0].creep = false;
  add_spring(scene, "strut", on(0), on(1), 3000.0, distance + 0.1, 0.0);
  return scene;
}

// What flows through a span's middle takes its momentum along from body to body: none is lost, to
// round-off. The angular one, and energy, are kept to second order.
TEST(MassTension, KeepsMomentumAndEnergy) {
  for (const double stiffness : {infinity, 4000.0}) {
    for (const double friction : {infinity, 0.2}) {
      double energy_error = 0.0, turning_error = 0.0;
      for (const int steps : {4, 16}) {
        const Scene scene = whirling_belt(friction, stiffness, steps);
        World world = make_world(scene, measured());
        run(scene, world, 1);
        const double energy = world.diagnostics.energy;
        const Eigen::Vector3d momentum = momentum_of(scene, world);
        double most = 0.0;
        Workspace work;
        for (int i = 0; i < 15 * steps; ++i) {
          ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
          most = std::max(most, std::abs(world.diagnostics.energy - energy));
        }
        const Eigen::Vector3d change = momentum_of(scene, world) - momentum;
        EXPECT_LT(change.head<2>().norm(), 1e-11) << stiffness << ' ' << friction;
        if (energy_error > 0.0 && friction == infinity) {
          EXPECT_GT(energy_error / most, 13.0) << stiffness;
          EXPECT_GT(turning_error / std::abs(change.z()), 13.0) << stiffness;
        }
        energy_error = most;
        turning_error = std::abs(change.z());
      }
    }
  }
}

}  // namespace
}  // namespace pinchlab::testing
