// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that land on hanging cables of nodes: sim/cable/waves.h.

#include <algorithm>

#include "tests/sim/random_loads.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

/// The most (J) that a scene's energy has risen by since it was least, and that has been at play.
struct Rise {
  double most = 0.0, at_play = 0.0;
};

Rise rise_in(Scene scene, int steps, double seconds) {
  scene.steps_per_frame = steps;
  World world = make_world(scene, measured());
  Workspace work;
  Rise rise;
  double least = infinity;
  while (world.time() < seconds) {
    if (step(scene, world, work) != StepStatus::ok) {
      ADD_FAILURE() << world.failure;
      break;
    }
    const double energy = world.diagnostics.energy;
    least = std::min(least, energy);
    rise.most = std::max(rise.most, energy - least);
    rise.at_play = std::max(rise.at_play, kinetic_energy(world));
  }
  return rise;
}

// A load pulls the cable taut within a few milliseconds, by tensions a thousand times its weight.
// What rises is leapfrog's own swing while waves run by whole steps.
TEST(Loads, LandingMakesNoEnergy) {
  for (const double mass : {3.0, 10.0, 30.0}) {
    for (const double velocity : {0.0, -5.0}) {
      for (const auto& [nodes, tolerance] :
           {std::pair(0, 0.0), {7, 0.0}, {31, 0.0}, {7, 0.005}, {31, 0.005}}) {
        for (const int steps : {1, 4, 16}) {
          const Rise rise = rise_in(load_on_cable({mass, velocity, nodes, tolerance}), steps, 2.0);
          EXPECT_LT(rise.most, 0.02 * rise.at_play)
              << mass << " kg at " << velocity << " m/s on " << nodes << " nodes to " << tolerance
              << " m, " << steps << " steps a frame";
        }
      }
    }
  }
}

// So it is with what lands anywhere, by any friction and restitution.
TEST(Loads, RandomLandingsMakeNoEnergy) {
  for (int seed = 0; seed < seeds_of(120); ++seed) {
    for (const int steps : {1, 4, 16}) {
      const Rise rise = rise_in(random_load(seed), steps, 1.0);
      EXPECT_LT(rise.most, 0.02 * rise.at_play) << seed << " at " << steps << " steps a frame";
    }
  }
}

// The tensions that steps are divided for are part of the state.
TEST(Loads, AClearedWorkspaceChangesNoBit) {
  for (int seed = 0; seed < seeds_of(20); ++seed) {
    EXPECT_TRUE(is_all_state(random_load(seed), Method::pinch, 240)) << seed;
  }
}

}  // namespace
}  // namespace pinchlab::testing
