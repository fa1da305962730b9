// SPDX-License-Identifier: GPL-3.0-or-later
// Tensions at time 0 of what moves already, against equations of motion.

#include <Eigen/LU>
#include <cmath>

#include "sim/joints.h"
#include "sim/nodes.h"
#include "sim/outline.h"
#include "sim/tangent.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

double first_tension(const Scene& scene, std::size_t segment = 1, std::size_t cable = 0) {
  return make_world(scene, measured()).cables[cable].segments[segment].tension;
}

/// A bob of `mass` on `length` of cable, or of a bar, from the origin, out by `angle` from straight
/// down and swinging at `speed`.
Scene pendulum(double mass, double length, double angle, double speed, bool bar) {
  const Vec2 way(std::sin(angle), -std::cos(angle));
  Scene scene;
  scene.bodies = {body("bob", BodyKind::free, length * way, 0.05, mass)};
  scene.bodies[0].velocity = speed * left(way);
  if (bar) {
    add_bar(scene, "bar", at(0.0, 0.0), on(0));
  } else {
    scene.cables = {cable(at(0.0, 0.0), {}, on(0), 0.01)};
  }
  return scene;
}

// T = m (g cos(angle) + v^2 / L). A cable only pulls, a bar keeps a bead on its circle both ways.
TEST(FirstTensions, OfPendulumsAndBeadsOnCircles) {
  const double m = 2.0, length = 1.3;
  for (const double gravity : {0.0, g}) {
    for (const double angle : {0.0, 0.7, -1.4, 2.5}) {
      for (const double speed : {0.0, 0.1, -3.0, 40.0}) {
        for (const int steps : {1, 16}) {
          const double t = m * (gravity * std::cos(angle) + speed * speed / length);
          for (const bool bar : {false, true}) {
            Scene scene = pendulum(m, length, angle, speed, bar);
            scene.gravity = {0.0, -gravity};
            scene.steps_per_frame = steps;
            const double expected = bar ? t : std::max(t, 0.0);
            EXPECT_NEAR(first_tension(scene), expected, 1e-9 * (m * g + std::abs(t)))
                << gravity << ' ' << angle << ' ' << speed << ' ' << steps << ' ' << bar;
          }
        }
      }
    }
  }
}

// Velocities that do not fit the cables meet them at once, and tensions are those after that.
TEST(FirstTensions, AreThoseAfterVelocitiesMeetTheCables) {
  const double m = 2.0, length = 1.3, speed = 3.0;
  for (const bool bar : {false, true}) {
    Scene scene = pendulum(m, length, 0.0, speed, bar);
    scene.bodies[0].velocity.y() = -5.0;
    EXPECT_NEAR(first_tension(scene), m * (g + speed * speed / length), 1e-8);
  }
}

// A cable that slackens by what figures are rounded to is taut: forces undo that within the kick.
TEST(FirstTensions, OfVelocitiesThatAreDecimalFigures) {
  const double m = 2.0, length = 1.3, speed = 3.0;
  for (const int steps : {1, 16, 64}) {
    Scene scene = pendulum(m, length, 0.0, speed, false);
    scene.bodies[0].velocity.y() = 1e-6;
    scene.steps_per_frame = steps;
    EXPECT_NEAR(first_tension(scene), m * (g + speed * speed / length), 1e-7) << steps;
    scene.bodies[0].velocity.y() = 1.0;
    EXPECT_EQ(first_tension(scene), 0.0);
  }
}

