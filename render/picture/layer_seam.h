// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where the turns of rope on a drum that fills touch.

#include <vector>

#include "render/picture/picture.h"
#include "sim/world.h"

namespace pinchlab {

/// Appends the line along which the turns on a drum that fills touch one another, from the inside
/// out, where the cable turns on it by `sweep` (rad); nothing where there is none.
void append_seam(const World& world, const Link& link, double half_width, double sweep,
                 std::vector<StripPoint>& points);

}  // namespace pinchlab
