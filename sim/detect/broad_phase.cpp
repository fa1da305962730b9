// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/detect/broad_phase.h"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/lines.h"
#include "sim/outline.h"
#include "sim/pieces.h"
#include "sim/seams.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// The skin as a share of the mean radius: pairs then last for some frames of ordinary motion, and
/// are few more than needed.
constexpr double skin_share = 0.2;

/// The skin of nodes in steps of their mean speed. Their radii say nothing: nodes are as thin as
/// their cable, and swing.
constexpr double steps_of_nodes = 8.0;

/// What all bodies of a scene reach beyond their radii.
struct Margin {
  double widest = 0.0;  // m, half width of the widest cable
  double fall = 0.0;    // m, by gravity in one step

  Margin(const Scene& scene, const World& world)
      : fall(scene.gravity.norm() * world.step_length * world.step_length) {}

  void include(const CableState& cable) { widest = std::max(widest, 0.5 * thickness(cable)); }
};

Margin margin_of_all(const Scene& scene, const World& world) {
  Margin margin(scene, world);
  for (const CableState& cable : world.cables) margin.include(cable);
  return margin;
}

/// The same in a divided step, in which only these parts have moved since the last time.
Margin margin_of_movers(const Scene& scene, const World& world, const Workspace& work) {
  Margin margin(scene, world);
  margin.widest = work.broad_phase.widest;
  for (const int p : work.neighbourhoods.moving) {
    for (const int c : cables_of(work.parts, at(work.parts.list, p))) {
      margin.include(at(world.cables, c));
    }
  }
  return margin;
}

/// How far from its centre a body and the cables round it may reach from the last step to the next.
double reach_of_body(const World& world, const Margin& margin, std::size_t b) {
  const double radius = world.bodies[b].radius;
  if (!can_move(world.bodies[b])) return radius + margin.widest;
  const double speed = world.velocity[b].cwiseAbs().sum();
  return 1.02 * radius + margin.widest + 2.0 * (speed * world.step_length + margin.fall);
}

bool comes_before(const SpanPair& p, const SpanPair& q) {
  return std::tie(p.cable, p.segment, p.body) < std::tie(q.cable, q.segment, q.body);
}

bool holds(const Box& box, const Vec2& low, const Vec2& high) {
  return low.x() >= box.low.x() && high.x() <= box.high.x() && low.y() >= box.low.y() &&
         high.y() <= box.high.y();
}

Skin skin_for(const World& world) {
  double radii = 0.0, speeds = 0.0;
  int nodes = 0;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    radii += world.bodies[b].radius;
    if (!world.bodies[b].node) continue;
    speeds += world.velocity[b].norm();
    ++nodes;
  }
  Skin skin;
  skin.bodies = skin.nodes = skin_share * radii / static_cast<double>(world.bodies.size());
  if (nodes > 0) {
    skin.nodes = std::max(skin.nodes, steps_of_nodes * world.step_length * speeds / nodes);
  }
  return skin;
}

/// Sweeps along the axis in which the scene is longer; the order is nearly that of the last time.
void sort_bodies(BroadPhase& broad) {
  const std::size_t count = broad.boxes.size();
  if (broad.order.size() != count) {
    broad.order.resize(count);
    Box all = broad.boxes[0];
    for (const Box& box : broad.boxes) {
      all.low = all.low.cwiseMin(box.low);
      all.high = all.high.cwiseMax(box.high);
    }
    const Vec2 size = all.high - all.low;
    broad.axis = size.x() >= size.y() ? 0 : 1;
    std::vector<std::pair<double, int>> keyed(count);
    for (std::size_t b = 0; b < count; ++b) {
      keyed[b] = {broad.boxes[b].low[broad.axis], static_cast<int>(b)};
    }
    std::sort(keyed.begin(), keyed.end());
    for (std::size_t i = 0; i < count; ++i) broad.order[i] = keyed[i].second;
  }
  for (std::size_t i = 1; i < count; ++i) {
    const int body = broad.order[i];
    const double key = broad.boxes[index(body)].low[broad.axis];
    std::size_t j = i;
    for (; j > 0; --j) {
      const int other = broad.order[j - 1];
      const double other_key = broad.boxes[index(other)].low[broad.axis];
      if (other_key < key || (other_key == key && other < body)) break;
      broad.order[j] = other;
    }
    broad.order[j] = body;
  }
  broad.key.resize(count);
  broad.longest_box = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const Box& box = broad.boxes[index(broad.order[i])];
    broad.key[i] = box.low[broad.axis];
    broad.longest_box = std::max(broad.longest_box, box.high[broad.axis] - box.low[broad.axis]);
  }
}

