// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is drawn of drums that fill beside their rope.

#include <vector>

#include "render/picture/picture.h"
#include "sim/world.h"

namespace pinchlab {

/// The links of cable c that lie in layers, and for drums from which all has run off such as there
/// will be when they are wound again as at the start.
std::vector<Link> links_in_layers(const Scene& scene, const World& world, std::size_t c);

/// Appends the line along which the turns on a drum that fills touch one another, from the inside
/// out, where the cable turns on it by `sweep` (rad); nothing where there is none.
void append_seam(const World& world, const Link& link, double half_width, double sweep,
                 std::vector<StripPoint>& points);

}  // namespace pinchlab
