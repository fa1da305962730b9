// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a scene file says.

#include <vector>

#include "demos/scenes/timing.h"
#include "render/picture/look.h"
#include "sim/scene.h"

namespace pinchlab {

struct SceneContent {
  Scene scene;
  SceneLook look;
  double poster_time = 0.0;  ///< s
  std::vector<ChosenNodes> chosen_nodes;
};

}  // namespace pinchlab
