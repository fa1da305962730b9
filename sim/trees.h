// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Disjoint sets as trees: the parent of each item, or itself.

#include <algorithm>
#include <vector>

#include "base/at.h"

namespace pinchlab {

inline int find_root(std::vector<int>& root, int item) {
  while (at(root, item) != item) item = at(root, item) = at(root, at(root, item));
  return item;
}

/// The tree with the lesser root takes the other, so that sets come in the order of their first
/// items.
inline void join(std::vector<int>& root, int a, int b) {
  a = find_root(root, a);
  b = find_root(root, b);
  at(root, std::max(a, b)) = std::min(a, b);
}

}  // namespace pinchlab
