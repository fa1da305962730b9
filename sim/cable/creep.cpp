// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/creep.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/partial_slip.h"
#include "sim/cable/relax.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// Where a segment of the direction alpha meets the link's rim (m along it, forward along the
/// cable).
double place_on_rim(const World& world, const CableState& cable, std::size_t i, double alpha) {
  const Link& link = cable.links[i];
  return link.signed_radius() * (alpha - body_angle(world, link)) + origin_of_rim(cable, i);
}

/// What comes on of one strain is one piece, but for round-off.
constexpr double same_slope = 1e-13;

/// The piece on which a place lies that is neither before the first nor after the last.
const Laid& piece_at(const Rim& rim, double place) {
  return *(std::upper_bound(rim.laid.begin(), rim.laid.end(), place,
                            [](double value, const Laid& laid) { return value < laid.place; }) -
           1);
}

/// Integral of e over a piece of the rim (m).
Vec2 moment_of_piece(double p, double from, double to) {
  return p * (left(direction_at(from / p)) - left(direction_at(to / p)));
}

/// Of what lies on a rim up to a place, from which on it has that slope. Moments are of cables with
/// mass, and p that of their circle; else it is 0.
Laid laid_at(const Rim& rim, double p, double place, double slope) {
  return {place, laid_material(rim, place), slope,
          p != 0.0 ? laid_moment(rim, p, place) : Vec2::Zero()};
}

/// Moves the end at the head to a place beyond it, or back.
void move_head(Rim& rim, double p, double place) {
  std::vector<Laid>& laid = rim.laid;
  const Laid end = laid_at(rim, p, place, 1.0);
  while (laid.size() > 1 && laid[laid.size() - 2].place >= place) laid.pop_back();
  const bool extends = place > laid.back().place;
  if (extends && (laid.size() == 1 ||
                  std::abs(laid[laid.size() - 2].slope - rim.comes_on_at_head) > same_slope)) {
    laid.back().slope = rim.comes_on_at_head;
    laid.push_back(end);
  } else {
    laid.back() = end;
  }
}

/// The same at the tail.
void move_tail(Rim& rim, double p, double place) {
  std::vector<Laid>& laid = rim.laid;
  Laid end = laid_at(rim, p, place, rim.comes_on_at_tail);
  const auto kept =
      std::find_if(laid.begin(), laid.end(), [place](const Laid& l) { return l.place > place; });
  if (kept == laid.end()) {
    laid.assign(1, end);
  } else if (kept != laid.begin()) {
    end.slope = (kept - 1)->slope;
    *laid.erase(laid.begin(), kept - 1) = end;
  } else if (laid.size() > 1 && std::abs(laid.front().slope - end.slope) <= same_slope) {
    end.slope = laid.front().slope;
    laid.front() = end;
  } else {
    laid.insert(laid.begin(), end);
  }
}

/// Ends what the rim carries where the cable leaves it. So little that tensions cannot tell waits
/// for more to come.
void keep(const CableState& cable, const Link& link, const RimSpan& span, Rim& rim) {
  const double rounding = 1e-10 * link.radius;
  const double p = cable.density > 0.0 ? link.signed_radius() : 0.0;
  if (std::abs(span.head - rim.laid.back().place) > rounding) move_head(rim, p, span.head);
  if (std::abs(span.tail - rim.laid.front().place) > rounding) move_tail(rim, p, span.tail);
}

/// Material that lies in a metre of the rim at its end towards a segment. On one that is hardly
/// touched that is what comes on to it at its other end.
double slope_at_end(const Rim& rim, bool at_head) {
  const std::vector<Laid>& laid = rim.laid;
  if (laid.size() < 2) return at_head ? rim.comes_on_at_tail : rim.comes_on_at_head;
  return at_head ? laid[laid.size() - 2].slope : laid[0].slope;
}

/// Material in a metre of a span.
double slope_of(const Segment& span) {
  const bool stretched = span.length > span.rest_length && span.rest_length > 0.0;
  return stretched ? span.rest_length / span.length : 1.0;
}

/// Material in a metre of what a link gives to a pinch beside it.
double slope_through_pinch(const CableState& cable, int link, bool at_head) {
  const Rim& rim = at(cable.rims, link);
  const bool turns = rim.laid.empty() && !at(cable.links, link).pinch_middle;
  return turns ? 1.0 : slope_at_end(rim, at_head);
}

