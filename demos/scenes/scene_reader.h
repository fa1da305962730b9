// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the JSON of a scene file means; its form has been checked before.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "demos/scenes/scene_content.h"
#include "demos/scenes/scene_problem.h"
#include "demos/scenes/timing.h"

namespace pinchlab {

/// Reads JSON that has the form of scene_format(), and adds to `problems` what does not go
/// together: names, kinds, numbers. Where there is one, the content is not to be used. The scene
/// gets that name and timing; throws as with_timing.
SceneContent read_scene(const nlohmann::json& from, const std::string& name, const Timing& timing,
                        std::vector<SceneProblem>& problems);

}  // namespace pinchlab
