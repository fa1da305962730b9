// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The way of a cable of nodes.

#include <vector>

#include "render/picture/picture.h"
#include "sim/scene.h"
#include "sim/world.h"

namespace pinchlab {

/// Whether a node holds the link.
bool is_on_node(const Scene& scene, const Link& link);

/// Appends the centre line of a cable with mass from its first piece on, as the points of one strip
/// that bends at the nodes, those that have been taken into longer pieces too.
void append_chain_path(const Scene& scene, const World& world, std::size_t first_piece,
                       std::vector<StripPoint>& points);

}  // namespace pinchlab
