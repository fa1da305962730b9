// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/detect/corner_end.h"

#include "base/at.h"
#include "sim/cable/cable.h"

namespace pinchlab {

CornerEnd corner_end(const CableState& cable, std::size_t s, int body) {
  const Link &to = cable.links[s],
             &from = at(cable.links, previous_link(cable, static_cast<int>(s)));
  const auto holds = [body](const Link& link) {
    return link.body == body && link.corner >= 0 && !link.moored;
  };
  if (holds(from)) return {&from, &to, true};
  if (holds(to)) return {&to, &from, false};
  return {};
}

double clearance_of_arc(const World& world, const CableState& cable, std::size_t s,
                        const CornerEnd& corner, const Vec2& centre, double margin) {
  const Link& other = *corner.other;
  const bool turns = other.orientation == corner.end->orientation && !other.pinch_middle &&
                     !other.moored && other.body != corner.end->body;
  if (!turns) return infinity;
  const int head = static_cast<int>(s);
  const Segment &span = cable.segments[s],
                &next = at(cable.segments,
                           corner.leaves ? next_link(cable, head) : previous_link(cable, head));
  if (next.pinched || !(next.length > 0.0)) return infinity;
  const auto is_past = [&centre](const Segment& segment, bool leaves) {
    return leaves ? segment.direction.dot(centre - segment.head) > 0.0
                  : segment.direction.dot(centre - segment.tail) < 0.0;
  };
  if (!is_past(span, corner.leaves) || !is_past(next, !corner.leaves)) return infinity;
  return other.radius - margin - (centre - link_centre(world, other)).norm();
}

}  // namespace pinchlab
