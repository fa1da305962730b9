// SPDX-License-Identifier: GPL-3.0-or-later
// Cables with mass that slip on the bodies that they run over.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "sim/cable/mass.h"
#include "sim/diagnostics.h"
#include "sim/make_world.h"
#include "sim/promises.h"
#include "sim/scene_error.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using std::numbers::pi;

constexpr double rope_radius = 0.2, rope_density = 0.8;  // m, of the centre line on the peg; kg/m

/// Two weights on a rope over a peg: the left one hangs by `left` m of rope, the right one by `right`.
Scene rope_over_peg(int steps, double mu, double left, double right, double m_left, double m_right,
                    BodyKind kind = BodyKind::fixed) {
  Scene scene;
  scene.steps_per_frame = steps;
  scene.bodies.push_back(body("left", BodyKind::free, -rope_radius, -left, 0.05, m_left));
  scene.bodies.push_back(body("right", BodyKind::free, rope_radius, -right, 0.05, m_right));
  scene.bodies.push_back(body("peg", kind, 0.0, 0.0, rope_radius - 0.01));
  scene.bodies[2].cable_friction = mu;
  scene.cables.push_back(cable(on(0), {{2, -1, 0}}, on(1), 0.01));
  scene.cables[0].mass_per_metre = rope_density;
  return scene;
}

// x'' = k^2 x, for x = half the difference of the ends: (rho L + m1 + m2) x'' = 2 rho g x. What is left is
// leapfrog's own error, as of the rope of Mass.ARopeOverAPulleyFallsAsItsWeightMovesOver.
TEST(MassSlip, ARopeSlidesOffASmoothPeg) {
  for (const BodyKind kind : {BodyKind::fixed, BodyKind::fixed_axle}) {
    for (const int steps : {1, 2, 4, 8, 16}) {
      const double m = 1e-6, l = 2.0 + pi * rope_radius;
      const Scene scene = rope_over_peg(steps, 0.0, 0.9, 1.1, m, m, kind);
      World world = make_world(scene, measured());
      const double k = std::sqrt(2.0 * rope_density * g / (rope_density * l + 2.0 * m));
      run(scene, world, 30 * steps);
      const double t = world.time(), kh = k / (60.0 * steps);
      const double own = 0.1 * std::sinh(k * t) * k * t * kh * kh / 24.0;
      const double fallen = -1.0 - world.position[1].y();
      printf("%d %d: %.12g exact %.12g own %.3g\n", (int)kind, steps, fallen, 0.1 * std::cosh(k * t), own);
      EXPECT_NEAR(fallen, 0.1 * std::cosh(k * t) - own, 0.01 * own + 1e-8) << steps;
      EXPECT_EQ(world.angle[2], 0.0);
    }
  }
}

/// Independent of the solver: acceleration of the rope over the peg, from its elements on the rim. Slips to
/// the right at w, with a of span on the left and b on the right.
struct PegRope {
  double mu, m_left, m_right, rho = rope_density, radius = rope_radius;

  double acceleration(double a, double b, double w) const {
    // T_right = k T_left + c0 + c1 w' over half a turn, by Simpson's rule.
    constexpr int count = 2000;
    const double k = std::exp(mu * pi);
    double c0 = 0.0, c1 = 0.0;
    for (int i = 0; i <= count; ++i) {
      const double th = pi * i / count, weight = (i == 0 || i == count ? 1.0 : i % 2 ? 4.0 : 2.0);
      const double share = weight * pi / count / 3.0 * std::exp(mu * (pi - th));
      // Up on the left, over the top, down on the right: direction (sin th, cos th), to the centre
      // (cos th, -sin th).
      const double along = rho * radius * g * std::cos(th), pressing = rho * radius * g * std::sin(th);
      c0 += share * (along + mu * (pressing - rho * w * w));
      c1 += share * rho * radius;
    }
    // (m_r + rho b) (g - w') = k (m_l + rho a) (g + w') + c0 + c1 w'
    const double right = m_right + rho * b, left = m_left + rho * a;
    return (right * g - k * left * g - c0) / (right + k * left + c1);
  }

  /// How far it has slid after t, from rest: by the method of Runge and Kutta.
  double slid(double a, double b, double t) const {
    constexpr int count = 400;
    const double h = t / count;
    double x = 0.0, w = 0.0;
    for (int i = 0; i < count; ++i) {
      const auto f = [&](double y, double v) { return acceleration(a - y, b + y, v); };
      const double k1 = f(x, w), k2 = f(x + 0.5 * h * w, w + 0.5 * h * k1);
      const double v3 = w + 0.5 * h * k2, k3 = f(x + 0.5 * h * (w + 0.5 * h * k1), v3);
      const double k4 = f(x + h * v3, w + h * k3);
      x += h * w + h * h / 6.0 * (k1 + k2 + k3);
      w += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    return x;
  }
};

TEST(MassSlip, ARopeRubsOnAPegAsItsElementsDo) {
  for (const double mu : {0.0, 0.05, 0.2, 0.5}) {
    const double m_left = 0.3, m_right = 4.0;
    const PegRope reference{mu, m_left, m_right};
    double error = 0.0;
    for (const int steps : {1, 2, 4, 8, 16}) {
      const Scene scene = rope_over_peg(steps, mu, 0.9, 0.4, m_left, m_right);
      World world = make_world(scene, measured());
      run(scene, world, 20 * steps);
      const double slid = -0.4 - world.position[1].y(), exact = reference.slid(0.9, 0.4, world.time());
      const double now = std::abs(slid - exact);
      printf("mu %g %d: %.12g exact %.12g error %.3g ratio %.3g\n", mu, steps, slid, exact, slid - exact, error / now);
      if (error > 0.0) EXPECT_GT(error / now, 3.7) << mu;
      error = now;
    }
    EXPECT_LT(error, 1e-5);
  }
}

}  // namespace
}  // namespace pinchlab::testing
