// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Storage of the iterative solve.

#include <Eigen/Core>
#include <vector>

namespace pinchlab {

/// What the impulse of a row may be.
enum class Clamp {
  tension,   ///< >= 0
  friction,  ///< |impulse| <= bound * impulse of the row `other`, or without one <= bound
  middle,    ///< >= 0, and at most bound above the impulse of `other`, its opposite in a pinch
};

/// A row with all that a sweep reads of it, in one piece.
struct SweepRow {
  int a = 0, b = 0;  // places of the part's bodies
  int third = -1;    // of PartSystem::thirds, or -1
  int other = -1;    // see Clamp
  Clamp clamp = Clamp::tension;
  bool by_run = false;  // relaxed with the body that its cable slides over
  // w = ja va + jb vb + bias + compliance * impulse
  Eigen::Vector3d ja = Eigen::Vector3d::Zero(), jb = ja;
  // Velocity change of the bodies by a unit impulse.
  Eigen::Vector3d response_a = Eigen::Vector3d::Zero(), response_b = response_a;
  double bias = 0.0;        // m/s
  double compliance = 0.0;  // 1/kg
  double stiffness = 0.0;   // 1/kg, dw / dimpulse; 0 where nothing can move
  double bound = 0.0;       // see Clamp
  double impulse = 0.0;     // N s
};

struct SweepScratch {
  std::vector<SweepRow> rows;  // as PartSystem::rows: those of cables, then those of contacts; by
                               // solve_iterative
};

}  // namespace pinchlab
