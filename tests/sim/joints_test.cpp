// SPDX-License-Identifier: GPL-3.0-or-later
// Bars, hinges, springs and stops.

#include "sim/joints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/at.h"
#include "sim/diagnostics.h"
#include "sim/scene_error.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

Scene still_air(int steps_per_frame) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  scene.steps_per_frame = steps_per_frame;
  return scene;
}

/// y(time) of y'' = f(y), from rest, by the classical Runge-Kutta method.
template <std::size_t n>
std::array<double, n> runge_kutta(
    std::array<double, n> y, double time, int steps,
    const std::function<std::array<double, n>(const std::array<double, n>& y,
                                              const std::array<double, n>& v)>& f) {
  std::array<double, n> v{};
  const double h = time / steps;
  const auto plus = [](std::array<double, n> a, double s, const std::array<double, n>& b) {
    for (std::size_t i = 0; i < n; ++i) a[i] += s * b[i];
    return a;
  };
  for (int k = 0; k < steps; ++k) {
    const auto a1 = f(y, v), v2 = plus(v, 0.5 * h, a1);
    const auto a2 = f(plus(y, 0.5 * h, v), v2), v3 = plus(v, 0.5 * h, a2);
    const auto a3 = f(plus(y, 0.5 * h, v2), v3), v4 = plus(v, h, a3);
    const auto a4 = f(plus(y, h, v3), v4);
    for (std::size_t i = 0; i < n; ++i) {
      y[i] += h / 6.0 * (v[i] + 2.0 * v2[i] + 2.0 * v3[i] + v4[i]);
      v[i] += h / 6.0 * (a1[i] + 2.0 * a2[i] + 2.0 * a3[i] + a4[i]);
    }
  }
  return y;
}

/// A crank of 0.3 m that turns at 8 rad/s, a bar of 1 m and a slider on the x axis.
Scene slider_crank(int steps_per_frame) {
  Scene scene = still_air(steps_per_frame);
  scene.bodies.push_back(body("crank", BodyKind::fixed_axle, 0.0, 0.0, 0.35));
  scene.bodies[0].driven_angular_velocity = 8.0;
  scene.bodies.push_back(body("slider", BodyKind::rail, 1.3, 0.0, 0.1, 2.0));
  scene.bodies[1].rail_axis = {1.0, 0.0};
  add_bar(scene, "rod", {0, {0.3, 0.0}}, on(1));
  return scene;
}

// The slider is where the crank has it, x = r cos th + sqrt(l^2 - r^2 sin^2 th), at whatever step:
// lengths are exact at its end. The bar pushes for half of each turn.
TEST(Joints, SliderIsWhereItsCrankHasIt) {
  for (const int steps : {1, 4, 16}) {
    const Scene scene = slider_crank(steps);
    World world = make_world(scene, Method::pinch);
    Workspace work;
    double pull = 0.0, push = 0.0;
    for (int i = 0; i < 60 * steps; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      const double turned = world.angle[0], r = 0.3;
      const double x = r * std::cos(turned) + std::sqrt(1.0 - std::pow(r * std::sin(turned), 2));
      ASSERT_NEAR(world.position[1].x(), x, 1e-10) << i;
      pull = std::max(pull, world.cables[0].segments[1].tension);
      push = std::min(push, world.cables[0].segments[1].tension);
    }
    // The slider's greatest accelerations, at its ends: r w^2 (1 +- r / l).
    const double outer = 2.0 * 0.3 * 64.0 * 1.3, inner = 2.0 * 0.3 * 64.0 * 0.7;
    EXPECT_NEAR(pull, outer, 0.05 * outer) << steps;
    EXPECT_LT(push, -0.95 * inner) << steps;
    EXPECT_EQ(world.diagnostics.events, 0);
  }
}

