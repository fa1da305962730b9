// SPDX-License-Identifier: GPL-3.0-or-later
// How a cable with mass hangs between the bodies that it runs over, at the start.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/links.h"
#include "sim/cable/mass.h"
#include "sim/cable/strung.h"
#include "sim/cable/taking_in.h"
#include "sim/compound.h"
#include "sim/hanging.h"
#include "sim/tangent.h"
#include "sim/touch.h"

namespace pinchlab {

namespace {

/// What is free of a cable between two links that are no nodes: its segments.
std::vector<std::size_t> spans_from(const CableState& cable, int link) {
  std::vector<std::size_t> spans;
  for (int next = next_link(cable, link); next >= 0; next = next_link(cable, next)) {
    spans.push_back(index(next));
    if (!is_strung(cable, at(cable.links, next))) break;
  }
  return spans;
}

HangingEnd end_of(const World& world, const CableState& cable, int link, std::size_t segment) {
  const Link& held = at(cable.links, link);
  return {link_centre(world, held), held.signed_radius(), cable.segments[segment].direction};
}

/// m/rad, by which the radius of a drum that fills grows as the span beside it turns.
double slope_at(const Link& link) {
  return link.layers.way != 0 ? link.layers.growth : 0.0;
}

/// Hangs pieces of these lengths (m) between two ends, on links with these slopes. What the nodes
/// beside these weigh follows from how much of the pieces lies on rims then, and so does what the
/// pieces' other halves weigh on them, which drums that fill raise as the pieces turn (mass.h):
/// found by turns.
Hanging hang(const CableState& cable, const std::vector<double>& lengths, const HangingEnd& tail,
             const HangingEnd& head, const std::array<double, 2>& slopes, const Vec2& gravity) {
  std::vector<double> now = lengths;
  Vec2 on_first = Vec2::Zero(), on_last = Vec2::Zero();  // N
  for (double last_change = infinity;;) {
    std::vector<Vec2> weights;
    for (std::size_t k = 0; k + 1 < now.size(); ++k) {
      weights.push_back(0.5 * cable.density * (now[k] + now[k + 1]) * gravity);
    }
    weights.front() += on_first;
    weights.back() += on_last;
    Hanging hanging = hang(weights, lengths, tail, head);
    const auto raised = [&](double length, const Vec2& direction, double slope) -> Vec2 {
      if (!(length > slope)) return Vec2::Zero();
      const Vec2 n = left(direction);
      return slope / (length - slope) * 0.5 * cable.density * length * gravity.dot(n) * n;
    };
    const Vec2 first = -raised(now.front(), hanging.directions.front(), slopes[0]);
    const Vec2 last = -raised(now.back(), hanging.directions.back(), slopes[1]);
    const double of_weights = (first - on_first).norm() + (last - on_last).norm();  // N
    const double change = std::max({std::abs(hanging.lengths.front() - now.front()),
                                    std::abs(hanging.lengths.back() - now.back()),
                                    of_weights / (cable.density * gravity.norm())});
    if (!(change < 0.5 * last_change)) return hanging;  // by round-off alone, or no better
    last_change = change;
    on_first = first;
    on_last = last;
    now.front() = std::max(hanging.lengths.front(), 0.0);
    now.back() = std::max(hanging.lengths.back(), 0.0);
  }
}

/// The next corner, along the cable or against it, of the polygon that a link lies on.
int next_corner(const World& world, const Link& link, bool along) {
  const int corners = static_cast<int>(at(world.bodies, link.body).corners.size());
  return (link.corner + (along ? link.orientation : -link.orientation) + corners) % corners;
}

/// A corner of a polygon that the cable has been laid on.
struct LaidCorner {
  int body, corner;
  bool operator==(const LaidCorner&) const = default;
};

/// Where a piece of that length (m) and direction begins at a rolling link, with `leaves`, or else
/// ends there: takes its node in that is to lie on the rim, or the link off that it lifts the cable
/// from, or lays it on a polygon's next corner that it would cut, which is noted in `laid`. From
/// there nothing lifts it again: a straight piece may cut a corner which the same piece, bent about
/// it, is off. Whether it has.
bool give_way(World& world, CableState& cable, int link, bool leaves, double length,
              const Vec2& direction, std::vector<LaidCorner>& laid) {
  const Link& rim = at(cable.links, link);
  if (rim.orientation == 0) return false;
  const int segment = leaves ? next_link(cable, link) : link;
  const int node = leaves ? segment : previous_link(cable, link);
  const Vec2& before = at(cable.segments, segment).direction;
  const double turned = std::atan2(cross(before, direction), before.dot(direction));
  const bool stays = std::ranges::find(laid, LaidCorner{rim.body, rim.corner}) != laid.end();
  if (rim.wrap + (leaves ? 1 : -1) * rim.orientation * turned < 0.0 && !stays &&
      !needed(cable, index(link))) {
    remove_link(world, cable, link);
    return true;
  }
  double room = mooring_distance(cable);
  if (rim.corner >= 0) {
    const int corner = next_corner(world, rim, leaves);
    const Vec2 side = place_of_point(world, rim.body, corner) - link_centre(world, rim);
    if (rim.orientation * cross(side, direction) > 0.0) {  // either way round
      if (length > side.norm() + room) {
        laid.push_back({rim.body, corner});
        insert_link(world, cable, index(segment), rim.body, corner, rim.orientation);
        return true;
      }
      room = infinity;
    }
  }
  if (length > room) return false;
  take_in_node(world, cable, node);
  return true;
}

/// Hangs what is free after a link, up to the next that is no node, with the motion that its ends
/// give it; or does first what it asks of these ends. Whether it is to hang again, since it has
/// done that, or a drum's layers have grown or shrunk.
bool hang_free(World& world, CableState& cable, int link, const Vec2& gravity,
               std::vector<LaidCorner>& laid) {
  const std::vector<std::size_t> spans = spans_from(cable, link);
  if (spans.size() < 2) return false;
  const std::size_t first = spans.front(), last = spans.back();
  std::vector<double> lengths;
  lengths.reserve(spans.size());
  for (const std::size_t s : spans) lengths.push_back(cable.segments[s].rest_length);
  const Vec2 d = cable.segments[last].head - cable.segments[first].tail;
  const double free = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  constexpr double nothing = 1e-12;  // of the length: so little slack asks for any tension
  if (free - d.norm() <= nothing * cable.length) return false;
  const std::array<double, 2> slopes = {slope_at(at(cable.links, link)),
                                        slope_at(cable.links[last])};
  const Hanging hanging = hang(cable, lengths, end_of(world, cable, link, first),
                               end_of(world, cable, static_cast<int>(last), last), slopes, gravity);
  if (give_way(world, cable, link, true, hanging.lengths.front(), hanging.directions.front(), laid))
    return true;
  if (give_way(world, cable, static_cast<int>(last), false, hanging.lengths.back(),
               hanging.directions.back(), laid))
    return true;
  const Flow tail = flow_at(world, cable, first, false), head = flow_at(world, cable, last, true);
  Vec2 place = hanging.tail;
  double passed = 0.0;
  for (std::size_t k = 0; k + 1 < spans.size(); ++k) {
    place += hanging.lengths[k] * hanging.directions[k];
    passed += lengths[k];
    const Vec2 along = (hanging.directions[k] + hanging.directions[k + 1]).normalized();
    const int node = cable.links[spans[k]].body;
    at(world.position, node) = place;
    at(world.velocity, node) = velocity_between(tail, head, passed / free, along);
  }
  const auto radii = [&] { return Vec2(at(cable.links, link).radius, cable.links[last].radius); };
  const Vec2 before = radii();
  for (const std::size_t s : spans) update_tangent(world, cable, s);
  update_wraps_and_rest_lengths(world, cable);
  // The span beside a drum that fills says where its outermost turn ends.
  constexpr double rounding = 1e-13;
  return cable.fills && (radii() - before).norm() > rounding * before.norm();
}

}  // namespace

void string_nodes(World& world, CableState& cable, const Vec2& gravity) {
  // Without gravity it is at rest in any shape.
  const Vec2 g = gravity.norm() > 0.0 ? gravity : Vec2(0.0, -1.0);
  string_all(world, cable, mooring_distance(cable));
  // What hangs lays nodes on rims and takes others off; mostly few.
  std::vector<LaidCorner> laid;
  bool changed = true;
  for (int turn = 0; changed && turn < 4 * cable.nodes; ++turn) {
    changed = false;
    for (int i = 0; !changed && index(i) < cable.links.size(); ++i) {
      if (!is_strung(cable, at(cable.links, i))) changed = hang_free(world, cable, i, g, laid);
    }
    if (changed || !has_given_off(world, cable)) continue;
    give_off_nodes(world, cable);
    changed = true;
  }
  for (int i = static_cast<int>(cable.links.size()) - 1; i >= 0; --i) {
    const Link& link = at(cable.links, i);
    const bool off = link.corner >= 0 && link.wrap < 0.0 && !needed(cable, index(i));
    if (off) remove_link(world, cable, i);
  }
  for (Segment& segment : cable.segments) begin_here(segment);
  carry_wound_nodes(world, cable);
}

}  // namespace pinchlab
