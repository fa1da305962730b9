// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which bodies, and which spans and bodies, may touch: boxes swept along the scene's longer axis.

#include <vector>

#include "sim/scene.h"

namespace pinchlab {

struct Segment;
struct World;

struct BodyPair {
  int a, b;  // a < b
};
struct SpanPair {
  int cable, segment, body;
};

struct BroadPhase {
  std::vector<int> order;            // bodies by the low end of their box; nearly sorted every step
  std::vector<Vec2> low, high;       // m, boxes of bodies: where they were, are, and may be next
  std::vector<double> key;           // low end along the swept axis, in `order`
  int axis = 0;                      // 0: x, 1: y
  std::vector<BodyPair> body_pairs;  // sorted
  std::vector<SpanPair> span_pairs;  // sorted
};

/// Boxes round each body and its cables where it was a step ago, is, and may be after the next
/// step.
void update_boxes(const Scene& scene, World& world);

/// Box round a segment where it was a step ago, and is.
struct SpanBox {
  Vec2 low, high;  // m
};
SpanBox span_box(const Segment& segment);

/// Boxes of the bodies at their present positions, and the pairs of bodies whose boxes overlap.
void find_body_pairs(const Scene& scene, World& world);

/// The bodies whose boxes meet the boxes of free spans (zero-length ones cannot hit anything).
void find_span_pairs(const Scene& scene, World& world);

}  // namespace pinchlab
