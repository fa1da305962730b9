// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which bodies, and which spans and bodies, may touch: boxes swept along the scene's longer axis.

#include <vector>

#include "sim/world.h"

namespace pinchlab {

struct Workspace;

struct BodyPair {
  int a, b;  // a < b
};
struct WallPair {
  int body, wall;  // of World::obstacles
};
struct SpanPair {
  int cable, segment, body;
};

/// A box with some room round what it holds (m).
struct Box {
  Vec2 low, high;
};

struct BroadPhase {
  double skin = 0.0;            // m, the room: a share of the bodies' mean radius
  std::vector<Box> boxes;       // of bodies: where they were, are, and may be next, and the skin
  std::vector<Box> span_boxes;  // of spans, cable after cable, likewise
  std::vector<int> order;       // bodies by the low end of their box; nearly sorted
  std::vector<double> key;      // low end along the swept axis, in `order`
  double longest_box = 0.0;     // m, along the swept axis
  int axis = 0;                 // 0: x, 1: y
  std::size_t cables = 0;       // that the boxes allow for
  int changes = -1;             // of cables (CableState::changes) that span_pairs are for
  bool bodies_changed = false;  // since span_pairs were found
  std::vector<BodyPair> body_pairs;  // sorted
  std::vector<WallPair> wall_pairs;  // sorted
  std::vector<SpanPair> span_pairs;  // sorted
};

/// Whether two bodies are never in each other's way: fixed, nodes of cables, or without an outline.
inline bool never_touch(const BodyProperties& a, const BodyProperties& b) {
  return (a.kind == BodyKind::fixed && b.kind == BodyKind::fixed) || (a.node && b.node) ||
         !a.outlined || !b.outlined;
}

/// Whether the body can come upon the obstacle: nodes do not, upon the ends of cables.
inline bool bars(const Obstacle& obstacle, const BodyProperties& body) {
  return body.outlined && !(body.node && obstacle.cable >= 0);
}

/// Whether spans run into the body: it is no node of a cable, and has an outline.
inline bool meets_spans(const BodyProperties& body) {
  return !body.node && body.outlined;
}

/// Takes the pairs away that Scene::apart names.
void leave_out_apart(const Scene& scene, std::vector<BodyPair>& pairs);

/// Boxes of the bodies and their cables where they were a step ago, are, and may be after the next
/// step, with `skin` (m) more round those that can move.
void update_boxes(const Scene& scene, const World& world, double skin, std::vector<Box>& boxes);

/// Box round a segment where it was a step ago, and is.
Box span_box(const Segment& segment);

/// The pairs of bodies, and of bodies and walls, that may touch within the next step: at least
/// those, and they are kept until a body leaves its box (neighbour lists with a skin; Verlet 1967).
void find_body_pairs(const Scene& scene, const World& world, Workspace& work);

/// The bodies that may meet free spans within the last step (zero-length ones cannot hit anything),
/// likewise kept.
void find_span_pairs(const World& world, Workspace& work);

}  // namespace pinchlab
