// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/diagnostics.h"
#include "tests/sim/random.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {

/// What came of a run.
struct Course {
  std::vector<double> end;             // of all bodies: m, m, rad
  double energy = 0.0;                 // J, its largest change since the second step's start
  double gained = 0.0, at_play = 0.0;  // J, since the start
  double gap = 0.0, stretch = 0.0;     // m
};

/// Of the energy at play, by which that of random heavy ropes may swing at a step a frame, falling
/// with the square of the step.
constexpr double swing_of_heavy_ropes = 2.7e-4;

inline Course run_measured(const Scene& scene, double seconds) {
  Course course;
  World world = make_world(scene, measured());
  Workspace work;
  double first = 0.0, start = 0.0;
  for (int i = 0; i < seconds * 60 * scene.steps_per_frame; ++i) {
    EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    if (!world.failure.empty()) break;
    const Diagnostics& d = world.diagnostics;
    if (i == 0) start = d.energy;
    if (i < 2) first = d.energy;
    course.energy = std::max(course.energy, std::abs(d.energy - first));
    course.gained = std::max(course.gained, d.energy - start);
    course.at_play = std::max(course.at_play, start - potential_energy(scene, world));
    course.gap = std::max(course.gap, d.largest_gap_violation);
    course.stretch = std::max(course.stretch, d.largest_stretch);
  }
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    course.end.insert(course.end.end(),
                      {world.position[b].x(), world.position[b].y(), world.angle[b]});
  }
  return course;
}

/// Of a run of a random scene with one rope: energy rose by no more than that share of what was at
/// play, and gaps and lengths were exact.
inline void expect_sound(const Scene& scene, const Course& course, double share, unsigned seed) {
  const double w = scene.cables[0].half_width;
  const int steps = scene.steps_per_frame;
  EXPECT_LE(course.gained, share * course.at_play)
      << "seed " << seed << ", " << steps << " steps a frame";
  EXPECT_LE(course.gap, 1e-6 * w) << "seed " << seed << ", " << steps << " steps a frame";
  EXPECT_LE(course.stretch, 1e-6 * w) << "seed " << seed << ", " << steps << " steps a frame";
}

/// Runs random heavy ropes that do not slip, for 1.5 s at 1, 4 and 16 steps a frame: of those that
/// do not stretch energy rises by no more than it swings by, and lengths and gaps are exact. How
/// many those runs are.
inline int run_heavy_ropes(Scene (*rope)(unsigned), unsigned count) {
  int ran = 0;
  for (unsigned seed = 0; seed < seeds_of(count); ++seed) {
    for (const int steps : {1, 4, 16}) {
      Scene scene = rope(seed);
      scene.steps_per_frame = steps;
      const Course course = run_measured(scene, 1.5);
      if (scene.cables[0].axial_stiffness < infinity) continue;
      expect_sound(scene, course, swing_of_heavy_ropes / (steps * steps), seed);
      ++ran;
    }
  }
  return ran;
}

/// J, by which the energy of a measured world has changed at most since its first step's start.
/// Calls `check` after each step.
template <class Check>
double energy_drift(const Scene& scene, World& world, int steps, const Check& check) {
  Workspace work;
  double start = 0.0, drift = 0.0;
  for (int i = 0; i < steps && !::testing::Test::HasFatalFailure(); ++i) {
    EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    if (!world.failure.empty()) break;
    if (i == 0) start = world.diagnostics.energy;
    drift = std::max(drift, std::abs(world.diagnostics.energy - start));
    check();
  }
  return drift;
}

inline double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

}  // namespace pinchlab::testing
