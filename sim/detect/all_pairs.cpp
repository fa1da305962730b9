// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/detect/all_pairs.h"

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

bool overlap(const Box& a, const Box& b) {
  return b.low.x() <= a.high.x() && a.low.x() <= b.high.x() && b.low.y() <= a.high.y() &&
         a.low.y() <= b.high.y();
}

}  // namespace

void find_all_body_pairs(const Scene& scene, const World& world, Workspace& work) {
  BroadPhase& broad = work.broad_phase;
  broad.body_pairs.clear();
  broad.wall_pairs.clear();
  update_boxes(scene, world, {}, broad.boxes);
  const int count = static_cast<int>(world.bodies.size());
  const int walls = static_cast<int>(world.obstacles.size());
  for (int a = 0; a < count; ++a) {
    const auto i = index(a);
    const Box box = broad.boxes[i];
    if (!world.bodies[i].outlined) continue;
    for (int w = 0; w < walls; ++w) {
      if (bars(at(world.obstacles, w), world.bodies[i])) broad.wall_pairs.push_back({a, w});
    }
    for (int b = a + 1; b < count; ++b) {
      const auto j = index(b);
      if (!overlap(box, broad.boxes[j])) continue;
      if (never_touch(world.bodies[i], world.bodies[j])) continue;
      broad.body_pairs.push_back({a, b});
    }
  }
  leave_out_apart(scene, broad.body_pairs);
  list_pieces(world, broad);
  find_piece_pairs(world, broad);
}

void find_all_span_pairs(const World& world, Workspace& work) {
  BroadPhase& broad = work.broad_phase;
  broad.span_pairs.clear();
  const int count = static_cast<int>(world.bodies.size());
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    const CableState& cable = world.cables[c];
    for (std::size_t s = first_segment(cable); s < cable.segments.size(); ++s) {
      if (is_passed(cable)) continue;
      const Box box = span_box(cable.segments[s]);
      for (int b = 0; b < count; ++b) {
        const auto i = index(b);
        if (!overlap(box, broad.boxes[i]) || !meets_spans(world.bodies[i])) continue;
        broad.span_pairs.push_back({static_cast<int>(c), static_cast<int>(s), b});
      }
    }
  }
}

}  // namespace pinchlab
