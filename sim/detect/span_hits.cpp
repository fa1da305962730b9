// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/detect/span_hits.h"

#include <algorithm>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/joins.h"
#include "sim/cable/strung.h"
#include "sim/cable/taking_in.h"
#include "sim/detect/corner_end.h"
#include "sim/detect/detect.h"
#include "sim/outline.h"
#include "sim/tangent.h"
#include "sim/touch.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// The same share, of what has been in touch: far above what touching bodies overlap by, which is
/// within_reach of the part's extent.
constexpr double in_touch = 1e-6;

struct Hit {
  bool found = false;
  double time = 0.0;  // of the touch, in steps; -1 is the last step's position, 0 the present. Of a
                      // span that closes up: m, on the side that it comes from below 0
  int body = -1;
  int corner = -1;
  int orientation = 0;
  bool beside = false;  // as in Happening
  std::size_t segment = 0;
};

/// What may hit a span: a disc, or the circle about a polygon's corner.
struct Circle {
  int body = 0, corner = -1;
  Vec2 now, before;     // m, of its centre; `before` is at the interval's start
  double margin = 0.0;  // m, its radius and the cable's half width
};

/// Corner -1 is the body itself.
Circle circle_of(const World& world, const Workspace& work, const CableState& cable, int body,
                 int corner) {
  const BodyProperties& b = at(world.bodies, body);
  const Start& start = work.start;
  Circle circle{body, corner, at(world.position, body), at(world.position, body),
                rim_radius(b) + cable.half_width};
  const bool known = index(body) < start.position.size();
  if (known) circle.before = at(start.position, body);
  if (corner < 0) return circle;
  const Vec2& point = at(b.corners, corner);
  circle.now = place_of_point(world, body, corner);
  const bool turns = known && index(body) < start.angle.size();
  circle.before += turned(point, turns ? at(start.angle, body) : at(world.angle, body));
  return circle;
}

/// The middle link of a pinch near the end of the wrapped arc comes off through that arc's removal,
/// not by hitting the span that leaves the arc. A node is no such arc: beyond it the cable may come
/// back to the rim beside it.
bool pinched_beside(const CableState& cable, std::size_t segment, int body) {
  // rad: more than an arc that comes off turns by in a step, far less than to the next turn.
  constexpr double near_end = 0.5;
  const int head = static_cast<int>(segment);
  const int tail = previous_link(cable, head);
  const int before = previous_link(cable, tail), after = next_link(cable, head);
  const auto beside = [&](int link, int neighbour) {
    return neighbour >= 0 && at(cable.links, neighbour).body == body &&
           at(cable.links, link).orientation != 0 && at(cable.links, link).wrap < near_end;
  };
  return beside(tail, before) || beside(head, after);
}

/// Of a cable, those since update_segments.
std::span<const Release> releases_of(const World& world, const Workspace& work,
                                     const CableState& cable) {
  const Release key{static_cast<int>(&cable - world.cables.data()), -1, 0};
  const auto [begin, end] =
      std::equal_range(work.released.begin(), work.released.end(), key,
                       [](const Release& p, const Release& q) { return p.cable < q.cable; });
  return {begin, end};
}

/// Whether a span lies as if it had closed up where one of these was.
bool is_fresh(const Segment& segment, std::span<const Release> releases) {
  return !releases.empty() && segment.previous_tail == segment.tail &&
         segment.previous_head == segment.head;
}

/// How a body that has just left the cable lay on it; 0 of another.
int orientation_left(std::span<const Release> releases, int body) {
  const auto release = std::ranges::find(releases, body, &Release::body);
  return release != releases.end() ? release->orientation : 0;
}

/// Such a body was on the other side of the span that closed up behind it, since the cable ran
/// round it: it has not crossed. It has left the cable, unless it is in the way of that span, as
/// another body that lay between them has left as well.
Hit test_left(const Segment& segment, std::size_t s, const Circle& circle, int orientation) {
  const Vec2 x = circle.now - segment.tail;
  const double along = segment.direction.dot(x);
  Hit hit;
  hit.found = along > 0.0 && along < segment.length &&
              std::abs(cross(segment.direction, x)) < circle.margin * (1.0 - in_touch);
  hit.body = circle.body;
  hit.orientation = orientation;
  hit.segment = s;
  return hit;
}

