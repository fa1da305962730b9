// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Values of a scene file that check_format has found to be of the right form.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "demos/scenes/scene_problem.h"
#include "sim/scene.h"

namespace pinchlab {

/// m: what is shorter is a slip of the pen, for no radius and no half width of the format is less
/// (scene.schema.json). So walls and rails are as fine as the smallest scene that it has.
constexpr double least_length = 1e-6;

inline Vec2 vector_of(const nlohmann::json& value) {
  return {value[0].get<double>(), value[1].get<double>()};
}

// Optional keys: what the file does not say keeps the default that the structure has.
inline void take(const nlohmann::json& from, const char* key, double& to) {
  if (from.contains(key)) {
    to = from[key].get<double>();
  }
}
inline void take(const nlohmann::json& from, const char* key, std::optional<double>& to) {
  if (from.contains(key)) {
    to = from[key].get<double>();
  }
}
inline void take(const nlohmann::json& from, const char* key, int& to) {
  if (from.contains(key)) {
    to = static_cast<int>(from[key].get<double>());  // 60.0 is a whole number too
  }
}
inline void take(const nlohmann::json& from, const char* key, Vec2& to) {
  if (from.contains(key)) {
    to = vector_of(from[key]);
  }
}

/// Notes each of these keys that is there: it would have no effect on `what` ("a fixed body").
void refuse_keys(const nlohmann::json& from, const std::string& place,
                 std::initializer_list<const char*> keys, const std::string& what,
                 std::vector<SceneProblem>& problems);

/// What says where an end of a cable or joint is.
enum class EndBy { world_m, body, neither };

/// Notes where both or neither do, and what belongs to `body` (these keys) beside `world_m`.
EndBy end_by(const nlohmann::json& end, const std::string& place,
             std::initializer_list<const char*> of_body, std::vector<SceneProblem>& problems);

}  // namespace pinchlab
