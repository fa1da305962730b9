// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture/span_rests.h"

#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/outline.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// The circle of a disc to the rim of which the cable is fastened at a link, or which holds that, a
/// node, at its rim, where a span leaves (`sense` 1) or arrives (-1) in direction e through the
/// disc; radius 0: nothing is in its way.
SpanEnd rim_below(const World& world, const CableState& cable, const Link& link, const Vec2& e,
                  double sense) {
  if (link.body < 0 || link.orientation != 0) return {};
  const BodyProperties& body = at(world.bodies, link.body);
  const Vec2& centre = at(world.position, link.body);
  const Vec2 out = link_centre(world, link) - centre;
  const double r = out.norm(), outermost = body.radius + 1.01 * cable.half_width;
  if (is_polygon(body) || r < body.radius || (r > outermost && !link.moored)) return {};
  if (sense * e.dot(out) >= 0.0) return {};
  const double way = std::copysign(1.0, cross(out, e));
  const Vec2 along = way * left(out);
  return {centre, way * r, 0.0, std::atan2(along.y(), along.x()), 0.0};
}

}  // namespace

std::vector<StripPoint> points_of(const Rest& rest, double material) {
  std::vector<StripPoint> points;
  if (rest.length() == 0.0) return points;
  const double turned = rest.to - rest.from;
  const int pieces = static_cast<int>(std::ceil(std::abs(turned) / most_turn));
  for (int k = 0; k <= pieces; ++k) {
    const double share = static_cast<double>(k) / pieces, angle = rest.from + share * turned;
    const Vec2 e(std::cos(angle), std::sin(angle));
    points.push_back({tangent_point(rest.rim.centre, rest.rim.signed_radius, e), e,
                      material + share * rest.length()});
  }
  return points;
}

RestingSpan rest_on_ends(const World& world, const CableState& cable,
                         const std::array<std::size_t, 2>& links, std::array<SpanEnd, 2> ends,
                         double length, const HangingSpan& hung, const Vec2& up) {
  const double most_depth = 0.1 * cable.half_width;
  RestingSpan span;
  auto& [tail, head] = ends;
  span.hung = hang_clear(hung, tail, head, length, up, most_depth);
  const Link &from = cable.links[links[0]], &to = cable.links[links[1]];
  if (from.body == to.body) return span;
  const Catenary& curve = span.hung.curve;
  span.at_tail.rim = rim_below(world, cable, from, curve.tangent(0.0), 1.0);
  span.at_head.rim = rim_below(world, cable, to, curve.tangent(curve.length()), -1.0);
  const bool tail_rests = span.at_tail.rim.signed_radius != 0.0;
  const bool head_rests = span.at_head.rim.signed_radius != 0.0;
  if (!tail_rests && !head_rests) return span;
  if (tail_rests) tail = span.at_tail.rim;
  if (head_rests) head = span.at_head.rim;
  span.hung = hang_clear(hang(tail, head, length, up), tail, head, length, up, most_depth);
  span.at_tail.from = span.at_tail.rim.alpha;
  span.at_tail.to = span.hung.tail_angle;
  span.at_head.from = span.hung.head_angle;
  span.at_head.to = span.at_head.rim.alpha;
  return span;
}

}  // namespace pinchlab