/// Whether a link is an end of its cable that bars the way. Obstacles are sorted by their cables,
/// behind those that are walls.
bool is_solid_end(const World& world, const CableState& cable, const Link& link) {
  if (link.body >= 0) return false;
  const int number = static_cast<int>(&cable - world.cables.data());
  auto end = std::lower_bound(world.obstacles.begin(), world.obstacles.end(), number,
                              [](const Obstacle& o, int c) { return o.cable < c; });
  for (; end != world.obstacles.end() && end->cable == number; ++end) {
    if (end->a == link.offset) return true;
  }
  return false;
}

/// Whether what is at the side of a span is at that of the piece beyond the node at its end, too.
bool is_over_next_piece(const CableState& cable, std::size_t s, bool over_tail, const Vec2& centre,
                        double side) {
  const int head = static_cast<int>(s);
  const Segment& next =
      at(cable.segments, over_tail ? previous_link(cable, head) : next_link(cable, head));
  return cross(next.direction, centre - (over_tail ? next.head : next.tail)) * side > 0.0;
}

/// The side (m) from which something comes upon a span over an end of it, beyond which it was so
/// far along (m): from over an end of its cable that bars the way, and which it has come round; a
/// rim, away from which it lay, or lies where that has given off the cable below it; or a free
/// node, which has kept it off, from over the piece beyond. Else 0.
double side_over_end(const World& world, const CableState& cable, std::size_t s, const Vec2& centre,
                     double along_before, double side_before, double side) {
  const int head = static_cast<int>(s), tail = previous_link(cable, head);
  const bool over_tail = along_before <= 0.0;
  const Link& link = at(cable.links, over_tail ? tail : head);
  if (is_strung(cable, link) && !link.moored) {
    return is_over_next_piece(cable, s, over_tail, centre, side) ? side : 0.0;
  }
  if (link.orientation * side_before < 0.0) return side_before;
  if (link.corner < 0 && link.orientation * side < 0.0) return side;
  return is_solid_end(world, cable, link) ? side : 0.0;
}

Hit test_circle(const World& world, const Workspace& work, const CableState& cable, std::size_t s,
                const Circle& circle) {
  const Segment& segment = cable.segments[s];
  Hit hit;
  const double margin = circle.margin * (1.0 - graze);
  const Vec2 now = circle.now - segment.tail;
  const double along = segment.direction.dot(now), side = cross(segment.direction, now);
  const bool beside = along > 0.0 && along < segment.length;
  const bool within = beside && std::abs(side) < margin;
  if (!within && segment.tail == segment.previous_tail && segment.head == segment.previous_head &&
      circle.before == circle.now && !work.start.position.empty()) {
    return hit;  // neither of them has moved
  }
  const Vec2 before = circle.before - segment.previous_tail;
  const Vec2 span_before = segment.previous_head - segment.previous_tail;
  const double length_before = span_before.norm();
  const Vec2 direction_before =
      length_before > 0.0 ? Vec2(span_before / length_before) : segment.direction;
  const double along_before = direction_before.dot(before);
  const double side_before = cross(direction_before, before);

  // What was within reach of the span's line before, but not beside the span, has come past its
  // end: it is in front of the cable, not in its way, but where side_over_end tells otherwise. What
  // was beside it has been pushed into it by a repair.
  const bool beside_before = along_before > 0.0 && along_before < length_before;
  double old_side = side_before != 0.0 ? side_before : side;
  if (locates_events(world.configuration) && !beside_before &&
      std::abs(side_before) < margin * (1.0 - in_touch)) {
    old_side =
        within ? side_over_end(world, cable, s, circle.now, along_before, side_before, side) : 0.0;
    if (old_side == 0.0) return hit;
  }
  bool reached = within;
  if (!reached && side * side_before < 0.0) {
    const double t = side_before / (side_before - side);  // of the crossing, 0..1 within the step
    const double along_then = along_before + t * (along - along_before);
    const double length_then = length_before + t * (segment.length - length_before);
    reached = along_then > 0.0 && along_then < length_then;
  }
  if (!reached) return hit;
  const double approach = old_side > 0.0 ? old_side - side : side - old_side;
  hit.found = true;
  hit.body = circle.body;
  hit.corner = circle.corner;
  hit.segment = s;
  hit.orientation = old_side > 0.0 ? 1 : -1;
  hit.time = approach > 0.0 ? (std::abs(old_side) - margin) / approach - 1.0 : 0.0;
  hit.beside = within && locates_events(world.configuration);
  if (!hit.beside || std::abs(side_before) < margin) return hit;
  // So far along the span it comes to within its margin of the span's line; ways are not straight.
  const double share = 1.0 + hit.time, unsure = 1e-2 * margin;
  const double along_then = along_before + share * (along - along_before);
  const double length_then = length_before + share * (segment.length - length_before);
  if (along_then > -unsure && along_then < length_then + unsure) return hit;
  hit.found = side_over_end(world, cable, s, circle.now, along_then, old_side, old_side) != 0.0;
  return hit;
}