// A disc hinged to the world off its centre: I th'' = -m g d sin th with I = m r^2 / 2 + m d^2.
TEST(Joints, HingedDiscIsAPendulum) {
  const double radius = 0.4, off = 0.3, start = 1.2;
  const double inertia = 0.5 * radius * radius + off * off;
  const auto exact = runge_kutta<1>({start}, 1.0, 4000, [&](const auto& th, const auto&) {
    return std::array{-g * off * std::sin(th[0]) / inertia};
  });
  std::vector<double> errors;
  for (const int steps : {2, 4, 8, 16}) {
    Scene scene;
    scene.steps_per_frame = steps;
    scene.bodies.push_back(
        body("disc", BodyKind::free, off * std::sin(start), -off * std::cos(start), radius, 3.0));
    add_hinge(scene, "pin", 0, -1, Vec2::Zero());
    World world = make_world(scene, Method::pinch);
    run(scene, world, 60 * steps);
    errors.push_back(std::abs(start + world.angle[0] - exact[0]));
    const double angle = start + world.angle[0];
    EXPECT_LT((world.position[0] - off * Vec2(std::sin(angle), -std::cos(angle))).norm(), 1e-10);
  }
  EXPECT_LT(errors.back(), 1e-4);
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_GT(errors[i - 1] / errors[i], 3.5) << i;
}

/// Two discs, the first hinged to the world at its rim, the second to the first one's other side,
/// so that they overlap.
Scene double_pendulum(int steps_per_frame) {
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  for (const char* name : {"upper", "lower"}) {
    const double x = scene.bodies.empty() ? 0.2 : 0.6;
    scene.bodies.push_back(body(name, BodyKind::free, x, 0.0, 0.25, 1.0));
  }
  add_hinge(scene, "axle", 0, -1, Vec2::Zero());
  add_hinge(scene, "elbow", 1, 0, Vec2(0.4, 0.0));
  return scene;
}

// Lagrange's equations of two equal discs with their hinges d before and behind their centres, q
// the angles from the start's.
TEST(Joints, DoublePendulumFollowsLagrange) {
  const double d = 0.2, own = 0.5 * 0.25 * 0.25;
  const auto exact = runge_kutta<2>({0.0, 0.0}, 0.8, 8000, [&](const auto& q, const auto& v) {
    const double c = std::cos(q[0] - q[1]), s = std::sin(q[0] - q[1]);
    const double m00 = own + 5.0 * d * d, m01 = 2.0 * d * d * c, m11 = own + d * d;
    const double f0 = -3.0 * g * d * std::cos(q[0]) - 2.0 * d * d * s * v[1] * v[1];
    const double f1 = -g * d * std::cos(q[1]) + 2.0 * d * d * s * v[0] * v[0];
    const double det = m00 * m11 - m01 * m01;
    return std::array{(m11 * f0 - m01 * f1) / det, (m00 * f1 - m01 * f0) / det};
  });
  std::vector<double> errors;
  for (const int steps : {2, 4, 8, 16}) {
    const Scene scene = double_pendulum(steps);
    World world = make_world(scene, Method::pinch);
    run(scene, world, 48 * steps);
    errors.push_back(
        std::max(std::abs(world.angle[0] - exact[0]), std::abs(world.angle[1] - exact[1])));
  }
  EXPECT_LT(errors.back(), 1e-3);
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_GT(errors[i - 1] / errors[i], 3.4) << i;
}

// Chaos leaves no exact motion to compare with; energy and the hinges' places stay.
TEST(Joints, HingesHoldForMinutes) {
  const Scene scene = double_pendulum(4);
  World world = make_world(scene, measured());
  Workspace work;
  double least = infinity, most = -infinity;
  for (int i = 0; i < 60 * 240; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    const auto point = [&](std::size_t b, double x) {
      return Vec2(world.position[b] + x * Vec2(std::cos(world.angle[b]), std::sin(world.angle[b])));
    };
    ASSERT_LT(point(0, -0.2).norm(), 1e-10) << i;
    ASSERT_LT((point(0, 0.2) - point(1, -0.2)).norm(), 1e-10) << i;
    least = std::min(least, world.diagnostics.energy);
    most = std::max(most, world.diagnostics.energy);
  }
  EXPECT_TRUE(world.contacts.empty());
  // At play are 3 m g d = 5.9 J either way; leapfrog swings by the square of the step.
  EXPECT_LT(most, 0.05);
  EXPECT_GT(least, -0.25);
}

