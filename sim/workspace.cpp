// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/workspace.h"

#include <atomic>
#include <utility>

namespace pinchlab {

void fit(const World& world, Workspace& work) {
  if (world.stamp != 0 && world.stamp == work.stamp) return;
  // The storage of systems stays, and nothing of what they were made for.
  Workspace fresh;
  fresh.systems = std::move(work.systems);
  for (PartSystem& s : fresh.systems) forget(s);
  work = std::move(fresh);
  find_parts(world, work);
}

void mark(World& world, Workspace& work) {
  // Never the same twice in a process, so that no workspace takes one state for another. No result
  // depends on it.
  static std::atomic<std::uint64_t> last{0};
  world.stamp = work.stamp = ++last;
}

}  // namespace pinchlab
