// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Random scenes of discs dropped on cables, and what in their motion no scene may show.

#include <cstdint>

#include "analysis/experiments/experiment.h"
#include "sim/world.h"

namespace pinchlab::experiments {

/// One to six free discs, of masses up to 1e4 apart, that fall on one to four cables over two to
/// five pulleys: taut or slack, with weights or fixed ends, or closed round two pulleys; slipping
/// or not, elastic shocks or not, drag and drive in some. The same for the same seed everywhere.
Scene dropped_discs(std::uint64_t seed);

/// The scene's mirror image in x = 0.
Scene mirrored(Scene scene);

/// How a run did. Lengths in m; largest over the run.
struct Soundness {
  bool finite = true;
  bool driven = false;          ///< by a motor or a torque: its energy may rise
  double energy_gain = 0.0;     ///< over the start's, as a share of the largest kinetic energy
  double gap_violation = 0.0;   ///< as a share of the thinnest cable's half width
  double length_error = 0.0;    ///< of a cable's material
  double loose_span = 0.0;      ///< what a span without tension is longer than its material
  double depth = 0.0;           ///< of a body in a span that it has no link on
  std::int64_t fallbacks = 0;   ///< steps whose active set did not settle
  std::vector<Vec2> positions;  ///< of the bodies at the end
};

/// Simulates a scene for so many frames of 1/60 s. A run that explodes ends early, as not finite.
Soundness run_scene(const Scene& scene, int steps_per_frame, int frames);

/// Largest distance of a body in two runs' ends (m); with `image`, the second is a mirror image.
double end_distance(const Soundness& a, const Soundness& b, bool image);

/// Runs the population at 1, 4 and 16 steps a frame, and writes population.csv and population.md.
void run_population(const Options& options);

}  // namespace pinchlab::experiments
