// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Random scenes that nobody has looked at before.

#include <cstdint>

#include "sim/scene.h"

namespace pinchlab::experiments {

/// One to six free discs, of masses up to 1e4 apart, that fall on one to four cables over two to
/// five pulleys: taut or slack, with weights or fixed ends, or closed round two pulleys; slipping
/// or not, restitution from 0 to 1, drag and drive in some. The same for the same seed everywhere.
Scene dropped_discs(std::uint64_t seed);

/// One to three boxes, polygons (sharp or rounded) and discs, of masses up to 10 apart, that are
/// thrown along a table, a wall or a block that lies on the floor or is fixed above it, and over
/// its edge. Rough or smooth, restitution from 0 to 1. The same for the same seed everywhere.
Scene thrown_off_a_table(std::uint64_t seed);

/// What such a scene may have that `dropped_discs` has not.
struct Shapely {
  bool polygons = false, compounds = false;  // among what falls and what cables run over
  bool ropes = false;                        // cables with mass over bodies
  bool chains = false;                       // cables with mass that hang: made of nodes
};

struct ShapelyScene {
  Scene scene;
  Shapely has;
  std::size_t bodies = 0;  // without nodes, which come after them
};

/// One to four discs, convex polygons (sharp or rounded) and compounds of two to four shapes, of
/// masses up to 1e2 apart, that fall on a cable over two to four discs and polygons with axles or
/// fixed: massless, taut or slack, or a rope with mass that weights pull taut; and on a chain that
/// hangs below it, or on none. Slipping or not, restitution from 0 to 1; nothing drives. The same
/// for the same seed everywhere.
ShapelyScene dropped_shapes(std::uint64_t seed);

/// The same where the cable that they fall on stretches, its stiffness 1e3 to 1e5 N: under what
/// falls by up to half of its length.
ShapelyScene stretched_shapes(std::uint64_t seed);

/// The same as the first on a rope with mass and five to thirty-four nodes, taut or slack, that
/// hangs between the bodies that it runs over. For even seeds the number of nodes adapts (2 mm).
ShapelyScene shapes_on_hanging_rope(std::uint64_t seed);

}  // namespace pinchlab::experiments