/// Whether the cable would wrap a corner's circle between what is beside it there: a side to link
/// `end`, before it with `leaves` and else after it, and a span to or from link `other`.
bool wraps(const World& world, const Link& other, const Circle& circle, const Link& end,
           bool leaves) {
  const double radius = end.orientation * circle.margin;
  const Vec2 beyond = link_centre(world, other), side = circle.now - link_centre(world, end);
  if (leaves) {
    const Tangent span = common_tangent(circle.now, radius, beyond, other.signed_radius());
    return end.orientation * cross(side, span.direction) >= 0.0;
  }
  const Tangent span = common_tangent(beyond, other.signed_radius(), circle.now, radius);
  return end.orientation * cross(span.direction, -side) >= 0.0;
}

/// A span that leaves a polygon on which its cable lies meets the next corner of it, on the inner
/// side of the cable; likewise one that arrives, the corner before. It may come over the span's
/// other end, as one that slides down another body and past the corner of that, about which the
/// cable goes on. A span whose other end has got into the polygon would meet them for ever, and
/// meets none; nor does one that would leave the corner at once, since what holds its other end
/// reaches beyond the side's line.
Hit test_next_corner(const World& world, const Workspace& work, const CableState& cable,
                     std::size_t s, const CornerEnd& corner) {
  const Link &end = *corner.end, &other = *corner.other;
  const std::vector<Vec2>& corners = at(world.bodies, end.body).corners;
  const int count = static_cast<int>(corners.size());
  const int way = corner.leaves ? end.orientation : -end.orientation;
  const Circle circle = circle_of(world, work, cable, end.body, (end.corner + way + count) % count);
  const Segment& segment = cable.segments[s];
  const Vec2 x = circle.now - segment.tail;
  const double along = segment.direction.dot(x);
  const bool meets_span =
      along > 0.0 && along < segment.length &&
      end.orientation * cross(segment.direction, x) < circle.margin * (1.0 - graze);
  const double grazed = graze * circle.margin;
  const bool meets_arc =
      !meets_span && clearance_of_arc(world, cable, s, corner, circle.now, circle.margin) < -grazed;
  Hit hit;
  if (!meets_span && !meets_arc) return hit;
  const Vec2 far =
      meets_span ? (corner.leaves ? segment.head : segment.tail) : link_centre(world, other);
  const Vec2 place = turned(far - at(world.position, end.body), -at(world.angle, end.body));
  const double room = meets_span ? circle.margin : circle.margin - other.radius;
  hit.found = outside_of(corners, place).distance >= room - grazed &&
              wraps(world, other, circle, end, corner.leaves);
  hit.beside = locates_events(world.configuration);
  hit.body = end.body;
  hit.corner = circle.corner;
  hit.orientation = end.orientation;
  hit.segment = s;
  return hit;
}

/// The body's first hit of the span since the interval's start.
Hit test_span(const World& world, const Workspace& work, const CableState& cable, std::size_t s,
              int body) {
  const Segment& segment = cable.segments[s];
  if (segment.pinched || !(segment.length > 0.0)) return {};
  const CornerEnd end = corner_end(cable, s, body);
  if (end.end != nullptr) return test_next_corner(world, work, cable, s, end);
  const int corners = static_cast<int>(at(world.bodies, body).corners.size());
  const std::span<const Release> releases = releases_of(world, work, cable);
  const bool fresh = is_fresh(segment, releases);
  if (const int left = fresh ? orientation_left(releases, body) : 0; left != 0) {
    if (corners > 0 || pinched_beside(cable, s, body)) return {};
    return test_left(segment, s, circle_of(world, work, cable, body, -1), left);
  }
  // A span closes up where it has been going straight: what is beside it now was on that side of
  // the cable before, though not of this line.
  const bool closed_up = fresh && locates_events(world.configuration);
  const auto circle = [&](int corner) {
    Circle c = circle_of(world, work, cable, body, corner);
    if (closed_up) c.before = c.now;
    return c;
  };
  if (corners == 0) {
    if (pinched_beside(cable, s, body)) return {};
    return test_circle(world, work, cable, s, circle(-1));
  }
  Hit first;
  for (int k = 0; k < corners; ++k) {
    const Hit hit = test_circle(world, work, cable, s, circle(k));
    if (hit.found && (!first.found || hit.time < first.time)) first = hit;
  }
  return first;
}

