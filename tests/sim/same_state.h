// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "sim/make_world.h"
#include "sim/step.h"

namespace pinchlab::testing {

// Links, segments and contacts that have the same state to the last bit; a contact's place in the
// list is state too.

inline bool same_layers(const Layers& p, const Layers& q) {
  return p.way == q.way && p.inner == q.inner && p.growth == q.growth && p.begins == q.begins;
}

inline bool same_laid(const Laid& p, const Laid& q) {
  return p.place == q.place && p.material == q.material && p.slope == q.slope &&
         p.moment == q.moment;
}

inline bool same_rim(const Rim& p, const Rim& q) {
  return std::equal(p.laid.begin(), p.laid.end(), q.laid.begin(), q.laid.end(), same_laid) &&
         p.comes_on_at_tail == q.comes_on_at_tail && p.comes_on_at_head == q.comes_on_at_head &&
         p.slope == q.slope;
}

inline bool same_finest(const FinestPiece& p, const FinestPiece& q) {
  return p.pieces == q.pieces && p.turned == q.turned && p.seat == q.seat && p.spare == q.spare &&
         p.held == q.held && p.let_out == q.let_out;
}

inline bool same_link(const Link& p, const Link& q) {
  return p.body == q.body && p.orientation == q.orientation && p.corner == q.corner &&
         p.radius == q.radius && p.offset == q.offset && p.material == q.material &&
         p.wrap == q.wrap && p.pinch_middle == q.pinch_middle && p.slip == q.slip &&
         p.slip_speed == q.slip_speed && p.contact == q.contact && p.moored == q.moored &&
         p.bent == q.bent && p.held == q.held && p.slid == q.slid &&
         same_layers(p.layers, q.layers);
}

inline bool same_segment(const Segment& p, const Segment& q) {
  return p.tail == q.tail && p.head == q.head && p.direction == q.direction && p.alpha == q.alpha &&
         p.length == q.length && p.rest_length == q.rest_length && p.tension == q.tension &&
         p.moved == q.moved && p.slack == q.slack && p.pinched == q.pinched &&
         p.was_pinched == q.was_pinched && p.contact == q.contact &&
         p.previous_tail == q.previous_tail && p.previous_head == q.previous_head &&
         p.tail_centre == q.tail_centre && p.head_centre == q.head_centre &&
         p.alpha_before == q.alpha_before && p.curvature == q.curvature;
}

inline bool same_contact(const Contact& p, const Contact& q) {
  return p.a == q.a && p.b == q.b && p.wall == q.wall && p.touch == q.touch && p.point == q.point &&
         p.piece == q.piece && p.away == q.away && p.normal == q.normal && p.gap == q.gap &&
         p.target == q.target && p.pinch_points == q.pinch_points &&
         p.cable_between == q.cable_between && p.pressed_friction == q.pressed_friction &&
         p.layers_cable == q.layers_cable && p.slipping_cable == q.slipping_cable &&
         p.slips_on == q.slips_on && p.slips_way == q.slips_way &&
         p.slips_corner == q.slips_corner && p.touching == q.touching && p.rebounds == q.rebounds &&
         p.struck == q.struck && p.slip == q.slip && p.normal_force == q.normal_force &&
         p.tangent_force == q.tangent_force && p.curvature == q.curvature;
}

/// Whether two worlds of one scene are in the same state to the last bit.
inline bool same_state(const World& a, const World& b) {
  const auto equal = [](const auto& p, const auto& q, auto same) {
    return std::equal(p.begin(), p.end(), q.begin(), q.end(), same);
  };
  const auto same_body = [](const BodyProperties& p, const BodyProperties& q) {
    return p.mass == q.mass && p.kind == q.kind && p.seat == q.seat;
  };
  return a.step == b.step && equal(a.bodies, b.bodies, same_body) &&
         a.step_length == b.step_length && a.pace == b.pace && a.position == b.position &&
         a.angle == b.angle && a.velocity == b.velocity &&
         a.angular_velocity == b.angular_velocity && a.still_steps == b.still_steps &&
         a.changes == b.changes && a.passing == b.passing &&
         a.passing_at_ends == b.passing_at_ends &&
         equal(a.pieces_at, b.pieces_at,
               [](const PiecesAtNode& p, const PiecesAtNode& q) {
                 return p.before == q.before && p.after == q.after;
               }) &&
         equal(a.cables, b.cables,
               [&](const CableState& p, const CableState& q) {
                 return p.length == q.length && p.turning == q.turning && p.changes == q.changes &&
                        p.pieces == q.pieces && p.turned == q.turned && p.held == q.held &&
                        p.let_out == q.let_out && equal(p.links, q.links, same_link) &&
                        equal(p.rims, q.rims, same_rim) && p.growth == q.growth &&
                        equal(p.finest, q.finest, same_finest) &&
                        equal(p.segments, q.segments, same_segment);
               }) &&
         equal(a.contacts, b.contacts, same_contact) &&
         a.diagnostics.total_solves == b.diagnostics.total_solves &&
         a.diagnostics.fallbacks == b.diagnostics.fallbacks &&
         a.diagnostics.events == b.diagnostics.events &&
         a.diagnostics.intervals == b.diagnostics.intervals &&
         a.diagnostics.node_changes == b.diagnostics.node_changes &&
         a.diagnostics.clusters == b.diagnostics.clusters;
}

/// Whether so many steps come to the same bits with a new workspace before each of them.
inline bool is_all_state(const Scene& scene, const Configuration& configuration, int steps) {
  World kept = make_world(scene, configuration), cleared = kept;
  Workspace work;
  for (int i = 0; i < steps; ++i) {
    Workspace fresh;
    if (step(scene, kept, work) != StepStatus::ok || step(scene, cleared, fresh) != StepStatus::ok)
      return false;
    if (!same_state(kept, cleared)) return false;
  }
  return true;
}

}  // namespace pinchlab::testing
