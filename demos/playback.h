// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Slow motion and frozen frames: which step of the simulation each frame of a clip shows. No frame
// is blended from others.

#include <cstdint>
#include <string>
#include <vector>

#include "sim/scene.h"

namespace pinchlab {

struct Slow {
  double from = 0.0, to = 0.0;  ///< s of the simulation
  double factor = 1.0;          ///< 0..1: seconds of the simulation in a second of the clip
};

struct Freeze {
  double at = 0.0;       ///< s of the simulation
  double seconds = 0.0;  ///< s of the clip for which it stands, more than the frame itself
};

struct Playback {
  std::vector<Slow> slow;
  std::vector<Freeze> freeze;
  bool is_plain() const { return slow.empty() && freeze.empty(); }
};

/// "1.2-1.6:0.25" and "1.2:0.5". Throws std::invalid_argument with the form that is expected.
Slow slow_from(const std::string& text);
Freeze freeze_from(const std::string& text);

/// The step that each frame shows, in order. Windows begin and end at the scene's own frames.
/// Throws std::invalid_argument, with the cure, where a factor does not give a whole number of
/// steps a frame, windows overlap, or a time lies outside of the scene.
std::vector<std::int64_t> steps_shown(const Scene& scene, const Playback& playback);

}  // namespace pinchlab
