// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Linear complementarity problems, by Lemke's method (Bimatrix equilibrium points and mathematical
// programming, Management Science 11, 1965): for a matrix M and a vector q
//     w = M z + q,   z >= 0,   w >= 0,   z'w = 0,
// where some z may have either sign, and then w = 0. An artificial variable makes all w positive
// and leaves by complementary pivots. If M is copositive (z'M z >= 0 for z >= 0) the method ends
// with a solution unless z >= 0 with M z >= 0, z'M z = 0 and q'z < 0 tells that there need be none
// (Cottle, Pang & Stone, The Linear Complementarity Problem, 1992, 4.4). Ties are resolved
// lexicographically, so that it does not circle. Pivots may be made in doubles, but where rows
// nearly repeat or contradict one another these tell neither that they do not, nor by how much.

#include <vector>

#include "base/at.h"
#include "sim/solve/extended.h"

namespace pinchlab {

/// A problem and what is found of it, in storage that is used again.
struct Complementarity {
  int size = 0;
  std::vector<Extended> matrix;  // size x size, one row after another
  std::vector<Extended> q;
  std::vector<char> either;  // of each z: it may have either sign
  double yielding = 0.0;     // added to M's diagonal: what repeats itself shares alike

  std::vector<char> bears;  // of each z: it is one of the unknowns that solve w = 0; if it is 0
                            // too, the problem is degenerate. By find_bearing
  std::vector<Extended> z;  // by solve_for_bearing
  // Storage.
  std::vector<Extended> tableau;
  std::vector<double> rough_tableau;
  std::vector<int> basis, outside;  // variables, of rows and of columns
  std::vector<int> place;           // of each variable: its column, or -1

  /// Starts a problem of that size, of zeros.
  void begin(int count);

  Extended& entry(int row, int column) { return matrix[index(row) * index(size) + index(column)]; }
};

/// In which pivots are made.
enum class Numbers { doubles, extended };

/// Finds which z bear in a solution; whether it has. What repeats others of those that may have
/// either sign stays 0. Of scaled problems: diagonals of M of about 1.
bool find_bearing(Complementarity& problem, Numbers numbers);

/// Gives the z that bear in the solution the values that make their w zero with another `yielding`,
/// which may contradict their signs. Values come from the matrix itself, by the greatest pivots
/// that there are, and are right to round-off; those by which the method has come to the solution
/// may be small. What repeats others stays 0.
void solve_for_bearing(Complementarity& problem, double yielding);

}  // namespace pinchlab
