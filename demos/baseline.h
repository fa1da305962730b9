// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which baseline is fair for a scene: plain cable joints where they work, pinch joints without
// contact where they break.

#include <optional>
#include <string>
#include <vector>

#include "demos/scenes/scene_json.h"

namespace pinchlab {

/// What a method does in a scene.
struct MethodFigures {
  Method method = Method::pinch;
  /// m: mean over the frames of the largest third difference of a body's positions. Jitter makes it
  /// large; bodies that touch a wall are left out, for a knock is as rough with any method.
  double roughness = 0.0;
  double largest_distance = 0.0;      ///< m, of a body from where pinch joints have it
  double largest_turn = 0.0;          ///< rad, likewise
  std::vector<std::string> problems;  ///< promises broken (sim/promises.h), or why it ended early
};

struct BaselineAdvice {
  MethodFigures pinch, no_contact, cable;
  double changed_by_half_steps = 0.0;  ///< m, of plain joints, where the scene has an error_m
  Method recommended = Method::cable;
  std::string reason;  ///< fit for the scene's own `baseline`
};

/// Plain joints are taken where they break nothing that pinch joints without contact keep, not even
/// the scene's error_m, and move at most this many times as roughly.
constexpr double fair_roughness = 1.2;

/// Plays the scene with all three methods, and tells on standard error how far it is. Throws
/// SceneFileError where the geometry cannot exist, GivenUp where one simulation takes longer than
/// `time_limit` (s).
BaselineAdvice advise_baseline(const SceneFile& file, std::optional<double> time_limit = {});

/// A table, the recommendation, and the lines to put into the scene.
std::string text(const SceneFile& file, const BaselineAdvice& advice);

}  // namespace pinchlab
