// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where walls meet. A corner of a polygon that lies in the nook between two is beyond the ends of
// both by round-off, and would be beside neither: for what is in a nook both walls go on.

#include <vector>

#include "sim/box_tree.h"
#include "sim/outline.h"
#include "sim/world.h"

namespace pinchlab {

/// Puts obstacles into the tree: as far as their surfaces reach, and what meets them by round-off.
void find_extents(const std::vector<Obstacle>& obstacles, BoxTree& tree);

/// Finds which walls meet which at their ends, or with an end between the other's: Obstacle::nooks.
/// Ends meet what is nearer than a part in 1e9 of the two walls' lengths.
void join_walls(std::vector<Obstacle>& obstacles);

/// Whether the wall bars the way to a point (m) of a body about `centre`: it is beside the point;
/// or the point is beyond an end, and the way there from `centre` leads through the nook's walls.
bool is_beside(const Obstacle& wall, const Vec2& centre, const Vec2& point);

/// Whether the way from `centre` to a point on the other side of the wall's line leads past an end
/// of the wall that is free on the side of `centre`.
bool leads_round(const Obstacle& wall, const Vec2& centre, const Vec2& point);

/// Of a point from a wall's line, on the side of the body that the point belongs to; or on its own,
/// where the body is round an end of the wall.
Outside outside_of_line(const Obstacle& wall, const Vec2& centre, const Vec2& point);

/// Of one that the wall is not beside, from the nearer end.
Outside outside_of_end(const Obstacle& wall, const Vec2& point);

}  // namespace pinchlab
