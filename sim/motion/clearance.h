// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/at.h"
#include "sim/solve/part_system.h"
#include "sim/world.h"

namespace pinchlab {

struct Start;

/// The gap above a contact's target at the present positions (m); below 0: too near.
double clearance_of(const World& world, const Contact& contact);

/// What is left of a row's condition at the present positions (m): slack of a segment, or the gap
/// above a contact's target; below 0: too long, or too near.
inline double clearance_of(const World& world, const Row& row) {
  if (row.kind == RowKind::normal || row.kind == RowKind::tangent) {
    return clearance_of(world, at(world.contacts, row.index));
  }
  const Segment& segment = at(at(world.cables, row.index).segments, row.item);
  return segment.rest_length - segment.length;
}

/// The same of one that was clear by `before` (m) when the interval began, at the first place on
/// the way from there at which it has been less than -`late`; `now`, its clearance at the present
/// positions, where there is none. What crosses another within one interval, or passes through its
/// edge, ends it clear of that again. Bodies move evenly along their ways, and between two of the
/// places that are tried by no more than half of what is thinnest; of discs the nearest place is
/// known. Moves bodies there and back.
double clearance_on_way(World& world, const Start& start, const Contact& contact, double before,
                        double now, double late);

/// Round-off of a body's place, which is nothing to put right (m).
double reach_at(const World& world, int body);

}  // namespace pinchlab