/// rad/s of a segment's direction.
double turning_of(const World& world, const Segment& segment, const Link& from, const Link& to) {
  const Vec2 d = velocity_of(world, to) - velocity_of(world, from);
  const double apart = to.signed_radius() - from.signed_radius();
  if (segment.pinched) return apart != 0.0 ? -segment.direction.dot(d) / apart : 0.0;
  return segment.length > 0.0 ? cross(segment.direction, d) / segment.length : 0.0;
}

/// m/s, by which a link's rim takes less of a segment's material than it turns by against it, or
/// gives it less; forward positive.
double creep_at(const World& world, const Link& link, const Rim& rim, bool at_head,
                double turning) {
  if (rim.laid.empty()) return 0.0;
  const double slides = rim.slides ? link.slip_speed : 0.0;
  const double speed =
      link.signed_radius() * (at(world.angular_velocity, link.body) - turning) + slides;
  const double soon = at_head ? rim.comes_on_at_head : rim.comes_on_at_tail;
  const Laying laying = laying_at(rim, at_head, soon);
  const bool takes = at_head == (speed < 0.0);
  return (1.0 - (takes ? laying.takes : laying.gives)) * speed;
}

}  // namespace

RimSpan span_on_rim(const World& world, const CableState& cable, std::size_t i) {
  const double tail = place_on_rim(world, cable, i, cable.segments[i].alpha);
  return {tail, std::max(tail, place_on_rim(world, cable, i, alpha_head(cable, i)))};
}

Laying laying_at(const Rim& rim, bool at_head, double taken) {
  if (rim.laid.empty()) return {};
  return {taken, slope_at_end(rim, at_head), true};
}

void shift_material(CableState& cable, int number, double by) {
  if (!cable.rims.empty() && at(cable.rims, number).slides) {
    for (Laid& laid : at(cable.rims, number).laid) laid.material += by;
  } else {
    at(cable.links, number).material += by;
  }
}

double laid_material(const Rim& rim, double place) {
  const Laid &first = rim.laid.front(), &last = rim.laid.back();
  if (place <= first.place) return first.material + (place - first.place) * rim.comes_on_at_tail;
  if (place >= last.place) return last.material + (place - last.place) * rim.comes_on_at_head;
  const Laid& piece = piece_at(rim, place);
  return piece.material + (place - piece.place) * piece.slope;
}

Vec2 laid_moment(const Rim& rim, double p, double place) {
  const Laid &first = rim.laid.front(), &last = rim.laid.back();
  const auto from = [p, place](const Laid& laid, double slope) -> Vec2 {
    return laid.moment + slope * moment_of_piece(p, laid.place, place);
  };
  if (place <= first.place) return from(first, rim.comes_on_at_tail);
  if (place >= last.place) return from(last, rim.comes_on_at_head);
  const Laid& piece = piece_at(rim, place);
  return from(piece, piece.slope);
}

void sum_moments(CableState& cable, std::size_t i) {
  if (cable.density == 0.0) return;
  const double p = cable.links[i].signed_radius();
  std::vector<Laid>& laid = cable.rims[i].laid;
  for (std::size_t k = 1; k < laid.size(); ++k) {
    const Laid& before = laid[k - 1];
    laid[k].moment = before.moment + before.slope * moment_of_piece(p, before.place, laid[k].place);
  }
}

double place_of_laid(const Rim& rim, double material) {
  const Laid &first = rim.laid.front(), &last = rim.laid.back();
  if (material <= first.material) {
    return first.place + (material - first.material) / rim.comes_on_at_tail;
  }
  if (material >= last.material) {
    return last.place + (material - last.material) / rim.comes_on_at_head;
  }
  const auto after =
      std::upper_bound(rim.laid.begin(), rim.laid.end(), material,
                       [](double value, const Laid& laid) { return value < laid.material; });
  const Laid& piece = *(after - 1);
  return piece.place + (material - piece.material) / piece.slope;
}

bool may_carry(const World& world, const CableState& cable, std::size_t i) {
  const Link& link = cable.links[i];
  if (!cable.creeps || link.orientation == 0 || link.layers.way != 0) return false;
  return !slides_with_mass(world, cable, link) || !is_smooth(world, link);
}

