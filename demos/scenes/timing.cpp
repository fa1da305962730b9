// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/timing.h"

#include <fmt/format.h>

#include <cstdint>
#include <stdexcept>

#include "demos/scenes/scene_format.h"

namespace pinchlab {
namespace {

void check_range(const char* what, int value, int high) {
  if (value < 1 || value > high) {
    throw std::invalid_argument(fmt::format("{} must be 1 to {}, not {}", what, high, value));
  }
}

}  // namespace

Scene with_timing(const Scene& scene, const Timing& timing) {
  Scene changed = scene;
  if (timing.frames_per_second) {
    const int rate = *timing.frames_per_second;
    check_range("frames per second", rate, 1000);
    const auto frames = static_cast<std::int64_t>(scene.frame_count) * rate;
    if (frames % scene.frames_per_second != 0) {
      throw std::invalid_argument(fmt::format(
          "{}: its {} s are not a whole number of frames at {} a second; its own rate is {}",
          scene.name, static_cast<double>(scene.frame_count) / scene.frames_per_second, rate,
          scene.frames_per_second));
    }
    const std::int64_t count = frames / scene.frames_per_second;
    if (count > max_frame_count) {
      throw std::invalid_argument(fmt::format("{}: {} frames are more than the {} that can be made",
                                              scene.name, count, max_frame_count));
    }
    changed.frame_count = static_cast<int>(count);
    changed.frames_per_second = rate;
    changed.steps_per_frame = (scene.frames_per_second * scene.steps_per_frame + rate - 1) / rate;
  }
  if (timing.steps_per_frame) {
    check_range("steps per frame", *timing.steps_per_frame, 1'000'000);
    changed.steps_per_frame = *timing.steps_per_frame;
  }
  if (timing.error) changed.error = *timing.error;
  return changed;
}

}  // namespace pinchlab
