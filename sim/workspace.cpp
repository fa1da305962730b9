// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/workspace.h"

#include <atomic>

namespace pinchlab {

void fit(const World& world, Workspace& work) {
  if (world.stamp != 0 && world.stamp == work.stamp) return;
  work = Workspace{};
  find_parts(world, work);
}

void mark(World& world, Workspace& work) {
  // Never the same twice in a process, so that no workspace takes one state for another. No result
  // depends on it.
  static std::atomic<std::uint64_t> last{0};
  world.stamp = work.stamp = ++last;
}

}  // namespace pinchlab