/// Whether one of its nodes is, at an end of the cable that the body holds; or it holds one inside.
bool is_within_end(const World& world, const CableState& cable, const Link& from, const Link& to,
                   int body) {
  return holds_end_inside(world, cable, body) ||
         (is_strung(cable, from) && is_within_end(world, cable, from, body)) ||
         (is_strung(cable, to) && is_within_end(world, cable, to, body));
}

/// Whether the span can be hit by the body at all, now that one of them has moved.
bool may_hit(const World& world, const Workspace& work, const SpanPair& pair, std::size_t s) {
  const CableState& cable = at(world.cables, pair.cable);
  const int body = pair.body;
  const bool moved = cable.segments[s].moved && !is_idle(work.parts, index(pair.cable));
  if (!moved && is_still(work.parts, body)) return false;
  const int head = static_cast<int>(s), tail = previous_link(cable, head);
  const Link &to = cable.links[s], &from = at(cable.links, tail);
  if (cable.nodes > 0 && is_within_end(world, cable, from, to, body)) return false;
  return !holds_span(world, cable, to, body) && !holds_span(world, cable, from, body) &&
         !is_side(from, to);
}

/// How a cable went before a span closed up: from where that begins over a point to its end (m).
struct Closing {
  Vec2 tail, over, head;
};

/// The first of the body's circles that the cable comes upon as it closes up: of those within its
/// bend the farthest from the span.
Hit test_closing(const World& world, const Workspace& work, const CableState& cable, std::size_t s,
                 int body, const Closing& closing) {
  const Segment& segment = cable.segments[s];
  const Link &to = cable.links[s],
             &from = at(cable.links, previous_link(cable, static_cast<int>(s)));
  if (segment.pinched || !(segment.length > 0.0) || from.body == body || to.body == body) return {};
  const Vec2 first = closing.over - closing.tail, second = closing.head - closing.over;
  const int way = cross(first, second) > 0.0 ? 1 : -1;  // in which the cable turned
  Hit farthest;
  const auto test = [&](const Circle& circle) {
    const Vec2 x = circle.now - segment.tail;
    const double along = segment.direction.dot(x), side = way * cross(segment.direction, x);
    const bool within = way * cross(first, circle.now - closing.tail) > 0.0 &&
                        way * cross(second, circle.now - closing.over) > 0.0;
    const bool beside = along > 0.0 && along < segment.length;
    if (!within || !beside || side >= circle.margin * (1.0 - graze)) return;
    if (!farthest.found || side < farthest.time) {
      farthest = {true, side, body, circle.corner, way, false, s};
    }
  };
  const int corners = static_cast<int>(at(world.bodies, body).corners.size());
  if (corners == 0) test(circle_of(world, work, cable, body, -1));
  for (int k = 0; k < corners; ++k) test(circle_of(world, work, cable, body, k));
  return farthest;
}

/// Gives a segment links on those bodies of the pairs, all of its cable, that have hit it by a test
/// of (segment, body): of all hits on the first, then on what has hit the parts. A body gets at
/// most one link a span and step, so there are at most as many rounds as pairs. Returns how many.
template <class Test>
int meet_bodies(World& world, const Workspace& work, std::size_t segment,
                std::span<const SpanPair> pairs, Test test) {
  if (pairs.empty()) return 0;
  CableState& cable = at(world.cables, pairs.front().cable);
  std::size_t added = 0;
  for (bool again = true; again && added < pairs.size();) {
    again = false;
    Hit first;
    for (const SpanPair& pair : pairs) {
      if (work.neighbourhoods.separate_from_cable(pair.body, pair.cable)) continue;
      for (std::size_t part = 0; part <= added; ++part) {
        const std::size_t s = segment == 0 && part > 0 ? cable.links.size() - part : segment + part;
        if (!may_hit(world, work, pair, s)) continue;
        const Hit hit = test(s, pair.body);
        if (hit.found && (!first.found || hit.time < first.time)) first = hit;
      }
    }
    if (first.found) {
      meet_body(world, cable, first.segment, first.body, first.corner, first.orientation);
      ++added;
      again = true;
    }
  }
  return static_cast<int>(added);
}

}  // namespace

