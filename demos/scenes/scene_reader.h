// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the JSON of a scene file means; its form has been checked before.

#include <nlohmann/json.hpp>
#include <vector>

#include "demos/scenes/scene_problem.h"
#include "render/picture/look.h"
#include "sim/scene.h"

namespace pinchlab {

struct SceneContent {
  Scene scene;  ///< without a name, which is the file's
  SceneLook look;
  double poster_time = 0.0;  ///< s
};

/// Reads JSON that has the form of scene_format(), and adds to `problems` what does not go
/// together: names, kinds, numbers. Where there is one, the content is not to be used.
SceneContent read_scene(const nlohmann::json& from, std::vector<SceneProblem>& problems);

}  // namespace pinchlab
