// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/broad_phase.h"

#include <algorithm>
#include <tuple>

#include "sim/cable.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

bool can_move(BodyKind kind) {
  return kind == BodyKind::free || kind == BodyKind::rail;
}

/// Sweeps along the axis in which the scene is longer; the order is nearly that of the last step.
void sort_bodies(BroadPhase& broad) {
  const std::size_t count = broad.low.size();
  if (broad.order.size() != count) {
    broad.order.resize(count);
    for (std::size_t b = 0; b < count; ++b) broad.order[b] = static_cast<int>(b);
    Vec2 low = broad.low[0], high = broad.high[0];
    for (std::size_t b = 1; b < count; ++b) {
      low = low.cwiseMin(broad.low[b]);
      high = high.cwiseMax(broad.high[b]);
    }
    broad.axis = high.x() - low.x() >= high.y() - low.y() ? 0 : 1;
    std::sort(broad.order.begin(), broad.order.end(), [&broad](int a, int b) {
      const double ka = broad.low[static_cast<std::size_t>(a)][broad.axis];
      const double kb = broad.low[static_cast<std::size_t>(b)][broad.axis];
      return ka != kb ? ka < kb : a < b;
    });
  }
  for (std::size_t i = 1; i < count; ++i) {
    const int body = broad.order[i];
    const double key = broad.low[static_cast<std::size_t>(body)][broad.axis];
    std::size_t j = i;
    for (; j > 0; --j) {
      const int other = broad.order[j - 1];
      const double other_key = broad.low[static_cast<std::size_t>(other)][broad.axis];
      if (other_key < key || (other_key == key && other < body)) break;
      broad.order[j] = other;
    }
    broad.order[j] = body;
  }
  broad.key.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    broad.key[i] = broad.low[static_cast<std::size_t>(broad.order[i])][broad.axis];
  }
}

}  // namespace

void update_boxes(const Scene& scene, World& world) {
  BroadPhase& broad = world.scratch.broad_phase;
  double widest = 0.0;
  for (const CableState& cable : world.cables) widest = std::max(widest, cable.half_width);
  const double fall = scene.gravity.norm() * world.step_length * world.step_length;
  broad.low.resize(scene.bodies.size());
  broad.high.resize(scene.bodies.size());
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const double radius = scene.bodies[b].radius;
    double reach = radius + widest;
    if (can_move(scene.bodies[b].kind)) {
      reach += 0.02 * radius + 2.0 * (world.velocity[b].norm() * world.step_length + fall);
    }
    broad.low[b] = world.position[b] - Vec2::Constant(reach);
    broad.high[b] = world.position[b] + Vec2::Constant(reach);
  }
}

SpanBox span_box(const Segment& segment) {
  return {segment.tail.cwiseMin(segment.head)
              .cwiseMin(segment.previous_tail)
              .cwiseMin(segment.previous_head),
          segment.tail.cwiseMax(segment.head)
              .cwiseMax(segment.previous_tail)
              .cwiseMax(segment.previous_head)};
}

void find_body_pairs(const Scene& scene, World& world) {
  BroadPhase& broad = world.scratch.broad_phase;
  broad.body_pairs.clear();
  if (scene.bodies.empty()) return;
  update_boxes(scene, world);
  sort_bodies(broad);
  const int axis = broad.axis, other_axis = 1 - axis;
  for (std::size_t i = 0; i < broad.order.size(); ++i) {
    const int a = broad.order[i];
    const Vec2 &low = broad.low[static_cast<std::size_t>(a)],
               &high = broad.high[static_cast<std::size_t>(a)];
    for (std::size_t j = i + 1; j < broad.order.size() && broad.key[j] <= high[axis]; ++j) {
      const int b = broad.order[j];
      if (broad.low[static_cast<std::size_t>(b)][other_axis] > high[other_axis] ||
          broad.high[static_cast<std::size_t>(b)][other_axis] < low[other_axis]) {
        continue;
      }
      const BodyKind ka = scene.bodies[static_cast<std::size_t>(a)].kind;
      const BodyKind kb = scene.bodies[static_cast<std::size_t>(b)].kind;
      if (ka == BodyKind::fixed && kb == BodyKind::fixed) continue;
      broad.body_pairs.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(
      broad.body_pairs.begin(), broad.body_pairs.end(),
      [](const BodyPair& p, const BodyPair& q) { return std::tie(p.a, p.b) < std::tie(q.a, q.b); });
}

void find_span_pairs(const Scene& scene, World& world) {
  BroadPhase& broad = world.scratch.broad_phase;
  broad.span_pairs.clear();
  if (scene.bodies.empty()) return;
  const int axis = broad.axis, other_axis = 1 - axis;
  double longest_box = 0.0;
  for (std::size_t b = 0; b < broad.low.size(); ++b) {
    longest_box = std::max(longest_box, broad.high[b][axis] - broad.low[b][axis]);
  }
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    const CableState& cable = world.cables[c];
    for (std::size_t s = first_segment(cable); s < cable.segments.size(); ++s) {
      const Segment& segment = cable.segments[s];
      if (segment.pinched) continue;
      const auto [low, high] = span_box(segment);
      auto it = std::lower_bound(broad.key.begin(), broad.key.end(), low[axis] - longest_box);
      for (; it != broad.key.end() && *it <= high[axis]; ++it) {
        const int body = broad.order[static_cast<std::size_t>(it - broad.key.begin())];
        const Vec2 &box_low = broad.low[static_cast<std::size_t>(body)],
                   &box_high = broad.high[static_cast<std::size_t>(body)];
        if (box_high[axis] < low[axis] || box_low[other_axis] > high[other_axis] ||
            box_high[other_axis] < low[other_axis]) {
          continue;
        }
        broad.span_pairs.push_back({static_cast<int>(c), static_cast<int>(s), body});
      }
    }
  }
  std::sort(broad.span_pairs.begin(), broad.span_pairs.end(),
            [](const SpanPair& p, const SpanPair& q) {
              return std::tie(p.cable, p.segment, p.body) < std::tie(q.cable, q.segment, q.body);
            });
}

}  // namespace pinchlab