// The load m swings on the free length L, at w across it, and M hangs over a pulley of inertia I.
// While the cable runs on at A, of the load's side pulled in,
//     T1 = m (A + g u_y + w^2 / L),   T2 = M (g - A),   I A / R^2 = T2 - T1.
TEST(FirstTensions, OfASwingingAtwoodMachine) {
  const double m = 2.0, big = 3.0, pulley = 4.0, length = 1.7;
  const double r = build::pulley_radius + build::cable_half_width;
  const double inertia = 0.5 * pulley * build::pulley_radius * build::pulley_radius;
  for (const double angle : {0.0, -0.6, 0.9}) {
    for (const double across : {0.0, 1.5, -6.0}) {
      for (const double along : {0.0, 2.0, -1.0}) {
        Scene scene = load_chain(1, m, big, pulley);
        const Vec2 way = turned(Vec2(0.0, -1.0), angle);
        scene.bodies[0].position = scene.bodies[2].position - r * left(way) + length * way;
        scene.bodies[0].velocity = along * way + across * left(way);
        scene.bodies[1].velocity = {0.0, along};
        scene.bodies[2].angular_velocity = along / r;
        const double lift = g * std::cos(angle) + across * across / length;
        const double a = (big * g - m * lift) / (inertia / (r * r) + big + m);
        EXPECT_NEAR(first_tension(scene, 1), m * (a + lift), 1e-8) << angle << ' ' << across;
        EXPECT_NEAR(first_tension(scene, 2), big * (g - a), 1e-8) << angle << ' ' << across;
      }
    }
  }
}

// A ball slides down a fixed disc, off its top by `angle`, and draws another along on the floor.
// With the ways n of the forces and u of the cable,
//     n . a = -v^2 / D,   a'_y = 0,   u . (a' - a) = -(across u: v' - v)^2 / L.
TEST(FirstTensions, OfWhatMovesOverADisc) {
  constexpr double angle = 0.3, speed = 0.7, apart = 1.0, length = 0.9;
  const Vec2 n = turned(Vec2(0.0, 1.0), angle), u = turned(Vec2(1.0, 0.0), 0.4);
  Scene scene;
  scene.bodies = {body("disc", BodyKind::fixed, 0.0, 0.0, 0.9),
                  body("ball", BodyKind::free, apart * n, 0.1, 1.0),
                  body("other", BodyKind::free, apart * n + length * u, 0.1, 2.0)};
  for (Body& body : scene.bodies) body.contact_friction = 0.0;
  const Vec2 v = speed * left(n), other(v.dot(u) / u.x(), 0.0);
  scene.bodies[1].velocity = v;
  scene.bodies[2].velocity = other;
  const double floor = scene.bodies[2].position.y() - 0.1;
  scene.walls.push_back({Vec2(0.5, floor), Vec2(5.0, floor), 0.0, 0.0});
  scene.cables = {cable(on(1), {}, on(2), 0.01)};
  // Of T, the disc's force and the floor's.
  const double across = cross(u, other - v);
  Eigen::Matrix3d by;
  by << u.dot(u) * 1.5, u.dot(n), -0.5 * u.y(), u.dot(n), 1.0, 0.0, -0.5 * u.y(), 0.0, 0.5;
  const Eigen::Vector3d forces =
      by.inverse() *
      Eigen::Vector3d(across * across / length, g * n.y() - speed * speed / apart, g);
  ASSERT_GT(forces.minCoeff(), 0.0);
  EXPECT_NEAR(first_tension(scene), forces[0], 1e-8);
}

// A straight chain that hangs and turns as a whole: every piece pulls in what is below it.
TEST(FirstTensions, OfAChainThatTurnsAsAWhole) {
  constexpr double turning = 2.0, length = 1.2, load = 1.5;
  Scene scene = pendulum(load, length, 0.0, turning * length, false);
  scene.cables[0].mass_per_metre = 0.5;
  scene.cables[0].nodes = 7;
  scene.steps_per_frame = 8;
  spread_nodes(scene);
  const World world = make_world(scene, measured());
  double below = 0.0;
  for (std::size_t k = scene.cables.size(); k-- > 0;) {
    const std::size_t end = k + 1 == scene.cables.size() ? 0 : k + 1;
    const Body& body = scene.bodies[end];
    below += body.mass * (g + turning * turning * -body.position.y());
    EXPECT_NEAR(world.cables[k].segments[1].tension, below, 1e-7) << k;
  }
}

// What stands has the tensions that its weights give it, to the bit those of the kick.
TEST(FirstTensions, OfWhatStandsAreItsWeights) {
  EXPECT_EQ(first_tension(pendulum(2.0, 1.0, 0.0, 0.0, false)), 2.0 * g);
}

}  // namespace
}  // namespace pinchlab::testing
