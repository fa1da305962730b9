// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/strung.h"
#include "sim/compound.h"
#include "sim/detect/broad_phase.h"
#include "sim/lines.h"
#include "sim/node_count.h"
#include "sim/outline.h"
#include "sim/scene_error.h"
#include "sim/scene_words.h"
#include "sim/tangent.h"
#include "sim/touch.h"

namespace pinchlab {

namespace {

/// Corners of a polygon (m) where it starts.
std::vector<Vec2> corners_of(const World& world, int body) {
  std::vector<Vec2> corners;
  for (int k = 0; index(k) < at(world.bodies, body).corners.size(); ++k) {
    corners.push_back(place_of_point(world, body, k));
  }
  return corners;
}

/// Between a line from p to q and a polygon (m); 0 where it runs into it.
double distance_to(const std::vector<Vec2>& corners, const Vec2& p, const Vec2& q) {
  double least = std::min(outside_of(corners, p).distance, outside_of(corners, q).distance);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 &a = corners[i], &b = corners[(i + 1) % corners.size()];
    least = std::min(least, distance_from_line(p, q, a));
    if (lines_cross(a, b, p, q)) return 0.0;
  }
  return std::max(least, 0.0);
}

/// How far a line from p to q, which runs into a polygon, is in it (m): by the shortest way that
/// parts them, out of one of the sides or to one side of the line.
double depth_in(const std::vector<Vec2>& corners, const Vec2& p, const Vec2& q) {
  double least = infinity;
  const auto note = [&least](double depth) { least = std::min(least, depth); };
  const Vec2 across = left((q - p).normalized());
  double over = -infinity, under = -infinity;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const Vec2 out = -left((b - a).normalized());
    note(-std::min(out.dot(p - a), out.dot(q - a)));
    over = std::max(over, across.dot(a - p));
    under = std::max(under, -across.dot(a - p));
  }
  note(over);
  note(under);
  return least;
}

/// Between the outline of a polygon and a wall (m); below 0 they overlap by that.
double gap_to_wall(const World& world, int body, const Wall& wall) {
  const std::vector<Vec2> corners = corners_of(world, body);
  const double distance = distance_to(corners, wall.a, wall.b);
  return (distance > 0.0 ? distance : -depth_in(corners, wall.a, wall.b)) -
         at(world.bodies, body).corner_radius;
}

/// The cable of the scene's author that a node is part of, or -1: the first of the pieces that lead
/// up to it.
int cable_of_node(const Scene& scene, int node) {
  int cable = -1;
  while (node >= 0 && at(scene.bodies, node).node) {
    const auto piece =
        std::find_if(scene.cables.begin(), scene.cables.end(), [node](const Cable& candidate) {
          return candidate.end.body == node && candidate.wraps.empty() && !candidate.closed;
        });
    if (piece == scene.cables.end()) break;
    cable = static_cast<int>(piece - scene.cables.begin());
    node = piece->start.body;
  }
  return cable;
}

/// `what` is what a body overlaps, by `depth` (m). Nodes are in no scene file: of one it is told
/// what its cable does.
[[noreturn]] void refuse_overlap(const Scene& scene, int body, const std::string& what,
                                 double depth, const char* cure) {
  const int cable = cable_of_node(scene, body);
  if (cable < 0) {
    throw SceneError(pointer("bodies", index(body)),
                     fmt::format("body '{}' overlaps {} by {}; {}", at(scene.bodies, body).name,
                                 what, in_mm(depth), cure));
  }
  throw SceneError(pointer("cables", index(cable)),
                   fmt::format("as it hangs at the start the cable runs through {} ({} deep at its "
                               "node '{}'); give it another slack or other ends, or move that",
                               what, in_mm(depth), at(scene.bodies, body).name));
}

}  // namespace

