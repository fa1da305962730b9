// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "demos/scenes/scene_problem.h"
#include "sim/scene.h"

namespace pinchlab {

/// The shapes of a scene file's compounds, checked by check_format: bodies of the scene after all
/// of the file's, which it has in their order. A compound is moved to its centre of mass. What does
/// not go together is noted.
///
/// Returns where the origin of the frame that the file gives points of a body in lies in the body's
/// own (m), for each body of the file: 0 but for compounds.
std::vector<Vec2> read_shapes(const nlohmann::json& bodies, Scene& scene,
                              std::vector<SceneProblem>& problems);

/// Where an end at a point of a compound (m, in its frame) is on the shape that it is deepest in,
/// or nearest to.
Attachment attached_to_shape(const Scene& scene, int compound, const Vec2& point);

}  // namespace pinchlab
