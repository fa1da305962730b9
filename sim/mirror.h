// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Mirror images in x = 0.

#include "sim/scene.h"

namespace pinchlab {

/// The scene's mirror image. It moves as the mirror image of the scene's motion, to the last bit
/// (test `Mirror`), but for polygons: as their corners must go counter-clockwise, they come in
/// another order, and their contacts with them.
Scene mirrored(Scene scene);

}  // namespace pinchlab
