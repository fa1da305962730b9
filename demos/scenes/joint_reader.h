// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The joints of a scene file, of the right form: sim/joints.h.

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "demos/scenes/scene_problem.h"
#include "render/picture/look.h"
#include "sim/scene.h"

namespace pinchlab {

/// The index of the body of that name, which stands at `place`; 0 and a problem noted if there is
/// none.
using BodyIndex = std::function<int(const nlohmann::json& name, const std::string& place)>;

/// Adds joints, and stops of bodies that have a travel, to the scene, which has all of its bodies
/// and cables, and to its looks. `origins` are the file's frames of its bodies, as read_shapes
/// returns them.
void read_joints(const nlohmann::json& file, Scene& scene, SceneLook& look,
                 const BodyIndex& body_index, std::span<const Vec2> origins,
                 std::vector<SceneProblem>& problems);

}  // namespace pinchlab
