// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A scene under one method, frame by frame: frame i is step i * steps_per_frame, frame 0 the start.

#include <filesystem>
#include <optional>
#include <string>

#include "demos/scene_json.h"

namespace pinchlab {

/// What the command line may change about a scene's timing.
struct Timing {
  std::optional<int> frames_per_second;
  std::optional<int> steps_per_frame;
};

/// The scene with another timing and the same duration. With another frame rate alone, a frame gets
/// the fewest steps that make none longer than the scene's own. Throws std::invalid_argument, with
/// the cure, where the duration is not a whole number of frames or a value is out of range.
Scene with_timing(const Scene& scene, const Timing& timing);

/// What is told of a world that became not finite on the way to `frame` of the scene from `path`:
/// where and when, and the command that shows it again.
std::string failure_report(const std::filesystem::path& path, const Scene& scene,
                           const World& world, int frame);

/// What people call a way of simulating: "pinch joints", "cable joints".
const char* in_words(const Configuration& configuration);

class Player {
 public:
  /// `file` must outlive the player. Throws SceneFileError where the geometry cannot exist.
  Player(const SceneFile& file, const Scene& scene, const Configuration& configuration);

  /// Steps on to `frame`, which must not lie before the present one. Throws std::runtime_error with
  /// a failure_report if a value is not finite.
  void advance_to(int frame);

  int frame() const { return frame_; }
  /// s; the frame's number over the frame rate, free of the round-off of summing steps.
  double time() const { return static_cast<double>(frame_) / scene_.frames_per_second; }
  const Scene& scene() const { return scene_; }
  const World& world() const { return world_; }

 private:
  const SceneFile& file_;
  Scene scene_;
  World world_;
  int frame_ = 0;
};

}  // namespace pinchlab