void list_body_pairs(const Scene& scene, const World& world, BroadPhase& broad) {
  broad.body_pairs.clear();
  const int axis = broad.axis;
  for (std::size_t i = 0; i < broad.order.size(); ++i) {
    const int a = broad.order[i];
    const Box& box = broad.boxes[index(a)];
    for (std::size_t j = i + 1; j < broad.order.size() && broad.key[j] <= box.high[axis]; ++j) {
      const int b = broad.order[j];
      if (!overlap(box, broad.boxes[index(b)], 1 - axis)) continue;
      if (never_touch(at(world.bodies, a), at(world.bodies, b))) continue;
      broad.body_pairs.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  leave_out_apart(scene, broad.body_pairs);
  std::sort(
      broad.body_pairs.begin(), broad.body_pairs.end(),
      [](const BodyPair& p, const BodyPair& q) { return std::tie(p.a, p.b) < std::tie(q.a, q.b); });
}

void list_wall_pairs(const World& world, BroadPhase& broad) {
  broad.wall_pairs.clear();
  for (std::size_t w = 0; w < world.obstacles.size(); ++w) {
    const Obstacle& wall = world.obstacles[w];
    const Vec2 thick = Vec2::Constant(wall.radius);
    const Box box_of_wall{wall.a.cwiseMin(wall.b) - thick, wall.a.cwiseMax(wall.b) + thick};
    visit_overlapping(broad, box_of_wall, [&](int body) {
      const Box& box = at(broad.boxes, body);  // the circle round it is nearer to slanting walls
      const Vec2 centre = 0.5 * (box.low + box.high);
      const double reach = wall.radius + 0.5 * (box.high - box.low).norm();
      if (distance_from_line(wall.a, wall.b, centre) > reach) return;
      if (!bars(wall, at(world.bodies, body))) return;
      broad.wall_pairs.push_back({body, static_cast<int>(w)});
    });
  }
  std::sort(broad.wall_pairs.begin(), broad.wall_pairs.end(),
            [](const WallPair& p, const WallPair& q) {
              return std::tie(p.body, p.wall) < std::tie(q.body, q.wall);
            });
}

/// Appends what a cable's spans may meet.
void list_spans_of(const World& world, std::size_t c, BroadPhase& broad) {
  const CableState& cable = world.cables[c];
  SpanList& list = broad.of_cable[c];
  list.changes = cable.changes;
  list.first_box = static_cast<int>(broad.span_boxes.size());
  list.begin = list.end = static_cast<int>(broad.span_pairs.size());
  if (is_passed(cable)) return;
  for (std::size_t s = first_segment(cable); s < cable.segments.size(); ++s) {
    const Segment& segment = cable.segments[s];
    Box box = span_box(segment);
    box.low -= Vec2::Constant(broad.skin.bodies);
    box.high += Vec2::Constant(broad.skin.bodies);
    broad.span_boxes.push_back(box);
    const Link& to = cable.links[s];
    const Link& from = cable.links[index(previous_link(cable, static_cast<int>(s)))];
    if (is_side(from, to)) continue;
    const auto first = static_cast<std::ptrdiff_t>(broad.span_pairs.size());
    visit_overlapping(broad, box, [&](int body) {
      if (!meets_spans(at(world.bodies, body))) return;
      if (holds_span(world, cable, from, body) || holds_span(world, cable, to, body)) return;
      broad.span_pairs.push_back({static_cast<int>(c), static_cast<int>(s), body});
    });
    std::sort(broad.span_pairs.begin() + first, broad.span_pairs.end(), comes_before);
  }
  list.end = static_cast<int>(broad.span_pairs.size());
  for (int i = list.begin; i < list.end; ++i) {
    int& last = at(broad.last_of_body, at(broad.span_pairs, i).body);
    broad.one_before.push_back(last);
    last = i;
  }
}

void list_span_pairs(const World& world, BroadPhase& broad) {
  broad.span_pairs.clear();
  broad.span_boxes.clear();
  broad.one_before.clear();
  broad.last_of_body.assign(world.bodies.size(), -1);
  broad.of_cable.resize(world.cables.size());
  for (std::size_t c = 0; c < world.cables.size(); ++c) list_spans_of(world, c, broad);
  broad.bodies_changed = broad.patched = false;
  broad.changes = world.changes;
}

/// Whether all spans of a cable that may run over bodies are where their boxes allow for. Where a
/// span was a step ago was checked then.
bool spans_in_boxes(const World& world, const BroadPhase& broad, std::size_t c) {
  const CableState& cable = world.cables[c];
  auto box = index(broad.of_cable[c].first_box);
  for (std::size_t s = first_segment(cable); s < cable.segments.size(); ++s, ++box) {
    const Segment& segment = cable.segments[s];
    if (!segment.moved) continue;
    const Vec2 low = segment.tail.cwiseMin(segment.head);
    const Vec2 high = segment.tail.cwiseMax(segment.head);
    if (!holds(broad.span_boxes[box], low, high)) return false;
  }
  return true;
}

bool all_spans_in_boxes(const World& world, const Parts& parts, const BroadPhase& broad) {
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    if (is_passed(world.cables[c]) || is_idle(parts, c)) continue;
    if (!spans_in_boxes(world, broad, c)) return false;
  }
  return true;
}

/// Whether these bodies are where their boxes allow for.
bool all_in_boxes(const World& world, const Parts& parts, const BroadPhase& broad,
                  const Margin& margin, std::span<const int> bodies) {
  for (const int b : bodies) {
    if (is_still(parts, b)) continue;
    const Vec2 reach = Vec2::Constant(reach_of_body(world, margin, index(b)));
    const Vec2& x = at(world.position, b);
    if (!holds(at(broad.boxes, b), x - reach, x + reach)) return false;
  }
  return true;
}

/// The same of all bodies, or in a divided step of those that may have moved.
bool boxes_hold(const Scene& scene, const World& world, Workspace& work) {
  const Parts& parts = work.parts;
  BroadPhase& broad = work.broad_phase;
  const bool divided = work.neighbourhoods.divided;
  const Margin margin =
      divided ? margin_of_movers(scene, world, work) : margin_of_all(scene, world);
  broad.widest = margin.widest;
  if (broad.boxes.size() != world.bodies.size() || broad.cables != world.cables.size())
    return false;
  if (parts.immobile.empty()) return world.bodies.empty();  // not divided yet
  if (!divided) return all_in_boxes(world, parts, broad, margin, parts.movers);
  for (const int p : work.neighbourhoods.moving) {
    const Part& part = at(parts.list, p);
    if (!all_in_boxes(world, parts, broad, margin, bodies_of(parts, part)) ||
        !all_in_boxes(world, parts, broad, margin, carried_of(parts, part))) {
      return false;
    }
  }
  return true;
}

}  // namespace