void refuse_overlaps(const Scene& scene, const World& world, const BroadPhase& broad) {
  const double allowed = overlap_allowed(scene);
  for (const BodyPair& pair : broad.body_pairs) {
    const Body &a = at(scene.bodies, pair.a), &b = at(scene.bodies, pair.b);
    const double gap = is_polygon(a) || is_polygon(b)
                           ? separation(world, pair.a, pair.b)
                           : (b.position - a.position).norm() - a.radius - b.radius;
    if (gap < -allowed) {
      const bool first = a.node && !b.node;
      refuse_overlap(scene, first ? pair.a : pair.b, name_of_body(scene, first ? pair.b : pair.a),
                     -gap, "move them apart");
    }
  }
  for (const WallPair& pair : broad.wall_pairs) {
    const Body& body = at(scene.bodies, pair.body);
    const Wall& wall = at(scene.walls, pair.wall);
    const double gap = is_polygon(body)
                           ? gap_to_wall(world, pair.body, wall)
                           : distance_from_line(wall.a, wall.b, body.position) - body.radius;
    if (gap < -allowed) {
      refuse_overlap(scene, pair.body, fmt::format("wall {}", pair.wall), -gap, "move it away");
    }
  }
}

/// No wrap takes a cable round a body that one of its ends lies in.
void refuse_ends_inside(const Scene& scene, const World& world, const SpanPair& pair) {
  const CableState& cable = at(world.cables, pair.cable);
  const Segment& segment = at(cable.segments, pair.segment);
  const Body& body = at(scene.bodies, pair.body);
  const auto refuse = [&](const Link& link, const char* end, const Vec2& point) {
    if (link.orientation != 0 || (link.body >= 0 && at(scene.bodies, link.body).node)) return;
    const double distance = is_polygon(body)
                                ? outside_of(corners_of(world, pair.body), point).distance
                                : (point - body.position).norm();
    const double depth = rim_radius(body) + cable.half_width - distance;
    if (depth <= overlap_allowed(scene)) return;
    throw SceneError(pointer("cables", index(pair.cable)) + end,
                     fmt::format("the cable's end lies {} inside of body '{}' (half width "
                                 "included); move one of them, or fix the end to the body",
                                 in_mm(depth), body.name));
  };
  refuse(at(cable.links, previous_link(cable, pair.segment)), "/start", segment.tail);
  refuse(at(cable.links, pair.segment), "/end", segment.head);
}

void refuse_cables_through_bodies(const Scene& scene, const World& world, const BroadPhase& broad) {
  const double allowed = overlap_allowed(scene);
  for (const SpanPair& pair : broad.span_pairs) {
    const CableState& cable = at(world.cables, pair.cable);
    const Segment& segment = at(cable.segments, pair.segment);
    const Body& body = at(scene.bodies, pair.body);
    const auto segment_number = index(pair.segment);
    const auto tail = index(previous_link(cable, pair.segment));
    if (cable.links[segment_number].body == pair.body || cable.links[tail].body == pair.body)
      continue;
    const double distance =
        is_polygon(body) ? distance_to(corners_of(world, pair.body), segment.tail, segment.head)
                         : distance_from_line(segment.tail, segment.head, body.position);
    const double overlap = rim_radius(body) + cable.half_width - distance;
    if (overlap > allowed) {
      refuse_ends_inside(scene, world, pair);
      throw SceneError(
          pointer("cables", index(pair.cable)),
          fmt::format("the cable runs through body '{}' ({} deep) on its way to {}; add the body "
                      "to the cable's wraps or move it",
                      body.name, in_mm(overlap),
                      name_of_body(scene, cable.links[segment_number].body)));
    }
  }
}

