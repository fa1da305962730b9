// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace pinchlab {

/// One summand: coefficient times the unknown, or the row, of this index.
struct Term {
  int index;
  double coefficient;
};

/// A row's share in the equation of an unknown.
struct EquationTerm {
  int unknown;
  int row;
  double coefficient;
};

/// Several lists in one array: list i is items[begin[i]] up to items[begin[i + 1]].
template <typename T>
struct Lists {
  std::vector<int> begin;
  std::vector<T> items;
};

}  // namespace pinchlab
