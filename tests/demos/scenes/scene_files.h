// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "demos/scenes/scene_json.h"

namespace pinchlab {

/// A small good scene: a weight on a rail hangs from a fixed wheel's cable; two seconds at 30
/// frames/s.
inline nlohmann::json small_scene() {
  return nlohmann::json::parse(R"({
    "title": "Weight and wheel",
    "gravity_m_s2": [0, -9.81],
    "bodies": [
      {"name": "wheel", "kind": "fixed_axle", "radius_m": 0.5, "mass_kg": 2, "position_m": [0, 0]},
      {"name": "left weight", "kind": "free", "radius_m": 0.2, "mass_kg": 1, "position_m": [-0.55, -2]},
      {"name": "right weight", "kind": "rail", "rail_axis": [0, 1], "radius_m": 0.2, "mass_kg": 1.2,
       "position_m": [0.55, -2]}
    ],
    "cables": [
      {"name": "rope", "half_width_m": 0.05, "start": {"body": "left weight"},
       "wraps": [{"body": "wheel", "turn": "clockwise"}],
       "end": {"body": "right weight", "point_m": [0, 0.1]}}
    ],
    "walls": [{"from_m": [-3, -4], "to_m": [3, -4]}],
    "duration_s": 2,
    "frames_per_second": 30,
    "steps_per_frame": 4,
    "view": {"low_m": [-2.5, -4.2], "high_m": [2.5, 0.8]},
    "baseline": {"method": "cable", "reason": "It runs well without pinch joints."}
  })");
}

/// What the reader says of a scene, as of a file `s.json`; or "no error".
inline std::string error_of(const std::string& text) {
  try {
    parse_scene(text, "s.json");
  } catch (const SceneFileError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace pinchlab
