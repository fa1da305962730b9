// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What no motion may show, counted over random scenes at several lengths of the step.

#include <cstdint>
#include <vector>

#include "analysis/experiments/experiment.h"
#include "sim/configuration.h"
#include "sim/world.h"

namespace pinchlab::experiments {

/// How a run did. Lengths in m; largest over the run.
struct Soundness {
  bool finite = true;
  bool driven = false;         ///< by a motor or a torque: its energy may rise
  double energy_gain = 0.0;    ///< over the start's, as a share of the largest kinetic energy
  double lasting_gain = 0.0;   ///< the same, that it stays above for a tenth of a second
  double gap_violation = 0.0;  ///< as a share of the thinnest cable's half width; m without cables
  double length_error = 0.0;   ///< of a cable's material
  double loose_span = 0.0;     ///< what a span without tension is longer than its material
  double depth = 0.0;          ///< of a body in a span that it has no link on
  std::int64_t unsettled = 0;  ///< steps whose active set did not settle
  std::int64_t late_events = 0;  ///< steps with more events than are located
  std::vector<Vec2> positions;   ///< of the bodies at the end
};

/// Simulates a scene for so many frames. A run that explodes ends early, as not finite.
Soundness run_scene(Scene scene, const Configuration& configuration, int steps_per_frame,
                    int frames);

/// Largest distance of a body between two runs' ends (m); with `image`, the second is a mirror
/// image. Not finite where either run is not.
double end_distance(const Soundness& a, const Soundness& b, bool image);

struct PopulationRun {
  Options options;
  int scenes = 2000;          ///< of dropped_discs
  int shapely_scenes = 1000;  ///< of each kind of shapes: population_scenes.h
  int first = 1;              ///< seed of the first of each
};

/// Writes population.csv, population_shapes.csv, population_ropes.csv, population_tables.csv and
/// population.md.
void run_population(const PopulationRun& run);

}  // namespace pinchlab::experiments
