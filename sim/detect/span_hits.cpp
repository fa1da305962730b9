// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/detect/span_hits.h"

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/tangent.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// Overlap below which a body only grazes the cable, as a share of its radius and the half width:
/// round-off must not make links.
constexpr double graze = 1e-10;

struct Hit {
  bool found = false;
  double time = 0.0;  // of the touch, in steps; -1 is the last step's position, 0 the present
  int body = -1;
  int orientation = 0;
  std::size_t segment = 0;
};

/// The middle link of a pinch near the end of the wrapped arc comes off through that arc's removal,
/// not by hitting the span that leaves the arc.
bool pinched_beside(const CableState& cable, std::size_t segment, int body) {
  constexpr double near_end = 0.5;  // rad
  const int head = static_cast<int>(segment);
  const int tail = previous_link(cable, head);
  const int before = previous_link(cable, tail), after = next_link(cable, head);
  const auto beside = [&](int link, int neighbour) {
    return neighbour >= 0 && cable.links[static_cast<std::size_t>(neighbour)].body == body &&
           cable.links[static_cast<std::size_t>(link)].wrap < near_end;
  };
  return beside(tail, before) || beside(head, after);
}

/// A body that has just left the cable was on the other side of the span that closed up behind it:
/// the cable then ran round it. It has not crossed.
bool just_left(const World& world, const Workspace& work, const CableState& cable,
               const Segment& segment, int body) {
  const bool fresh = segment.previous_tail == segment.tail && segment.previous_head == segment.head;
  if (!fresh) return false;
  for (const Release& release : work.released) {
    if (&world.cables[static_cast<std::size_t>(release.cable)] == &cable && release.body == body)
      return true;
  }
  return false;
}

Hit test_span(const World& world, const Workspace& work, const CableState& cable, std::size_t s,
              int body) {
  const Segment& segment = cable.segments[s];
  Hit hit;
  if (segment.pinched || !(segment.length > 0.0) || pinched_beside(cable, s, body)) return hit;
  if (just_left(world, work, cable, segment, body)) return hit;
  const auto b = static_cast<std::size_t>(body);
  const double margin = (world.bodies[b].radius + cable.half_width) * (1.0 - graze);
  const Vec2 now = world.position[b] - segment.tail;
  const double along = segment.direction.dot(now), side = cross(segment.direction, now);
  const bool beside = along > 0.0 && along < segment.length;
  const bool within = beside && std::abs(side) < margin;
  if (!within && segment.tail == segment.previous_tail && segment.head == segment.previous_head &&
      b < work.start.position.size() && work.start.position[b] == world.position[b]) {
    return hit;  // neither of them has moved
  }
  const Vec2& then = b < work.start.position.size() ? work.start.position[b] : world.position[b];
  const Vec2 before = then - segment.previous_tail;
  const Vec2 span_before = segment.previous_head - segment.previous_tail;
  const double length_before = span_before.norm();
  const Vec2 direction_before =
      length_before > 0.0 ? Vec2(span_before / length_before) : segment.direction;
  const double along_before = direction_before.dot(before);
  const double side_before = cross(direction_before, before);

  // What was beside the span's line before has come past its end: it is in front of the cable, not
  // in its way.
  constexpr double in_touch = 1e-6;
  if (locates_events(world.configuration) && std::abs(side_before) < margin * (1.0 - in_touch)) {
    return hit;
  }
  bool reached = within;
  if (!reached && side * side_before < 0.0) {
    const double t = side_before / (side_before - side);  // of the crossing, 0..1 within the step
    const double along_then = along_before + t * (along - along_before);
    const double length_then = length_before + t * (segment.length - length_before);
    reached = along_then > 0.0 && along_then < length_then;
  }
  if (!reached) return hit;
  const double old_side = side_before != 0.0 ? side_before : side;
  const double approach = old_side > 0.0 ? old_side - side : side - old_side;
  hit.found = true;
  hit.body = body;
  hit.segment = s;
  hit.orientation = old_side > 0.0 ? 1 : -1;
  hit.time = approach > 0.0 ? (std::abs(old_side) - margin) / approach - 1.0 : 0.0;
  return hit;
}

/// Whether the span can be hit by the body at all.
bool may_hit(const World& world, const CableState& cable, std::size_t s, int body) {
  const int head = static_cast<int>(s), tail = previous_link(cable, head);
  return !holds_span(world, cable, cable.links[s], body) &&
         !holds_span(world, cable, cable.links[static_cast<std::size_t>(tail)], body);
}

}  // namespace

double span_clearance(const World& world, const CableState& cable, std::size_t s, int body,
                      int orientation) {
  const Segment& segment = cable.segments[s];
  const Vec2 x = at(world.position, body) - segment.tail;
  const double margin = at(world.bodies, body).radius + cable.half_width;
  return orientation * cross(segment.direction, x) - margin;
}

void find_hits(const World& world, Workspace& work, std::vector<Happening>& events) {
  for (const SpanPair& pair : work.broad_phase.span_pairs) {
    const CableState& cable = at(world.cables, pair.cable);
    const auto s = index(pair.segment);
    if (is_still(work.parts, pair.body) && !cable.segments[s].moved) continue;
    if (!may_hit(world, cable, s, pair.body)) continue;
    const Hit hit = test_span(world, work, cable, s, pair.body);
    if (!hit.found) continue;
    Happening event{EventKind::hit};
    event.cable = pair.cable;
    event.item = pair.segment;
    event.body = pair.body;
    event.orientation = hit.orientation;
    events.push_back(event);
  }
}

void add_hit_links(World& world, const Workspace& work) {
  const auto& pairs = work.broad_phase.span_pairs;
  // From the last segment to the first: a link put in leaves the indices before it as they are.
  std::size_t end = pairs.size();
  while (end > 0) {
    std::size_t begin = end - 1;
    while (begin > 0 && pairs[begin - 1].cable == pairs[end - 1].cable &&
           pairs[begin - 1].segment == pairs[end - 1].segment) {
      --begin;
    }
    CableState& cable = world.cables[static_cast<std::size_t>(pairs[begin].cable)];
    const auto first = static_cast<std::size_t>(pairs[begin].segment);
    std::size_t added = 0;
    // Of all hits take the earliest, then test the rest against the parts of the span. A body gets
    // at most one link a span and step, so there are at most end - begin rounds.
    for (bool again = true; again && added < end - begin;) {
      again = false;
      Hit earliest;
      for (std::size_t i = begin; i < end; ++i) {
        const bool still = is_still(work.parts, pairs[i].body);
        for (std::size_t part = 0; part <= added; ++part) {
          const std::size_t s = first == 0 && part > 0 ? cable.links.size() - part : first + part;
          if (still && !cable.segments[s].moved) continue;
          if (!may_hit(world, cable, s, pairs[i].body)) continue;
          const Hit hit = test_span(world, work, cable, s, pairs[i].body);
          if (hit.found && (!earliest.found || hit.time < earliest.time)) earliest = hit;
        }
      }
      if (earliest.found) {
        insert_link(world, cable, earliest.segment, earliest.body, earliest.orientation);
        ++added;
        again = true;
      }
    }
    end = begin;
  }
}

}  // namespace pinchlab
