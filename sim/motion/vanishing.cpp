// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/vanishing.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/parts.h"

namespace pinchlab {

namespace {

constexpr double slow_share = 1e-6;  // of Delta^2: what turns by a milliradian in vanishing_time
// Of a step, which the touch itself would ask to be 0; at tau = 1e-6 T, where the span has a
// thousandth of its length.
constexpr double least_share = 1e-4;
constexpr double elastic_share = 0.5;  // of the time left of one that stretches, or is passed in
constexpr double most_swung = 0.5;     // rad, far less than what is not told from less than a turn

/// The time for which a span between two links has been there, or will be (s), where that is less
/// than `most`; else that.
double time_left(const World& world, const Segment& span, const Link& tail, const Link& head,
                 double most) {
  const double touch = tail.radius + head.radius;  // m, Delta where the cable crosses over
  if (tail.orientation * head.orientation > 0) return most;
  const Vec2 apart = span.head_centre - span.tail_centre;
  const bool opens = span.pinched && is_let_go(world, span, tail, head, apart.norm());
  if (!opens && (span.pinched || span.length == 0.0)) return most;
  const double parting = 2.0 * apart.dot(velocity_of(world, head) - velocity_of(world, tail));
  const double rate = opens ? parting : std::abs(parting);
  if (rate * vanishing_time < slow_share * touch * touch) return most;
  const double square =
      opens ? std::max(apart.squaredNorm() - touch * touch, 0.0) : span.length * span.length;
  return square < rate * most ? square / rate : most;
}

/// The time in which as much as is in a span slips over what is at either end of it or, where rims
/// creep, is taken or given by that (s), where that is less than `most`; else that.
double time_to_pass(const World& world, const CableState& cable, const Segment& span,
                    const Link& tail, const Link& head, double most) {
  const auto speed = [&](const Link& link) {
    const double slip = std::abs(link.slip_speed);
    if (cable.rims.empty() || link.body < 0) return slip;
    return slip + std::abs(link.signed_radius() * at(world.angular_velocity, link.body));
  };
  const double fastest = std::max(speed(tail), speed(head));
  return span.length < fastest * most ? span.length / fastest : most;
}

/// Calls f(span, tail, head) for each span of a cable.
template <class F>
void each_span(const CableState& cable, const F& f) {
  const Link* tail = cable.closed ? &cable.links.back() : &cable.links.front();
  const std::span spans(cable.segments);
  const std::span links(cable.links);
  for (std::size_t i = first_segment(cable); i < spans.size(); ++i) {
    const Link& head = links[i];
    f(spans[i], *tail, head);
    tail = &head;
  }
}

/// time_left of a cable's spans that do not stretch, and are short to the circles at their ends.
double time_left(const World& world, const CableState& cable, double most) {
  each_span(cable, [&](const Segment& span, const Link& tail, const Link& head) {
    if (span.slack || !is_short(span, tail, head)) return;
    most = time_left(world, span, tail, head, most);
  });
  return most;
}

/// The same of those that do, where rims creep also the time in which they are passed.
double time_left_of_elastic(const World& world, const CableState& cable, double most) {
  each_span(cable, [&](const Segment& span, const Link& tail, const Link& head) {
    most = time_left(world, span, tail, head, most);
    if (!span.pinched) most = time_to_pass(world, cable, span, tail, head, most);
  });
  return most;
}

/// The time in which a cable that slips round a polygon's corner turns a node that is moored there
/// as far as an interval may (s), where that is less than `most`; else that.
double time_to_swing(const CableState& cable, double most) {
  for (int i = 0; index(i) < cable.links.size(); ++i) {
    const Link& node = at(cable.links, i);
    if (!node.moored || node.corner < 0) continue;
    const Link& rim = at(cable.links, rim_of(cable, i));
    const double speed = std::abs(rim.slip_speed), way = most_swung * rim.radius;
    if (way < speed * most) most = way / speed;
  }
  return most;
}

/// Whether spans of a cable may vanish, or anything else of it may ask for shorter intervals.
bool may_ask(const CableState& cable) {
  return !cable.stands && (cable.short_span || cable.elastic || cable.nodes > 0);
}

/// longest_interval, where a cable may ask for less than a step.
double longest_asked_for(const World& world, const Parts& parts, std::span<const int> of) {
  const bool follows = world.step_length < vanishing_time;
  double left = vanishing_time, left_of_elastic = infinity, swing = infinity;
  for (const int p : of) {
    const Part& part = at(parts.list, p);
    if (!part.can_move) continue;
    for (const int c : cables_of(parts, part)) {
      const CableState& cable = at(world.cables, c);
      if (!may_ask(cable)) continue;
      if (part.has_sleeves && cable.nodes > 0) swing = time_to_swing(cable, swing);
      if (cable.elastic) {
        left_of_elastic = time_left_of_elastic(world, cable, left_of_elastic);
      } else if (follows) {
        left = time_left(world, cable, left);
      }
    }
  }
  double longest = std::min(elastic_share * left_of_elastic, swing);
  if (left < vanishing_time) {
    const double share = left / vanishing_time;
    longest = std::min(longest, world.step_length * std::cbrt(share * share));
  }
  return std::max(longest, least_share * world.step_length);
}

}  // namespace

double longest_interval(const World& world, const Parts& parts, std::span<const int> of) {
  for (const int p : of) {
    for (const int c : cables_of(parts, at(parts.list, p))) {
      if (may_ask(at(world.cables, c))) return longest_asked_for(world, parts, of);
    }
  }
  return infinity;
}

}  // namespace pinchlab
