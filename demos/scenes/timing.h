// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A scene with another timing than its file's.

#include <optional>
#include <string>

#include "sim/scene.h"

namespace pinchlab {

/// What the command line may change about a scene's timing.
struct Timing {
  std::optional<int> frames_per_second;
  std::optional<int> steps_per_frame;
  std::optional<double> error{};  ///< m, of Scene::error
};

/// The scene with another timing and the same duration. With another frame rate alone, a frame gets
/// the fewest steps that make none longer than the scene's own. Cables keep their nodes, however
/// many these steps could follow. Once more it changes nothing. Throws std::invalid_argument, with
/// the cure, where the duration is not a whole number of frames or a value is out of range.
Scene with_timing(const Scene& scene, const Timing& timing);

/// As many nodes as the steps of its scene can follow has a cable that leaves their number open.
struct ChosenNodes {
  std::string cable;
  int nodes = 0;
};

}  // namespace pinchlab
