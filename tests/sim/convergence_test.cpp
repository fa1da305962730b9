// SPDX-License-Identifier: GPL-3.0-or-later
// Order of convergence on smooth curved motion, against independent solutions by GSL's odeiv2.

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <array>
#include <functional>
#include <numbers>

#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using State = std::array<double, 2>;
using Derivative = std::function<State(const State&)>;

State integrate(const Derivative& f, State y, double until) {
  gsl_odeiv2_system system{[](double, const double y_[], double dydt[], void* p) {
                             const State d = (*static_cast<const Derivative*>(p))({y_[0], y_[1]});
                             dydt[0] = d[0];
                             dydt[1] = d[1];
                             return static_cast<int>(GSL_SUCCESS);
                           },
                           nullptr, 2, const_cast<Derivative*>(&f)};
  gsl_odeiv2_driver* driver =
      gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-4, 1e-13, 1e-13);
  double t = 0.0;
  EXPECT_EQ(gsl_odeiv2_driver_apply(driver, &t, until, y.data()), GSL_SUCCESS);
  gsl_odeiv2_driver_free(driver);
  return y;
}

/// Errors at steps_per_frame = 1, 2, 4, ...; each must be a quarter of the one before.
template <typename Error>
void expect_second_order(const Error& error, int halvings) {
  double before = error(1);
  for (int i = 1; i <= halvings; ++i) {
    const double now = error(1 << i);
    EXPECT_GT(std::log2(before / now), 1.9)
        << "at " << (1 << i) << " steps a frame: " << before << " -> " << now;
    before = now;
  }
}

// A bob on a cable that unwinds from a fixed drum: l th'' + R th'^2 + g sin th = 0 with l = l0 + R
// th and th the cable's angle from the vertical.
TEST(Convergence, PendulumUnwindingFromADrum) {
  const double drum = 0.45, w = 0.05, R = drum + w, l0 = 2.0, start = 0.7;
  const auto derivative = [=](const State& y) -> State {
    const double l = l0 + R * y[0];
    return {y[1], -(R * y[1] * y[1] + g * std::sin(y[0])) / l};
  };
  const State exact = integrate(derivative, {start, 0.0}, 1.0);
  // The cable comes over the top and leaves on the right at R (cos th, sin th): swinging to the
  // right (th > 0) unwinds it.
  const auto place = [=](double th) {
    const double l = l0 + R * th;
    return Vec2(R * std::cos(th) + l * std::sin(th), R * std::sin(th) - l * std::cos(th));
  };
  expect_second_order(
      [&](int steps_per_frame) {
        Scene scene;
        scene.steps_per_frame = steps_per_frame;
        const Vec2 at0 = place(start);
        scene.bodies.push_back(body("drum", BodyKind::fixed, 0.0, 0.0, drum, 1.0));
        scene.bodies.push_back(body("bob", BodyKind::free, at0.x(), at0.y(), 0.1, 1.0));
        scene.cables.push_back(cable({0, {-R, 0.0}}, {{0, -1, 0}}, on(1), w));
        World world = make_world(scene, Method::pinch);
        run(scene, world, 60 * steps_per_frame);
        return (world.position[1] - place(exact[0])).norm();
      },
      6);
}

TEST(Convergence, VelocitiesAreReportedAtThePositionsTime) {
  const double length = 2.0, start = 1.2;
  const auto derivative = [=](const State& y) -> State {
    return {y[1], -g / length * std::sin(y[0])};
  };
  const State exact = integrate(derivative, {start, 0.0}, 1.0);
  const Vec2 velocity = length * exact[1] * Vec2(std::cos(exact[0]), std::sin(exact[0]));
  expect_second_order(
      [&](int steps_per_frame) {
        Scene scene;
        scene.steps_per_frame = steps_per_frame;
        scene.bodies.push_back(body("bob", BodyKind::free, length * std::sin(start),
                                    -length * std::cos(start), 0.1, 1.0));
        scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0)));
        World world = make_world(scene, Method::pinch);
        Workspace work;
        run(scene, world, 60 * steps_per_frame);
        return (velocities_now(scene, world, work).linear[0] - velocity).norm();
      },
      6);
}

// Two bobs swing on one cable over two heavy pulleys of finite radius: no closed form, so the
// finest run is the reference for the coarser ones.
TEST(Convergence, SwingingLoadOverTwoHeavyPulleys) {
  const auto final_position = [](int steps_per_frame) {
    Scene scene;
    scene.steps_per_frame = steps_per_frame;
    scene.bodies.push_back(body("swinging", BodyKind::free, -2.0, -2.5, 0.1, 1.0));
    scene.bodies.push_back(body("hanging", BodyKind::free, 3.55, -2.5, 0.1, 1.2));
    scene.bodies.push_back(body("first", BodyKind::fixed_axle, 0.0, 0.0, 0.5, 4.0));
    scene.bodies.push_back(body("second", BodyKind::fixed_axle, 3.0, 0.0, 0.5, 4.0));
    scene.cables.push_back(cable(on(0), {{2, -1, 0}, {3, -1, 0}}, on(1)));
    World world = make_world(scene, Method::pinch);
    run(scene, world, 60 * steps_per_frame);
    return world.position[0];
  };
  const Vec2 reference = final_position(512);
  expect_second_order(
      [&](int steps_per_frame) { return (final_position(steps_per_frame) - reference).norm(); }, 4);
}

// A roller rolls over the crown of a drum on the wrapped cable, pinched all the way, without slip.
// The cable may yield: the roller is at D = r1 + r2 + (1 - squeeze) 2w, but rolls on the cable's
// centre lines, whose radii add up to R = R1 + R2 >= D. The drum is fixed, so that the roller is an
// inverted pendulum: with phi from the vertical
//   (m D^2 + I R^2 / R2^2) phi'' = m g D sin(phi).
TEST(Convergence, RollerOverAWrappedDrum) {
  for (const double squeeze : {0.0, 0.25, 0.9}) {
    const double r1 = 0.5, r2 = 0.25, w = 0.05, start = 0.05, push = 0.8;
    const double D = r1 + r2 + (1.0 - squeeze) * 2.0 * w, R2 = r2 + w, R = r1 + w + R2;
    const double inertia = 0.5 * r2 * r2 * R * R / (R2 * R2);
    const auto derivative = [=](const State& y) -> State {
      return {y[1], g * D * std::sin(y[0]) / (D * D + inertia)};
    };
    const State exact = integrate(derivative, {-start, push}, 0.5);
    expect_second_order(
        [&](int steps_per_frame) {
          Scene scene;
          scene.steps_per_frame = steps_per_frame;
          scene.bodies.push_back(body("drum", BodyKind::fixed, 0.0, 0.0, r1, 1.0));
          Body roller =
              body("roller", BodyKind::free, -D * std::sin(start), D * std::cos(start), r2, 1.0);
          roller.velocity = D * push * Vec2(std::cos(start), std::sin(start));
          roller.angular_velocity = -R * push / R2;
          scene.bodies.push_back(roller);
          scene.cables.push_back(cable(at(-2.0, -1.0), {{0, -1, 0}}, at(2.0, -1.0), w));
          scene.cables[0].squeeze = squeeze;
          World world = make_world(scene, Method::pinch);
          run(scene, world, 30 * steps_per_frame);
          return (world.position[1] - D * Vec2(std::sin(exact[0]), std::cos(exact[0]))).norm();
        },
        5);
  }
}

}  // namespace
}  // namespace pinchlab::testing
