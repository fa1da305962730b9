// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A direct solver for matrices of symmetric structure that are narrow about their diagonal.

#include <vector>

#include "base/at.h"
#include "sim/solve/profile_ldl.h"

namespace pinchlab {

/// LU factors without pivoting inside the matrix' profile (skyline; George & Liu 1981, ch. 4): row
/// u and column u are kept from first[u] to the diagonal. The work is the sum of the squared
/// widths: linear for a cable, whose matrix is tridiagonal.
///
/// A pivot below `dependence` times the diagonal's scale means that the row repeats earlier ones;
/// its unknown is left at zero (a basic solution) and counted.
class ProfileLu {
 public:
  static constexpr double dependence = ProfileLdl::dependence;

  /// Starts an n x n matrix of zeros; first[u] <= u is the least index coupled with u.
  void reset(const std::vector<int>& first);

  int size() const { return static_cast<int>(first_.size()); }
  /// Adds to entry (u, v); |u - v| must lie inside the profile.
  void add(int u, int v, double value) {
    if (v < u) {
      lower_.data()[at(offset_, u) + v] += value;
    } else {
      upper_.data()[at(offset_, v) + u] += value;
    }
  }

  /// Factors in place. `scale[u]` > 0 is the size against which pivot u is judged; `ridge` times it
  /// is added to the diagonal first. Returns how many rows were dependent.
  int factor(const std::vector<double>& scale, double ridge);

  /// Solves in place.
  void solve(std::vector<double>& x) const;

 private:
  std::vector<int> first_;
  std::vector<int> offset_;    // of (imaginary) column 0 of row u in lower_ and upper_
  std::vector<double> lower_;  // rows, unit diagonal not stored
  std::vector<double> upper_;  // columns, with the diagonal (0: dependent)
};

}  // namespace pinchlab
