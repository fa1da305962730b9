// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/at.h"
#include "sim/solve/part_system.h"
#include "sim/world.h"

namespace pinchlab {

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

/// Round-off of a body's place, which is nothing to put right (m).
double reach_at(const World& world, int body);

}  // namespace pinchlab
