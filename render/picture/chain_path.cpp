// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture/chain_path.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/held.h"
#include "sim/outline.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// The node (a body) number i, from 1 on, of those that a piece holds, of a chain whose number of
/// nodes adapts.
int held_node(const Scene& scene, std::size_t piece, int i) {
  const int c = static_cast<int>(piece);
  for (const NodeChain& chain : scene.chains) {
    const int number = c == chain.cable ? 0 : c - chain.first_piece + 1;
    const bool is_of_chain = c == chain.cable || (number >= 1 && number < chain.pieces);
    if (is_of_chain) return node_before(chain, number + i);
  }
  return -1;
}

/// A fan of points after the last, where a strip bends to `to` by more than two of them can.
void append_bend(const Vec2& to, std::vector<StripPoint>& points) {
  const StripPoint from = points.back();
  const double bend = std::atan2(cross(from.tangent, to), from.tangent.dot(to));
  const int pieces = static_cast<int>(std::ceil(std::abs(bend) / most_turn));
  for (int k = 1; k < pieces; ++k) {
    points.push_back({from.position, turned(from.tangent, bend * k / pieces), from.material});
  }
}

/// The piece that goes on from the node that holds `end`. Pieces follow one another, the first
/// one's successor after all cables that the scene had.
std::size_t next_piece(const World& world, std::size_t piece, const Link& end) {
  const auto starts_there = [&end](const CableState& next) {
    return next.rod && next.links.front().body == end.body;
  };
  if (piece + 1 < world.cables.size() && starts_there(world.cables[piece + 1])) return piece + 1;
  const auto it = std::find_if(world.cables.begin(), world.cables.end(), starts_there);
  return static_cast<std::size_t>(it - world.cables.begin());
}

}  // namespace

bool is_on_node(const Scene& scene, const Link& link) {
  return link.body >= 0 && at(scene.bodies, link.body).node;
}

void append_chain_path(const Scene& scene, const World& world, std::size_t first_piece,
                       std::vector<StripPoint>& points) {
  const std::size_t first = points.size();
  double material = 0.0;
  for (std::size_t piece = first_piece; piece < world.cables.size();) {
    const CableState& cable = world.cables[piece];
    const Segment& segment = cable.segments[1];
    Vec2 from = segment.tail;
    const auto go_to = [&](const Vec2& to, const Vec2& direction, double length) {
      if (points.size() != first) append_bend(direction, points);
      points.push_back({from, direction, material});
      material += length;
      points.push_back({to, direction, material});
      from = to;
    };
    for (int i = 1; i < cable.pieces; ++i) {  // with the bend that it holds
      const Vec2& node = at(world.position, held_node(scene, piece, i));
      go_to(node, (node - from).normalized(), (node - from).norm());
    }
    if (cable.pieces == 1) {
      go_to(segment.head, segment.direction, segment.length);
    } else {
      const Vec2 way = segment.head - from;
      go_to(segment.head, way.normalized(), way.norm());
    }
    const Link& end = cable.links.back();
    if (!is_on_node(scene, end)) break;
    piece = next_piece(world, piece, end);
  }
}

}  // namespace pinchlab
