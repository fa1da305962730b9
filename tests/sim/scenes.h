// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the simulator's tests share.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "demos/scenes/build.h"
#include "sim/step.h"
#include "sim/world.h"

namespace pinchlab::testing {

using build::at;
using build::body;
using build::cable;
using build::load_chain;
using build::on;

constexpr double g = 9.81;  // m/s^2, the default gravity

/// The method, with lengths, gaps and energy measured at each step.
inline Configuration measured(Method method = Method::pinch) {
  Configuration configuration = method;
  configuration.diagnostics = true;
  return configuration;
}

inline void run(const Scene& scene, World& world, int steps) {
  Workspace work;
  for (int i = 0; i < steps; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
  }
}

}  // namespace pinchlab::testing
