// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/world.h"

namespace pinchlab {

/// Its bodies and walls alone, without cables and contacts.
World bodies_of_scene(const Scene& scene);

/// The start of a simulation. Throws SceneError (scene_error.h) where the geometry cannot exist,
/// std::invalid_argument where the configuration cannot.
World make_world(const Scene& scene, Configuration configuration);

}  // namespace pinchlab
