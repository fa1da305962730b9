// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The iterative solve: projected Gauss-Seidel sweeps, as in the thesis and in most engines.

#include <Eigen/Core>
#include <vector>

namespace pinchlab {

struct Scene;
struct World;

/// What the impulse of a row may be.
enum class Clamp {
  tension,   ///< >= 0
  friction,  ///< |impulse| <= bound * impulse of the row `other`, or without one <= bound
  middle,    ///< >= 0, and at most bound above the impulse of `other`, its opposite in a pinch
};

/// A row with all that a sweep reads of it, in one piece. The world is a body too, the last one,
/// which nothing moves.
struct SweepRow {
  int a, b;        // bodies
  int other = -1;  // see Clamp
  Clamp clamp;
  bool by_run;                             // relaxed with the body that its cable slides over
  Eigen::Vector3d ja, jb;                  // w = ja va + jb vb + bias + compliance * impulse
  Eigen::Vector3d response_a, response_b;  // velocity change of the bodies by a unit impulse
  double bias;                             // m/s
  double compliance;                       // 1/kg
  double stiffness;                        // 1/kg, dw / dimpulse; 0 where nothing can move
  double bound;                            // see Clamp
  double impulse;                          // N s
};

struct SweepScratch {
  std::vector<SweepRow> rows;  // as Scratch::rows: those of cables, then those of contacts
  std::vector<Eigen::Vector3d> velocity;  // m/s, m/s, rad/s, one a body, and the world's
};

/// Does what solve_direct (active_set.h) does, by configuration.iterations sweeps over all rows,
/// starting from no impulse (thesis: Solver). Of a violated position a row asks to make up a part
/// only, 0.2 for cables and 0.7 for contacts; one that is not violated may close entirely.
///
/// Where a cable may slide over a body, the speed of slip is one more unknown: a sweep moves it
/// until the tensions before and after obey the capstan law. The more sweeps, the nearer to
/// solve_direct. With a few, tensions are too low and cables give; nothing is kept from step to
/// step.
void solve_iterative(const Scene& scene, World& world, int part, double kick);

}  // namespace pinchlab
