// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "demos/scenes/scene_format.h"
#include "demos/scenes/scene_problem.h"
#include "render/picture/picture.h"

namespace pinchlab {

/// Checks `value` against `format`, all the way down, and appends every mistake of form to
/// `problems`. `place` is the JSON pointer of `value`.
void check_format(const nlohmann::json& value, const ObjectFormat& format, const std::string& place,
                  std::vector<SceneProblem>& problems);

/// "#rrggbb" or "#rrggbbaa", or nothing if the text is neither.
std::optional<Colour> colour_from(const std::string& text);

}  // namespace pinchlab
