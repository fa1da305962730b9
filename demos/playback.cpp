// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/playback.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "demos/scenes/scene_format.h"

namespace pinchlab {
namespace {

/// A window of slow motion in steps.
struct Window {
  std::int64_t from, to, stride;
};

std::int64_t frame_near(const Scene& scene, double time, const char* option) {
  const double duration = static_cast<double>(scene.frame_count) / scene.frames_per_second;
  if (!(0.0 <= time && time <= duration)) {
    throw std::invalid_argument(fmt::format("{}: {} must name times of 0 to {} s, not {}",
                                            scene.name, option, duration, time));
  }
  return std::llround(time * scene.frames_per_second);
}

std::vector<Window> windows_of(const Scene& scene, const std::vector<Slow>& slow) {
  std::vector<Window> windows;
  for (const Slow& s : slow) {
    const double steps = s.factor * scene.steps_per_frame;
    const std::int64_t stride = std::llround(steps);
    if (!(s.factor > 0.0 && s.factor <= 1.0) || stride < 1 ||
        std::abs(steps - static_cast<double>(stride)) > 1e-9) {
      throw std::invalid_argument(
          fmt::format("{}: --slow {} of {} steps a frame is no whole number of them; use a "
                      "multiple of {:g} up to 1, or more steps_per_frame in the scene",
                      scene.name, s.factor, scene.steps_per_frame, 1.0 / scene.steps_per_frame));
    }
    windows.push_back({frame_near(scene, s.from, "--slow") * scene.steps_per_frame,
                       frame_near(scene, s.to, "--slow") * scene.steps_per_frame, stride});
    if (windows.back().to <= windows.back().from) {
      throw std::invalid_argument(
          fmt::format("{}: --slow {}-{} ends before it begins", scene.name, s.from, s.to));
    }
  }
  std::ranges::sort(windows, {}, &Window::from);
  for (std::size_t i = 1; i < windows.size(); ++i) {
    if (windows[i].from < windows[i - 1].to) {
      throw std::invalid_argument(scene.name + ": two windows of --slow overlap");
    }
  }
  return windows;
}

}  // namespace

Slow slow_from(const std::string& text) {
  Slow slow;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf-%lf:%lf%c", &slow.from, &slow.to, &slow.factor, &rest) != 3) {
    throw std::invalid_argument(
        fmt::format("--slow: {} is not FROM-TO:FACTOR in seconds, such as 1.2-1.6:0.25", text));
  }
  return slow;
}

Freeze freeze_from(const std::string& text) {
  Freeze freeze;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf:%lf%c", &freeze.at, &freeze.seconds, &rest) != 2 ||
      !(freeze.seconds > 0.0 && freeze.seconds <= 60.0)) {
    throw std::invalid_argument(
        fmt::format("--freeze: {} is not TIME:SECONDS, such as 1.2:0.5, of 60 s at most", text));
  }
  return freeze;
}

std::vector<std::int64_t> steps_shown(const Scene& scene, const Playback& playback) {
  const std::vector<Window> windows = windows_of(scene, playback.slow);
  std::vector<std::pair<std::int64_t, std::int64_t>> stops;  // step, frames more
  for (const Freeze& freeze : playback.freeze) {
    const std::int64_t frame =
        std::min<std::int64_t>(frame_near(scene, freeze.at, "--freeze"), scene.frame_count - 1);
    stops.emplace_back(frame * scene.steps_per_frame,
                       std::llround(freeze.seconds * scene.frames_per_second));
  }
  std::vector<std::int64_t> shown;
  const std::int64_t end = std::int64_t{scene.frame_count} * scene.steps_per_frame;
  for (std::int64_t step = 0; step < end;) {
    shown.push_back(step);
    for (const auto& [at, frames] : stops) {
      if (at == step) shown.insert(shown.end(), static_cast<std::size_t>(frames), step);
    }
    const auto window = std::ranges::find_if(
        windows, [step](const Window& w) { return w.from <= step && step < w.to; });
    step = window == windows.end() ? step + scene.steps_per_frame
                                   : std::min(step + window->stride, window->to);
  }
  if (shown.size() > static_cast<std::size_t>(max_frame_count)) {
    throw std::invalid_argument(fmt::format("{}: {} frames are more than the {} that can be made",
                                            scene.name, shown.size(), max_frame_count));
  }
  return shown;
}

}  // namespace pinchlab
