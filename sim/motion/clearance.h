// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/solve/part_system.h"
#include "sim/world.h"

namespace pinchlab {

/// What is left of a row's condition at the present positions (m): slack of a segment, or the gap
/// above a contact's target; below 0: too long, or too near.
double clearance_of(const Scene& scene, const World& world, const Row& row);

/// Round-off of a body's place, which is nothing to put right (m).
double reach_at(const World& world, int body);

}  // namespace pinchlab
