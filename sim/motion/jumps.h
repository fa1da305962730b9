// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where forces jump though nothing meets. In the middle of an interval that is an error of the
// first order in its length (of velocity: as much as the jump does in it), at its end one of the
// second. So these are events:
//
//   EventKind::halts   what slides comes to rest, and friction turns round or holds; a motor with a
//                      limit has come to its speed
//   EventKind::turns   a motor's time table has a corner; a disc, or a rounded corner, comes on to
//                      a corner of what it lies on, or off it, where its way begins or ceases to
//                      bend; a sharp corner comes to one, or to a wall's end, and off its side
//   EventKind::lets_go what presses cable that cannot slip parts from it, and friction that has no
//                      bound, or the push of what was clamped, ends with a force that has come to 0
//
// Other friction that begins to slide does not jump, nor does what a motor gives as it comes to its
// limit.

#include "sim/parts.h"
#include "sim/solve/part_system.h"
#include "sim/world.h"

namespace pinchlab {

struct Happening;
struct Workspace;

/// Notes which contacts of a part slide as an interval begins (Start::contact_slip), and whether
/// any does, or may come to a corner. Of a part that cannot move none bears force.
void note_sliding(const World& world, Part& part, Workspace& work);

/// Whether a contact of a part may press cable that cannot slip.
inline bool holds_by_force(const Part& part, const PartSystem& s) {
  return part.can_move && (!s.frictions.empty() || !s.pressed.empty());
}

/// Whether anything of a part can jump at all.
inline bool may_jump(const Part& part, const PartSystem& s) {
  return may_come_to_rest(part) || part.slid || part.may_turn || !s.motors.empty() ||
         s.has_tables || holds_by_force(part, s);
}

/// What comes to rest or turns in a part's interval, which has just been tried with that `length`
/// (s), added to Workspace::events or measured anew.
void find_jumps(const Scene& scene, const World& world, Workspace& work, int part, double length);

/// What has come to rest, by such an event, does not slide when the next interval begins; a corner
/// that has come to a sharp one bears nothing.
void end_jump(World& world, const Happening& event);

}  // namespace pinchlab
