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
  int a, b;        // places of the part's bodies
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
  std::vector<SweepRow> rows;  // as PartSystem::rows: those of cables, then those of contacts
};

}  // namespace pinchlab
