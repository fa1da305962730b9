// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "demos/scenes/scene_problem.h"
#include "sim/scene.h"

namespace pinchlab {

/// A disc's radius, or a polygon's corners; false, and a problem noted, where there is not one of
/// them. What a polygon has besides (make_polygon) is for the caller.
bool read_outline(const nlohmann::json& from, const std::string& place, BodyProperties& to,
                  std::vector<SceneProblem>& problems);

/// Frictions and restitution.
void read_surface(const nlohmann::json& from, BodyProperties& to);

/// Notes a mass (kg) that `density_kg_m2` gives and `mass_kg` could not.
void check_mass_of_density(const nlohmann::json& from, const std::string& place, double mass,
                           std::vector<SceneProblem>& problems);

/// A body of a scene file, at `place` in it, checked by check_format; what does not go together is
/// noted.
Body read_body(const nlohmann::json& from, const std::string& place,
               std::vector<SceneProblem>& problems);

}  // namespace pinchlab