void leave_out_apart(const Scene& scene, std::vector<BodyPair>& pairs) {
  if (scene.apart.empty()) return;
  std::erase_if(pairs, [&scene](const BodyPair& p) {
    return std::binary_search(scene.apart.begin(), scene.apart.end(), std::array{p.a, p.b});
  });
}

void update_boxes(const Scene& scene, const World& world, const Skin& skin,
                  std::vector<Box>& boxes) {
  boxes.resize(world.bodies.size());
  const Margin margin = margin_of_all(scene, world);
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    const BodyProperties& body = world.bodies[b];
    const double room = !can_move(body) ? 0.0 : body.node ? skin.nodes : skin.bodies;
    const Vec2 reach = Vec2::Constant(reach_of_body(world, margin, b) + room);
    boxes[b] = {world.position[b] - reach, world.position[b] + reach};
  }
}

namespace {

void include(const Box& other, Box& box) {
  box.low = box.low.cwiseMin(other.low);
  box.high = box.high.cwiseMax(other.high);
}

/// Where a piece may be within the next step: between its ends, which bodies' boxes hold.
Box piece_box(const BroadPhase& broad, const PieceEnds& piece) {
  Box box{Vec2::Constant(infinity), Vec2::Constant(-infinity)};
  for (const std::size_t end : {0U, 1U}) {
    const Vec2 reach = Vec2::Constant(piece.reach[end]);
    const int body = piece.body[end];
    const Box& own = body >= 0 ? at(broad.boxes, body) : Box{piece.point[end], piece.point[end]};
    include({own.low - reach, own.high + reach}, box);
  }
  return box;
}

/// Lists what pieces meet that may be in a box.
void list_near_pieces(const World& world, const Box& box, BroadPhase& broad) {
  broad.near_pieces.clear();
  const auto add = [&broad](int b) {
    if (at(broad.meets_pieces, b)) broad.near_pieces.push_back(b);
  };
  constexpr std::size_t few = 64;  // which are sooner looked at than found among the nodes
  if (broad.no_nodes.size() > few && world.configuration.detection == Detection::sweep) {
    visit_overlapping(broad, box, add);
  } else {
    for (const int b : broad.no_nodes) {
      const Box& other = at(broad.boxes, b);
      if (overlap(box, other, 0) && overlap(box, other, 1)) broad.near_pieces.push_back(b);
    }
  }
  broad.walls.any(box.low, box.high, [&](int w) {
    const Obstacle& wall = at(world.obstacles, w);
    const auto is_near = [&](std::size_t end, const Vec2& tip) {
      return wall.tips[end] == Tipped::own && overlap(box, {tip, tip}, 0) &&
             overlap(box, {tip, tip}, 1);
    };
    if (is_near(0, wall.a) || is_near(1, wall.b)) broad.near_pieces.push_back(-1 - w);
    return false;
  });
}

/// Appends what is near and in a piece's way.
void append_piece_pairs(const World& world, const PieceEnds& piece, const Box& box,
                        BroadPhase& broad) {
  for (const int near : broad.near_pieces) {
    const int body = std::max(near, -1), wall = near < 0 ? -1 - near : -1;
    if (body >= 0) {
      const Box& other = at(broad.boxes, body);
      if (!overlap(box, other, 0) || !overlap(box, other, 1)) continue;
    }
    if (!meets_piece(world, piece.cable, body, wall)) continue;
    const int a = body >= 0 ? std::min(piece.node, body) : piece.node;
    const int b = body >= 0 ? std::max(piece.node, body) : -1;
    broad.piece_pairs.push_back({a, b, piece.cable, body, wall});
  }
}

}  // namespace

