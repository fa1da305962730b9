// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "demos/scenes/scene_problem.h"
#include "sim/scene.h"

namespace pinchlab {

/// A body of a scene file, at `place` in it, checked by check_format; what does not go together is noted.
Body read_body(const nlohmann::json& from, const std::string& place,
               std::vector<SceneProblem>& problems);

}  // namespace pinchlab