void begin_to_carry(const World& world, CableState& cable, std::size_t i, double slope) {
  if (!may_carry(world, cable, i)) return;
  if (cable.rims.empty()) cable.rims.resize(cable.links.size());
  cable.rims[i].slides = slides_with_mass(world, cable, cable.links[i]);
  const RimSpan span = span_on_rim(world, cable, i);
  std::vector<Laid>& laid = cable.rims[i].laid;
  laid.assign(1, {span.tail, span.tail, slope});
  if (span.head > span.tail) {
    laid.push_back({span.head, span.tail + (span.head - span.tail) * slope, slope});
  }
  sum_moments(cable, i);
}

// The strain at the middle of the interval to come is extrapolated from those at its start and at
// the start of the one before, so that creep is of second order.
void lay_down(const World& world, CableState& cable, double time) {
  if (cable.rims.empty()) return;
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    Rim& rim = cable.rims[i];
    if (!rim.laid.empty()) keep(cable, cable.links[i], span_on_rim(world, cable, i), rim);
  }
  if (slides_somewhere(world, cable)) {
    if (cable.density == 0.0) relax_rims(world, cable, time);
    slide_in_part(world, cable);
  }
  const int first = static_cast<int>(first_segment(cable));
  const int count = static_cast<int>(cable.segments.size());
  for (int i = first; i < count; ++i) {
    const int before = previous_link(cable, i);
    Rim& rim = at(cable.rims, i);
    if (at(cable.segments, i).pinched) {
      rim.slope = rim.comes_on_at_tail = slope_through_pinch(cable, before, true);
      continue;
    }
    const double now = slope_of(at(cable.segments, i));
    const double soon =
        rim.slope > 0.0 ? std::clamp(1.5 * now - 0.5 * rim.slope, 0.5 * now, 1.0) : now;
    rim.slope = now;
    rim.comes_on_at_tail = at(cable.rims, before).comes_on_at_head = soon;
  }
  for (int i = count - 1; i >= first; --i) {
    if (!at(cable.segments, i).pinched) continue;
    at(cable.rims, previous_link(cable, i)).comes_on_at_head = slope_through_pinch(cable, i, false);
  }
}

double creep_speed(const World& world, const CableState& cable, int segment) {
  const int before = previous_link(cable, segment);
  const Link &from = at(cable.links, before), &to = at(cable.links, segment);
  const double turning = turning_of(world, at(cable.segments, segment), from, to);
  return creep_at(world, from, at(cable.rims, before), true, turning) -
         creep_at(world, to, at(cable.rims, segment), false, turning);
}

double wrapped_material(const World& world, const CableState& cable, std::size_t i) {
  if (cable.rims.empty() || cable.rims[i].laid.empty()) return stored_length(cable.links[i]);
  const double angle = body_angle(world, cable.links[i]);
  return head_material(cable, i, angle) - tail_material(cable, i, angle);
}

void lay_on_rim(const World& world, CableState& cable, int link, std::span<const double> stretch,
                double later) {
  const double angle = body_angle(world, at(cable.links, link));
  const double before = tail_material(cable, index(link), angle);
  const RimSpan on = span_on_rim(world, cable, index(link));
  const double width = (on.head - on.tail) / static_cast<double>(stretch.size());
  std::vector<Laid>& laid = at(cable.rims, link).laid;
  laid.assign(1, {on.tail, on.tail, 1.0 - stretch[0]});
  if (width > 0.0) {
    for (std::size_t k = 0; k < stretch.size(); ++k) {
      const double slope = 1.0 - stretch[k], place = on.tail + static_cast<double>(k + 1) * width;
      laid.back().slope = slope;
      laid.push_back({place, laid.back().material + width * slope, slope});
    }
  }
  sum_moments(cable, index(link));
  shift_material(cable, link, before + later - tail_material(cable, index(link), angle));
}

double energy_carried(const World& world, const CableState& cable, double stiffness) {
  double energy = 0.0;
  for (std::size_t i = 0; i < cable.rims.size(); ++i) {
    if (cable.rims[i].laid.empty()) continue;
    each_piece(world, cable, i, [&](double from, double to, double slope) {
      if (slope > 0.0)
        energy += 0.5 * stiffness * (to - from) * (1.0 - slope) * (1.0 - slope) / slope;
    });
  }
  return energy;
}

}  // namespace pinchlab
