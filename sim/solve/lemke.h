// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Linear complementarity problems, by Lemke's method (Bimatrix equilibrium points and mathematical
// programming, Management Science 11, 1965): for a matrix M and a vector q
//     w = M z + q,   z >= 0,   w >= 0,   z'w = 0,
// where some z may have either sign, and then w = 0. An artificial variable makes all w positive
// and leaves by complementary pivots. If M is copositive (z'M z >= 0 for z >= 0) the method ends
// with a solution unless z >= 0 with M z >= 0, z'M z = 0 and q'z < 0 tells that there need be none
// (Cottle, Pang & Stone, The Linear Complementarity Problem, 1992, 4.4). Ties are resolved
// lexicographically, so that it does not circle.

#include <vector>

#include "base/at.h"

namespace pinchlab {

/// A problem and what solve_complementarity finds of it, in storage that is used again.
struct Complementarity {
  int size = 0;
  std::vector<double> matrix;  // size x size, one row after another
  std::vector<double> q;
  std::vector<char> either;  // of each z: it may have either sign
  double round_off = 0.0;    // of q: w no further below zero than that are zero

  std::vector<double> z;
  std::vector<char>
      bears;  // of each z: it is one of the unknowns that solve w = 0; if it is 0 too,
              // the problem is degenerate
  // Storage.
  std::vector<double> tableau;
  std::vector<int> basis;

  /// Starts a problem of that size, of zeros.
  void begin(int count);

  double& entry(int row, int column) { return matrix[index(row) * index(size) + index(column)]; }
};

/// Whether a solution is found, in `z` and `bears`. What repeats others of those that may have
/// either sign stays 0. Of scaled problems: diagonals of M of about 1.
bool solve_complementarity(Complementarity& problem);

/// Adds to `z` what makes up for what the w that are to be zero miss: `missing` has one each, and
/// zeros. After solve_complementarity.
void correct(const std::vector<double>& missing, Complementarity& problem);

}  // namespace pinchlab
