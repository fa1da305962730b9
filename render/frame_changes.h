// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which part of a frame differs from the frame before: much of a clip stands still.

#include <vector>

#include "render/mesh.h"
#include "render/pixel_rect.h"

namespace pinchlab {

/// Rectangles (px, of a frame of this size, sides even where the frame's are) that hold every pixel
/// in which drawings of the two meshes differ. None if nothing does; the whole frame if the meshes
/// have not the same shapes. Each rectangle costs the caller as much as `cost` px do; where that is
/// nothing they are runs of tiles.
std::vector<PixelRect> frame_changes(const Mesh& before, const Mesh& now, int width, int height,
                                     int cost);

/// The part of a frame of this size in which a quad (its first corner is given) may be seen, px.
PixelRect quad_bounds(const Vertex* quad, int width, int height);

}  // namespace pinchlab