double span_clearance(const World& world, const Happening& hit) {
  const CableState& cable = at(world.cables, hit.cable);
  const Segment& segment = at(cable.segments, hit.item);
  const BodyProperties& body = at(world.bodies, hit.body);
  const Vec2 centre =
      hit.corner < 0 ? at(world.position, hit.body) : place_of_point(world, hit.body, hit.corner);
  const Vec2 x = centre - segment.tail;
  const double margin = rim_radius(body) + cable.half_width;
  if (const CornerEnd end = corner_end(cable, index(hit.item), hit.body); end.end != nullptr) {
    const double beyond = clearance_of_arc(world, cable, index(hit.item), end, centre, margin);
    if (beyond < infinity) return beyond;
  }
  const double along = segment.direction.dot(x);
  const double clearance = hit.orientation * cross(segment.direction, x) - margin;
  return hit.beside ? std::max({clearance, -along, along - segment.length}) : clearance;
}

bool may_meet(const World& world, const SpanPair& pair) {
  const CableState& cable = at(world.cables, pair.cable);
  const Box box = span_box(at(cable.segments, pair.segment));
  const Vec2& x = at(world.position, pair.body);
  const double way = world.step_length * at(world.velocity, pair.body).norm();
  const Vec2 reach = Vec2::Constant(at(world.bodies, pair.body).radius + cable.half_width + way);
  const Box own{x - reach, x + reach};
  return overlap(box, own, 0) && overlap(box, own, 1);
}

void find_hits(const World& world, Workspace& work, std::span<const SpanPair> pairs) {
  for (const SpanPair& pair : pairs) {
    const CableState& cable = at(world.cables, pair.cable);
    const auto s = index(pair.segment);
    if (!may_hit(world, work, pair, s)) continue;
    const Hit hit = test_span(world, work, cable, s, pair.body);
    if (!hit.found) continue;
    if (work.neighbourhoods.separate_from_cable(pair.body, pair.cable)) {
      work.neighbourhoods.crossed = true;
      continue;
    }
    Happening event{EventKind::hit};
    event.cable = pair.cable;
    event.item = pair.segment;
    event.body = pair.body;
    event.corner = hit.corner;
    event.orientation = hit.orientation;
    event.beside = hit.beside;
    work.events.push_back(event);
  }
}

int meet_in_closing(World& world, Workspace& work, int cable, std::size_t segment,
                    const Vec2& over) {
  const CableState& state = at(world.cables, cable);
  const Closing closing{state.segments[segment].tail, over, state.segments[segment].head};
  const auto test = [&](std::size_t s, int body) {
    return test_closing(world, work, state, s, body, closing);
  };
  std::vector<SpanPair> near;  // each body once
  for (const SpanPair& pair : pairs_of_interval(world, work)) {
    const auto is_same = [&pair](const SpanPair& other) { return other.body == pair.body; };
    if (pair.cable != cable || std::any_of(near.begin(), near.end(), is_same)) continue;
    near.push_back(pair);
    if (!work.neighbourhoods.separate_from_cable(pair.body, cable)) continue;
    if (test(segment, pair.body).found) work.neighbourhoods.crossed = true;
  }
  return meet_bodies(world, work, segment, near, test);
}

void add_hit_links(World& world, Workspace& work) {
  const int changes = world.changes;
  const auto& pairs = work.broad_phase.span_pairs;
  // From the last segment to the first: a link put in leaves the indices before it as they are.
  std::size_t end = pairs.size();
  while (end > 0) {
    std::size_t begin = end - 1;
    while (begin > 0 && pairs[begin - 1].cable == pairs[end - 1].cable &&
           pairs[begin - 1].segment == pairs[end - 1].segment) {
      --begin;
    }
    const CableState& cable = at(world.cables, pairs[begin].cable);
    meet_bodies(world, work, index(pairs[begin].segment),
                std::span(pairs).subspan(begin, end - begin),
                [&](std::size_t s, int body) { return test_span(world, work, cable, s, body); });
    end = begin;
  }
  if (world.changes == changes) return;
  for (const int c : world.strung) {
    if (!take_in_enclosed_nodes(world, at(world.cables, c))) continue;
    work.broad_phase.boxes.clear();  // for bodies with other outlines
  }
}

}  // namespace pinchlab
