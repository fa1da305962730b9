// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which bodies, and which spans and bodies, may touch: boxes swept along the scene's longer axis.

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "base/at.h"
#include "sim/box_tree.h"
#include "sim/world.h"

namespace pinchlab {

struct Workspace;

struct BodyPair {
  int a, b;  // a < b
};
struct WallPair {
  int body, wall;  // of World::obstacles
};
/// A piece of a hanging cable, and a body or wall that it may touch: pieces.h.
struct PiecePair {
  int a, b;  // its node and the body, a < b; or the node and -1
  int cable;
  int body, wall;  // one of them; the other is -1
};
/// What boxes of a piece are made of.
struct PieceEnds {
  int cable, node;              // as above
  std::array<int, 2> body;      // that holds an end, or -1
  std::array<Vec2, 2> point;    // m, there, in the world
  std::array<double, 2> reach;  // m, of the piece from the body's box, or from that point
};
struct SpanPair {
  int cable, segment, body;
};

/// A box with some room round what it holds (m).
struct Box {
  Vec2 low, high;
};

/// Where what is known of a cable's spans stands.
struct SpanList {
  int changes = -1;        // CableState::changes that it is for
  int first_box = 0;       // of BroadPhase::span_boxes
  int begin = 0, end = 0;  // of BroadPhase::span_pairs
};

/// The room that boxes leave (m).
struct Skin {
  double bodies = 0.0;  // round bodies and spans: a share of the bodies' mean radius
  double nodes = 0.0;   // round nodes of cables: as far as they go in some steps
};

struct BroadPhase {
  Skin skin;
  double widest = 0.0;          // m, half width of the widest cable, that the boxes allow for
  std::vector<Box> boxes;       // of bodies: where they were, are, and may be next, and the skin
  std::vector<Box> span_boxes;  // of spans, likewise, where SpanList has them
  std::vector<int> order;       // bodies by the low end of their box; nearly sorted
  std::vector<double> key;      // low end along the swept axis, in `order`
  double longest_box = 0.0;     // m, along the swept axis
  int axis = 0;                 // 0: x, 1: y
  std::size_t cables = 0;       // that the boxes allow for
  int changes = -1;             // of cables (CableState::changes) that span_pairs are for
  bool bodies_changed = false;  // since span_pairs were found
  std::vector<BodyPair> body_pairs;    // sorted
  std::vector<WallPair> wall_pairs;    // sorted
  std::vector<PiecePair> piece_pairs;  // sorted
  std::vector<PieceEnds> pieces;       // that are awake: while `boxes` are those of a world; by
                                       // list_pieces
  BoxTree walls;                       // obstacles, where there are pieces; likewise
  std::vector<int> near_pieces;        // bodies and, as -1 - wall, walls: of find_piece_pairs
  std::vector<int> no_nodes;           // bodies that pieces may meet, likewise
  std::vector<char> meets_pieces;      // of each body, likewise
  std::vector<SpanPair> span_pairs;    // sorted, unless patched; by find_span_pairs, as all of
  std::vector<SpanList> of_cable;      // these:
  std::vector<int> last_of_body;       // the last of span_pairs with each body, or -1
  std::vector<int> one_before;  // of each of span_pairs, that with the same body before it, or -1
  bool patched =
      false;  // within a divided step pairs of single cables were found anew: they are at
              // the end of span_pairs, and those that they had count no more
  std::vector<SpanPair> moving_pairs;  // sorted; by find_moving_pairs
};

inline bool overlap(const Box& a, const Box& b, int axis) {
  return a.low[axis] <= b.high[axis] && b.low[axis] <= a.high[axis];
}

/// Calls visit(body) for the bodies whose boxes overlap with `box`.
template <class Visit>
void visit_overlapping(const BroadPhase& broad, const Box& box, Visit visit) {
  const int axis = broad.axis;
  const double least = box.low[axis] - broad.longest_box;
  auto it = std::lower_bound(broad.key.begin(), broad.key.end(), least);
  for (; it != broad.key.end() && *it <= box.high[axis]; ++it) {
    const int body = broad.order[static_cast<std::size_t>(it - broad.key.begin())];
    const Box& other = at(broad.boxes, body);
    if (overlap(box, other, axis) && overlap(box, other, 1 - axis)) visit(body);
  }
}

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
/// step, with a skin more round those that can move.
void update_boxes(const Scene& scene, const World& world, const Skin& skin,
                  std::vector<Box>& boxes);

/// Lists the pieces of hanging cables that are awake.
void list_pieces(const World& world, BroadPhase& broad);

/// Lists what pieces of hanging cables may touch by the bodies' boxes, and takes away the pairs of
/// their nodes with discs, which they meet for them.
void find_piece_pairs(const World& world, BroadPhase& broad);

/// Box round a segment where it was a step ago, and is.
Box span_box(const Segment& segment);

/// The pairs of bodies, and of bodies and walls, that may touch within the next step: at least
/// those, and they are kept until a body leaves its box (neighbour lists with a skin; Verlet 1967).
void find_body_pairs(const Scene& scene, const World& world, Workspace& work);

/// The bodies that may meet free spans within the last step (zero-length ones cannot hit anything),
/// likewise kept.
void find_span_pairs(const World& world, Workspace& work);

/// Of a divided step, the pairs of which the span or the body moves: BroadPhase::moving_pairs.
/// Costs what moves, where no body leaves its box; all pairs must have been found for the round.
void find_moving_pairs(const Scene& scene, const World& world, Workspace& work);

}  // namespace pinchlab
