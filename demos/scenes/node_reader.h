// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The nodes of cables with mass, which no scene file names.

#include <map>
#include <string>
#include <vector>

#include "demos/scenes/scene_content.h"
#include "demos/scenes/scene_problem.h"

namespace pinchlab {

/// Spreads the nodes of what has been read without a problem, as many as its steps can follow where
/// a cable leaves that open; they look like their cable. `body_names` are the file's. Adds to
/// `problems` what cannot be.
void read_nodes(SceneContent& to, const std::map<std::string, int>& body_names,
                std::vector<SceneProblem>& problems);

}  // namespace pinchlab