void refuse_crowded_nodes(const Cable& given, const CableState& cable, std::size_t number) {
  const double least = least_piece(given);
  const double piece = cable.length / (given.closed ? given.nodes : given.nodes + 1);
  if (piece > least) return;
  const int most = static_cast<int>(std::ceil(cable.length / least)) - (given.closed ? 1 : 2);
  throw SceneError(pointer("cables", number) + "/nodes",
                   fmt::format("pieces of {} between nodes are no longer than {}; at most {} nodes "
                               "fit",
                               in_mm(piece), words_for_least_piece(given), std::max(most, 0)));
}

namespace {

/// Whether its circle stands.
bool has_still_centre(const World& world, const Link& link) {
  if (link.body < 0) return true;
  const BodyProperties& body = at(world.bodies, mover_of(world, link.body));
  const bool is_centre = is_central(link) && at(world.bodies, link.body).seat.isZero(0.0);
  return is_static(body) || (!can_move(body) && is_centre);
}

/// Whether a link lets no cable through, and stands.
bool holds_fast(const World& world, const Link& link) {
  if (link.orientation == 0) return has_still_centre(world, link);
  const BodyProperties& body = at(world.bodies, mover_of(world, link.body));
  return is_static(body) && body.cable_friction == infinity;
}

/// The last link in succession on the rigid body that a link is on.
int last_on_its_body(const World& world, const CableState& cable, int link) {
  const int mover = mover_of(world, at(cable.links, link).body);
  const auto is_on_it = [&](int i) {
    const int body = i >= 0 ? at(cable.links, i).body : -1;
    return body >= 0 && mover_of(world, body) == mover;
  };
  int last = link;
  const std::size_t count = cable.links.size();
  for (std::size_t k = 0; k < count && is_on_it(next_link(cable, last)); ++k) {
    last = next_link(cable, last);
  }
  return last;
}

/// Whether a body on an axle, which cable runs on to and off again without slip at these links,
/// can turn neither way where both sides are taut: what turns it one way tightens either.
bool is_wedged(const World& world, const CableState& cable, int on, int off) {
  const int mover = mover_of(world, at(cable.links, on).body), after = next_link(cable, off);
  const BodyProperties& body = at(world.bodies, mover);
  if (after < 0 || can_move(body) || !is_mobile(body) || body.cable_friction < infinity)
    return false;
  const Segment& in = at(cable.segments, on);
  const Segment& out = at(cable.segments, after);
  const Vec2& axle = at(world.position, mover);
  const double torques =
      cross(in.head - axle, -in.direction) * cross(out.tail - axle, out.direction);
  return torques < 0.0;
}

}  // namespace

void refuse_what_cannot_hang(const Scene& scene, const World& world) {
  constexpr double rounding = 1e-9;  // of lengths between places that are decimal figures
  for (const int c : world.strung) {
    const CableState& cable = at(world.cables, c);
    if (at(scene.cables, c).axial_stiffness < infinity) continue;
    const int count = static_cast<int>(cable.links.size());
    for (int i = 0; i < count; ++i) {
      if (!holds_fast(world, at(cable.links, i))) continue;
      // From there on as far as nothing gives: over circles that stand, straight between them.
      bool hangs = false;
      int from = i, next = next_link(cable, i);
      double material = 0.0;
      for (int k = 0; next >= 0 && k < count; ++k, next = next_link(cable, next)) {
        material += at(cable.segments, next).rest_length;
        if (is_strung(cable, at(cable.links, next))) continue;
        const int first = next_link(cable, from);
        const Vec2 d = at(cable.segments, next).head - at(cable.segments, first).tail;
        const double across = std::abs(cross(d, scene.gravity));
        hangs = hangs || (first != next && across > rounding * d.norm() * scene.gravity.norm());
        if (material - d.norm() > rounding * d.norm()) break;
        if (!has_still_centre(world, at(cable.links, next))) {
          const int off = last_on_its_body(world, cable, next);
          if (!is_wedged(world, cable, next, off)) break;
          next = off;
        }
        if (hangs && holds_fast(world, at(cable.links, next))) {
          throw SceneError(
              pointer("cables", index(c)) + "/slack_m",
              fmt::format("between {} and {}, which hold it fast, a cable with mass hangs, and no "
                          "tension bears its weight where it is only as long as its way; give it "
                          "slack or an axial stiffness, or leave out its nodes",
                          name_of_body(scene, at(cable.links, i).body),
                          name_of_body(scene, at(cable.links, next).body)));
        }
        from = next;
        material = 0.0;
      }
    }
  }
}

