// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "sim/world.h"

namespace pinchlab::testing {

/// Whether two links, segments, contacts have the same state to the last bit; a contact's place in
/// the list is state too.
inline bool same_link(const Link& p, const Link& q) {
  return p.body == q.body && p.orientation == q.orientation && p.corner == q.corner &&
         p.radius == q.radius && p.material == q.material && p.wrap == q.wrap &&
         p.pinch_middle == q.pinch_middle && p.slip == q.slip && p.slip_speed == q.slip_speed &&
         p.contact == q.contact;
}

inline bool same_segment(const Segment& p, const Segment& q) {
  return p.tail == q.tail && p.head == q.head && p.alpha == q.alpha && p.length == q.length &&
         p.rest_length == q.rest_length && p.tension == q.tension && p.slack == q.slack &&
         p.pinched == q.pinched && p.contact == q.contact && p.moved == q.moved;
}

inline bool same_contact(const Contact& p, const Contact& q) {
  return p.a == q.a && p.b == q.b && p.wall == q.wall && p.touch == q.touch && p.point == q.point &&
         p.gap == q.gap && p.target == q.target && p.pinch_points == q.pinch_points &&
         p.pinch_linked == q.pinch_linked && p.touching == q.touching && p.slip == q.slip &&
         p.normal_force == q.normal_force && p.tangent_force == q.tangent_force;
}

/// Whether two worlds of one scene are in the same state to the last bit.
inline bool same_state(const World& a, const World& b) {
  const auto equal = [](const auto& p, const auto& q, auto same) {
    return std::equal(p.begin(), p.end(), q.begin(), q.end(), same);
  };
  return a.step == b.step && a.position == b.position && a.angle == b.angle &&
         a.velocity == b.velocity && a.angular_velocity == b.angular_velocity &&
         a.still_steps == b.still_steps &&
         equal(a.cables, b.cables,
               [&](const CableState& p, const CableState& q) {
                 return p.turning == q.turning && equal(p.links, q.links, same_link) &&
                        equal(p.segments, q.segments, same_segment);
               }) &&
         equal(a.contacts, b.contacts, same_contact) &&
         a.diagnostics.total_solves == b.diagnostics.total_solves &&
         a.diagnostics.fallbacks == b.diagnostics.fallbacks;
}

}  // namespace pinchlab::testing