/// A mass of 2 kg beside a spring of 50 N/m and 1 m, 0.4 m compressed.
Scene spring_and_mass(double damping, int steps_per_frame, double stiffness = 50.0) {
  Scene scene = still_air(steps_per_frame);
  scene.bodies.push_back(body("mass", BodyKind::free, 0.6, 0.0, 0.2, 2.0));
  add_spring(scene, "spring", at(0.0, 0.0), on(0), stiffness, 1.0, damping);
  return scene;
}

// x = l0 - a e^(-g t) (cos w t + g / w sin w t), g = c / 2 m, w^2 = k / m - g^2.
TEST(Joints, SpringsSwingAndDieAwayAsTheyShould) {
  for (const double damping : {0.0, 3.0}) {
    std::vector<double> errors;
    for (const int steps : {2, 4, 8, 16}) {
      const Scene scene = spring_and_mass(damping, steps);
      World world = make_world(scene, Method::pinch);
      const double rate = damping / 4.0, w = std::sqrt(25.0 - rate * rate), t = 1.75;
      run(scene, world, 105 * steps);
      const double x =
          1.0 - 0.4 * std::exp(-rate * t) * (std::cos(w * t) + rate / w * std::sin(w * t));
      errors.push_back(std::abs(world.position[0].x() - x));
    }
    EXPECT_LT(errors.back(), 1e-5) << damping;
    for (std::size_t i = 1; i < errors.size(); ++i) {
      EXPECT_NEAR(errors[i - 1] / errors[i], 4.0, 0.3) << damping << ' ' << i;
    }
  }
}

TEST(Joints, UndampedSpringsKeepTheirEnergy) {
  const Scene scene = spring_and_mass(0.0, 4);
  World world = make_world(scene, measured());
  Workspace work;
  for (int i = 0; i < 20000; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    ASSERT_NEAR(world.diagnostics.energy, 4.0, 0.005) << i;  // k a^2 / 2
  }
}

// However stiff and however damped: it comes to rest where it is as long as it wants to be.
TEST(Joints, StiffSpringsAndDampersAreStable) {
  for (const double stiffness : {1e3, 1e6, 1e9, 1e12}) {
    for (const double damping : {1e1, 1e4, 1e7}) {
      const Scene scene = spring_and_mass(damping, 4, stiffness);
      World world = make_world(scene, Method::pinch);
      run(scene, world, 2400);
      const double x = world.position[0].x();
      if (stiffness / damping > 1.0) {
        EXPECT_NEAR(x, 1.0, 1e-6) << stiffness << ' ' << damping;
      }
      EXPECT_GE(x, 0.6 - 1e-9);
      EXPECT_LE(x, 1.0 + 0.41);
    }
  }
}

// A ball thrown up a slanting rail reaches the upper stop with v^2 = v0^2 - 2 g s h, stays until it
// falls, from rest, and ends on the lower one.
TEST(Joints, StopsEndTravelWhenItIsReached) {
  const double slope = 0.6, a = g * std::sin(slope), up = 1.0, down = -0.5, fast = 5.0;
  const Vec2 axis(std::cos(slope), std::sin(slope));
  for (const int steps : {1, 4, 32}) {
    Scene scene;
    scene.steps_per_frame = steps;
    scene.bodies.push_back(body("carriage", BodyKind::rail, 0.0, 0.0, 0.2, 1.0));
    scene.bodies[0].rail_axis = axis;
    scene.bodies[0].velocity = fast * axis;
    add_stops(scene, 0, down, up);
    World world = make_world(scene, Method::pinch);
    const double arrives = (fast - std::sqrt(fast * fast - 2.0 * a * up)) / a;
    const double lands = arrives + std::sqrt(2.0 * (up - down) / a);
    Workspace work;
    for (int i = 1; i <= 120 * steps; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      const double t = world.time();
      const double x = t < arrives ? fast * t - 0.5 * a * t * t
                       : t < lands ? up - 0.5 * a * (t - arrives) * (t - arrives)
                                   : down;
      ASSERT_NEAR(world.position[0].dot(axis), x, 1e-9) << steps << ' ' << i;
    }
    EXPECT_EQ(world.diagnostics.events, 2);
    EXPECT_NEAR(world.cables[0].segments[1].tension, a, 1e-6);  // of 1 kg
  }
}