void list_pieces(const World& world, BroadPhase& broad) {
  broad.pieces.clear();
  broad.meets_pieces.clear();
  broad.no_nodes.clear();
  if (world.pieces_at.empty()) return;
  find_extents(world.obstacles, broad.walls);
  for (int b = 0; index(b) < world.bodies.size(); ++b) {
    broad.meets_pieces.push_back(meets_spans(at(world.bodies, b)));
    if (broad.meets_pieces.back()) broad.no_nodes.push_back(b);
  }
  for (int c = 0; index(c) < world.cables.size(); ++c) {
    const CableState& cable = at(world.cables, c);
    if (!cable.piece || is_dormant(cable)) continue;
    PieceEnds piece{c, node_of_piece(world, c), {-1, -1}, {}, {}};
    if (piece.node < 0) continue;
    for (const std::size_t end : {0U, 1U}) {
      const Link& link = cable.links[end];
      piece.body[end] = link.body;
      piece.point[end] = link.offset;
      piece.reach[end] = cable.half_width + (link.body >= 0 ? link.offset.norm() : 0.0);
    }
    broad.pieces.push_back(piece);
  }
}

void find_piece_pairs(const World& world, BroadPhase& broad) {
  constexpr std::size_t at_once = 16;  // pieces that are mostly near nothing
  broad.piece_pairs.clear();
  std::array<Box, at_once> boxes;
  for (std::size_t begin = 0; begin < broad.pieces.size(); begin += at_once) {
    const std::size_t end = std::min(begin + at_once, broad.pieces.size());
    Box all{Vec2::Constant(infinity), Vec2::Constant(-infinity)};
    for (std::size_t i = begin; i < end; ++i) {
      boxes[i - begin] = piece_box(broad, broad.pieces[i]);
      include(boxes[i - begin], all);
    }
    list_near_pieces(world, all, broad);
    for (std::size_t i = begin; i < end; ++i) {
      append_piece_pairs(world, broad.pieces[i], boxes[i - begin], broad);
    }
  }
  if (broad.pieces.empty()) return;
  std::sort(broad.piece_pairs.begin(), broad.piece_pairs.end(),
            [](const PiecePair& p, const PiecePair& q) {
              return std::tie(p.a, p.b, p.wall, p.cable) < std::tie(q.a, q.b, q.wall, q.cable);
            });
  std::erase_if(broad.body_pairs, [&](const BodyPair& pair) {
    const bool first = at(broad.meets_pieces, pair.a), second = at(broad.meets_pieces, pair.b);
    if (first && second) return false;
    const int node = first ? pair.b : pair.a, body = first ? pair.a : pair.b;
    return !is_polygon(at(world.bodies, body)) && is_met_by_pieces(world, node, body, -1);
  });
}

