// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/creep.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"

namespace pinchlab {

namespace {

/// Where a segment of the direction alpha meets the link's rim (m along it, forward along the cable).
double place_on_rim(const World& world, const Link& link, double alpha) {
  return link.signed_radius() * (alpha - body_angle(world, link));
}

double slope_between(const Laid& a, const Laid& b) {
  return (b.material - a.material) / (b.place - a.place);
}

/// Keeps of the rim what lies between two places, which may be beyond what it has.
void keep_between(Link& link, double tail, double head) {
  const Laid first{tail, laid_material(link, tail)}, last{head, laid_material(link, head)};
  std::vector<Laid>& laid = link.laid;
  std::erase_if(laid, [&](const Laid& l) { return l.place <= tail || l.place >= head; });
  laid.insert(laid.begin(), first);
  if (head > tail) laid.push_back(last);
  // Pieces of one strain are one.
  constexpr double same = 1e-13;
  const auto joins = [&](std::size_t i) {
    return std::abs(slope_between(laid[i - 1], laid[i]) - slope_between(laid[i], laid[i + 1])) <
           same;
  };
  if (laid.size() > 2 && joins(laid.size() - 2)) laid.erase(laid.end() - 2);
  if (laid.size() > 2 && joins(1)) laid.erase(laid.begin() + 1);
}

/// Material that lies in a metre of the rim at its end towards a segment.
double slope_at_end(const Link& link, bool at_head) {
  const std::vector<Laid>& laid = link.laid;
  if (laid.size() < 2) return at_head ? link.comes_on_at_head : link.comes_on_at_tail;
  return at_head ? slope_between(laid[laid.size() - 2], laid.back())
                 : slope_between(laid[0], laid[1]);
}

/// Material in a metre of what comes off a segment on to a rim: its own strain's, or, through a pinch, that of
/// the rim beyond.
double slope_of(const CableState& cable, std::size_t i) {
  const Segment& segment = cable.segments[i];
  if (!segment.pinched) {
    const bool stretched = segment.length > segment.rest_length && segment.rest_length > 0.0;
    return stretched ? segment.rest_length / segment.length : 1.0;
  }
  const Link& from = at(cable.links, previous_link(cable, static_cast<int>(i)));
  const Link& to = cable.links[i];
  if (!from.laid.empty() && !from.pinch_middle) return slope_at_end(from, true);
  return to.laid.empty() ? 1.0 : slope_at_end(to, false);
}

}  // namespace

void begin_to_carry(const World& world, CableState& cable, std::size_t i) {
  Link& link = cable.links[i];
  if (!cable.creeps || link.orientation == 0 || link.corner >= 0 || link.layers.way != 0 ||
      at(world.bodies, link.body).cable_friction < infinity) {
    return;
  }
  const double tail = place_on_rim(world, link, cable.segments[i].alpha);
  const double head = place_on_rim(world, link, alpha_head(cable, i));
  link.laid = {{tail, tail}};
  if (head > tail) link.laid.push_back({head, head});
}

// The strain at the middle of the interval to come is extrapolated from those at its start and at the start of the
// one before, so that creep is of second order.
void lay_down(const World& world, CableState& cable) {
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    Link& link = cable.links[i];
    if (link.laid.empty()) continue;
    const double tail = place_on_rim(world, link, cable.segments[i].alpha);
    keep_between(link, tail, std::max(tail, place_on_rim(world, link, alpha_head(cable, i))));
  }
  for (std::size_t i = first_segment(cable); i < cable.segments.size(); ++i) {
    Segment& segment = cable.segments[i];
    const double now = slope_of(cable, i);
    const bool extrapolates = !segment.pinched && segment.slope > 0.0;
    const double soon =
        extrapolates ? std::clamp(1.5 * now - 0.5 * segment.slope, 0.5 * now, 1.0) : now;
    segment.slope = now;
    cable.links[i].comes_on_at_tail = soon;
    at(cable.links, previous_link(cable, static_cast<int>(i))).comes_on_at_head = soon;
  }
}

double creep_speed(const World& world, const Link& link, bool at_head) {
  if (link.laid.empty()) return 0.0;
  const double speed = link.signed_radius() * at(world.angular_velocity, link.body);
  const bool comes_on = at_head == (speed < 0.0);
  const double comes = at_head ? link.comes_on_at_head : link.comes_on_at_tail;
  return (1.0 - (comes_on ? comes : slope_at_end(link, at_head))) * speed;
}

double wrapped_material(const World& world, const CableState& cable, std::size_t i) {
  const Link& link = cable.links[i];
  if (link.laid.empty()) return stored_length(link);
  const double angle = body_angle(world, link);
  return head_material(cable, i, angle) - tail_material(cable, i, angle);
}

double energy_carried(const World& world, const CableState& cable, double stiffness) {
  double energy = 0.0;
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    if (cable.links[i].laid.empty()) continue;
    Link link = cable.links[i];
    const double tail = place_on_rim(world, link, cable.segments[i].alpha);
    keep_between(link, tail, std::max(tail, place_on_rim(world, link, alpha_head(cable, i))));
    for (std::size_t k = 1; k < link.laid.size(); ++k) {
      const double material = link.laid[k].material - link.laid[k - 1].material;
      const double stretch = link.laid[k].place - link.laid[k - 1].place - material;
      if (material > 0.0) energy += 0.5 * stiffness * stretch * stretch / material;
    }
  }
  return energy;
}

}  // namespace pinchlab
