// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Element of an array by a signed index, as links, rows and bodies refer to one another.

#include <cassert>
#include <cstddef>

namespace pinchlab {

inline std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

/// items[i]; in builds without NDEBUG an index out of range stops the program.
template <class Items>
decltype(auto) at(Items& items, int i) {
  assert(i >= 0 && index(i) < items.size());
  return items[index(i)];
}

}  // namespace pinchlab