Box span_box(const Segment& segment) {
  return {segment.tail.cwiseMin(segment.head)
              .cwiseMin(segment.previous_tail)
              .cwiseMin(segment.previous_head),
          segment.tail.cwiseMax(segment.head)
              .cwiseMax(segment.previous_tail)
              .cwiseMax(segment.previous_head)};
}

void find_body_pairs(const Scene& scene, const World& world, Workspace& work) {
  BroadPhase& broad = work.broad_phase;
  const std::size_t count = world.bodies.size();
  if (boxes_hold(scene, world, work)) return;
  if (broad.boxes.size() != count) list_pieces(world, broad);
  broad.cables = world.cables.size();
  broad.bodies_changed = true;
  broad.body_pairs.clear();
  broad.wall_pairs.clear();
  if (count == 0) return;
  broad.skin = skin_for(world);
  update_boxes(scene, world, broad.skin, broad.boxes);
  sort_bodies(broad);
  list_body_pairs(scene, world, broad);
  list_wall_pairs(world, broad);
  find_piece_pairs(world, broad);
}

void find_span_pairs(const World& world, Workspace& work) {
  BroadPhase& broad = work.broad_phase;
  if (!broad.bodies_changed && !broad.patched && broad.changes == world.changes &&
      (!work.spans_moved || all_spans_in_boxes(world, work.parts, broad))) {
    return;
  }
  list_span_pairs(world, broad);
}

void find_moving_pairs(const Scene& scene, const World& world, Workspace& work) {
  BroadPhase& broad = work.broad_phase;
  const Parts& parts = work.parts;
  find_body_pairs(scene, world, work);
  if (broad.bodies_changed) list_span_pairs(world, broad);
  broad.moving_pairs.clear();
  for (const int p : work.neighbourhoods.moving) {
    const Part& part = at(parts.list, p);
    for (const int c : cables_of(parts, part)) {
      const SpanList& list = at(broad.of_cable, c);
      const CableState& cable = at(world.cables, c);
      if (list.changes != cable.changes ||
          (!is_passed(cable) && !spans_in_boxes(world, broad, index(c)))) {
        list_spans_of(world, index(c), broad);
        broad.patched = true;
      }
      const auto pairs = broad.span_pairs.begin();
      broad.moving_pairs.insert(broad.moving_pairs.end(), pairs + list.begin, pairs + list.end);
    }
  }
  broad.changes = world.changes;
  const auto add_others = [&](int body) {
    for (int i = at(broad.last_of_body, body); i >= 0; i = at(broad.one_before, i)) {
      const SpanPair& pair = at(broad.span_pairs, i);
      const SpanList& list = at(broad.of_cable, pair.cable);
      const bool counts = list.begin <= i && i < list.end;
      if (counts && is_idle(parts, index(pair.cable))) broad.moving_pairs.push_back(pair);
    }
  };
  for (const int p : work.neighbourhoods.moving) {
    const Part& part = at(parts.list, p);
    for (const int body : bodies_of(parts, part)) add_others(body);
    for (const int shape : carried_of(parts, part)) add_others(shape);
  }
  std::sort(broad.moving_pairs.begin(), broad.moving_pairs.end(), comes_before);
}

}  // namespace pinchlab
