// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is drawn of drums that fill beside their rope.

#include <vector>

#include "render/picture/look.h"
#include "render/picture/picture.h"
#include "sim/world.h"

namespace pinchlab {

/// A link of a drum that fills, and how far (rad) its drum's riser is drawn.
struct LayeredLink {
  Link link;
  double riser = 0.0;
};

/// The links of cable c that lie in layers, as they are wound at the start: of drums from which all
/// has run off such as there will be again. Behind one that is wound the other way stands that,
/// whose riser goes as far as the cable that lies on it.
std::vector<LayeredLink> links_in_layers(const Scene& scene, const World& world, std::size_t c);

/// Appends the riser of a drum that fills: the wedge on its rim, as high as the cable is wide where
/// a turn is full, by which the first turn climbs on to itself. `rim`: m, how wide the body's
/// outline is. The fill is to be opaque.
void append_riser(const World& world, const LayeredLink& layered, double half_width, double rim,
                  const Paint& paint, Picture& picture);

/// Appends the line along which the turns on a drum that fills touch one another, from the inside
/// out, where the cable turns on it by `sweep` (rad); nothing where there is none.
void append_seam(const World& world, const Link& link, double half_width, double sweep,
                 std::vector<StripPoint>& points);

}  // namespace pinchlab
