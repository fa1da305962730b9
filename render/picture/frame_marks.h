// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What goes with a frame and not with the scene in it. The frame's width is `aspect` times its
// height.

#include "render/picture/scenery.h"

namespace pinchlab {

/// A clip's time in the upper left corner of a frame: what hangs and what holds it mostly is at the
/// other three.
Label time_label(const Scenery& scenery, double time, double aspect);

/// A line along the left side of a frame of so many px, which parts it from another on its left: as
/// thin as the scene's lines, of which a whole pixel is seen.
Stroke divider(const Scenery& scenery, double width, double height);

}  // namespace pinchlab