void refuse_hanging_into_others(const Scene& scene, const World& world, const BroadPhase& broad) {
  const double allowed = overlap_allowed(scene);
  const auto refuse = [](int cable, const std::string& what, double depth) {
    throw SceneError(pointer("cables", index(cable)),
                     fmt::format("as it hangs at the start the cable runs through {} ({} deep); "
                                 "give it another slack, or move that",
                                 what, in_mm(depth)));
  };
  for (const int c : world.strung) {
    const CableState& cable = at(world.cables, c);
    const auto is_node = [&cable](int body) {
      return body >= cable.first_node && body < cable.first_node + cable.nodes;
    };
    for (const Contact& contact : world.contacts) {
      if (!is_node(contact.a) && !is_node(contact.b)) continue;
      const int other = is_node(contact.a) ? contact.b : contact.a;
      if (contact.gap >= -allowed) continue;
      refuse(c, other >= 0 ? name_of_body(scene, other) : fmt::format("wall {}", contact.wall),
             -contact.gap);
    }
    for (const SpanPair& pair : broad.span_pairs) {
      if (pair.cable != c) continue;
      const Link& head = at(cable.links, pair.segment);
      const Link& tail = at(cable.links, previous_link(cable, pair.segment));
      if (!is_strung(cable, head) || !is_strung(cable, tail)) continue;
      if (is_within_end(world, cable, head, pair.body)) continue;
      if (is_within_end(world, cable, tail, pair.body)) continue;
      const Segment& segment = at(cable.segments, pair.segment);
      const Vec2& x = at(world.position, pair.body);
      const BodyProperties& body = at(world.bodies, pair.body);
      const double distance =
          is_polygon(body) ? distance_to(corners_of(world, pair.body), segment.tail, segment.head)
                           : distance_from_line(segment.tail, segment.head, x);
      const double overlap = rim_radius(body) + cable.half_width - distance;
      if (overlap > allowed) refuse(c, name_of_body(scene, pair.body), overlap);
    }
  }
}

void refuse_squeezed_wraps(const Scene& scene, const World& world) {
  const double allowed = overlap_allowed(scene);
  for (const Contact& contact : world.contacts) {
    if (contact.b < 0) continue;  // no cable is between: refuse_overlaps has seen it
    if (contact.gap < contact.target - allowed) {
      const Body &a = at(scene.bodies, contact.a), &b = at(scene.bodies, contact.b);
      throw SceneError(
          pointer("bodies", index(contact.b)),
          fmt::format(
              "body '{}' squeezes a cable on body '{}': the gap is {} and the cable {} wide; "
              "move them apart",
              b.name, a.name, in_mm(contact.gap), in_mm(contact.target)));
    }
  }
}

void refuse_slip_of_mass(const Scene& scene, const Configuration& configuration) {
  if (configuration.solver == Solver::direct && configuration.pinch_rows == PinchRows::one) return;
  const auto slips = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                  [](const Body& body) { return body.cable_friction < infinity; });
  if (slips == scene.bodies.end()) return;
  for (std::size_t c = 0; c < scene.cables.size(); ++c) {
    if (scene.cables[c].mass_per_metre == 0.0) continue;
    throw SceneError(pointer("cables", c),
                     fmt::format("a cable with mass slips by the direct solver with one row a "
                                 "pinch only, and could on body '{}'; choose that, or leave out "
                                 "the body's cable_friction or the cable's mass",
                                 slips->name));
  }
}

}  // namespace pinchlab