TEST(Joints, ACarriageMayStartAtItsStop) {
  Scene scene;
  scene.bodies.push_back(body("carriage", BodyKind::rail, 0.3, 0.1, 0.2, 1.0));
  add_stops(scene, 0, 0.0, 2.0);
  World world = make_world(scene, Method::pinch);
  run(scene, world, 100);
  EXPECT_NEAR(world.position[0].y(), 0.1, 1e-12);
}

// Plain cable joints and the thesis' solver have joints too, as near as their steps have them.
TEST(Joints, HoldUnderEveryMethod) {
  for (const Configuration& method : {Configuration(Method::pinch_no_contact),
                                      Configuration(Method::cable), thesis_configuration()}) {
    const Scene scene = double_pendulum(16);
    World world = make_world(scene, method);
    run(scene, world, 48 * 16);
    const double c = std::cos(world.angle[0]), s = std::sin(world.angle[0]);
    EXPECT_LT((world.position[0] - 0.2 * Vec2(c, s)).norm(), 2e-3) << to_string(method);
    EXPECT_LT(world.position[1].norm(), 0.61) << to_string(method);
    const Scene crank = slider_crank(16);
    World turning = make_world(crank, method);
    run(crank, turning, 60 * 16);
    const double x = 0.3 * std::cos(8.0) + std::sqrt(1.0 - std::pow(0.3 * std::sin(8.0), 2));
    EXPECT_NEAR(turning.position[1].x(), x, 2e-3) << to_string(method);
  }
}

// A motor without a limit whose linkage ends at a stop stalls there.
TEST(Joints, AJammedMotorStalls) {
  Scene scene = slider_crank(4);
  add_stops(scene, 1, -0.3, 0.01);
  World world = make_world(scene, Method::pinch);
  run(scene, world, 400);
  EXPECT_LT(world.position[1].x(), 1.31 + 1e-6);
  EXPECT_GT(world.position[1].x(), 0.99);
}

// What swings on joints alone loses energy where springs are damped and bodies meet, and gains
// none: by how much it rises above its least so far is leapfrog's own swing, which falls with the
// square of the step (the lightest body on the stiffest spring: omega h = 0.2 at 4 steps a frame).
TEST(Joints, RandomLinkagesMakeNoEnergy) {
  int runs = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    Scene scene = linkage(seed);
    for (const int steps : {4, 16}) {
      scene.steps_per_frame = steps;
      World world = make_world(scene, measured());
      Workspace work;
      double least = infinity, rise = 0.0, at_play = 0.0;
      for (int i = 0; i < 60 * steps; ++i) {
        ASSERT_EQ(step(scene, world, work), StepStatus::ok) << seed << ' ' << world.failure;
        if (i == 0) continue;  // its velocities need not fit the joints
        const double energy = world.diagnostics.energy;
        least = std::min(least, energy);
        rise = std::max(rise, energy - least);
        at_play = std::max(at_play, energy - potential_energy(scene, world));
        ASSERT_LT(world.diagnostics.largest_stretch, 1e-9) << seed << ' ' << i;
      }
      ++runs;
      EXPECT_LT(rise, (steps == 4 ? 0.03 : 0.004) * at_play) << seed << ", " << steps << " steps";
    }
  }
  EXPECT_EQ(runs, 600);
}

TEST(Joints, AClearedWorkspaceChangesNoBit) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    EXPECT_TRUE(is_all_state(linkage(seed), Method::pinch, 240)) << seed;
  }
}

TEST(Joints, RefuseWhatCannotBe) {
  Scene scene = still_air(1);
  scene.bodies.push_back(body("disc", BodyKind::free, 0.0, 0.0, 0.5));
  EXPECT_THROW(add_bar(scene, "bar", on(0), on(0)), SceneError);
  EXPECT_THROW(add_bar(scene, "bar", at(0.0, 0.0), at(1.0, 0.0)), SceneError);
  EXPECT_THROW(add_bar(scene, "bar", on(0), at(0.0, 0.0)), SceneError);
  EXPECT_THROW(add_spring(scene, "spring", on(0), at(0.0, 0.0), 1.0, 1.0, 0.0), SceneError);
  EXPECT_THROW(add_hinge(scene, "pin", 0, 0, Vec2::Zero()), SceneError);
  EXPECT_TRUE(scene.cables.empty());
}

}  // namespace
}  // namespace pinchlab::testing
