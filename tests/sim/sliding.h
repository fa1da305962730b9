// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "tests/sim/scenes.h"

namespace pinchlab::testing {

/// How far (m) what rests moves in t (s), by its acceleration for a way and a speed (m, m/s): by
/// the method of Runge and Kutta.
template <class Acceleration>
double way_from_rest(const Acceleration& acceleration, double t) {
  constexpr int count = 400;
  const double h = t / count;
  double x = 0.0, v = 0.0;
  for (int i = 0; i < count; ++i) {
    const double k1 = acceleration(x, v), k2 = acceleration(x + 0.5 * h * v, v + 0.5 * h * k1);
    const double v3 = v + 0.5 * h * k2;
    const double k3 = acceleration(x + 0.5 * h * (v + 0.5 * h * k1), v3);
    const double k4 = acceleration(x + h * v3, v + h * k3);
    x += h * v + h * h / 6.0 * (k1 + k2 + k3);
    v += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return x;
}

/// Runs scene_of(steps) at 1 to 16 steps a frame for 20 frames: the error falls with the square of
/// the step. Its rope hangs by 0.9 m on the left, and on the right, from the height 0 to body 1, by
/// 0.4 m; reference.acceleration(left, right, speed) is that to the right.
template <class Reference, class SceneOf>
void expect_slides_as(const Reference& reference, const SceneOf& scene_of) {
  constexpr double left = 0.9, right = 0.4;  // m
  double error = 0.0;
  for (const int steps : {1, 2, 4, 8, 16}) {
    const Scene scene = scene_of(steps);
    World world = make_world(scene, measured());
    run(scene, world, 20 * steps);
    const double exact = way_from_rest(
        [&](double x, double v) { return reference.acceleration(left - x, right + x, v); },
        world.time());
    const double now = std::abs(-right - world.position[1].y() - exact);
    if (error > 0.0) {
      EXPECT_GT(error / now, 3.9) << steps;
    }
    error = now;
  }
  EXPECT_LT(error, 1e-7);
}

}  // namespace pinchlab::testing
