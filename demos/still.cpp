// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/still.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "demos/player.h"
#include "render/canvas.h"
#include "render/compose.h"
#include "render/png.h"

namespace pinchlab {
namespace {

std::vector<int> frames_at(const Scene& scene, const std::vector<double>& times) {
  const double duration = static_cast<double>(scene.frame_count) / scene.frames_per_second;
  std::vector<int> frames;
  for (const double time : times) {
    if (!(0.0 <= time && time <= duration)) {
      throw std::invalid_argument(
          fmt::format("{}: --time must be 0 to {} s, not {}", scene.name, duration, time));
    }
    frames.push_back(static_cast<int>(std::lround(time * scene.frames_per_second)));
  }
  return frames;
}

// The frames asked for, in the order asked for, though the simulation only runs forward.
std::vector<SheetFrame> draw_frames(const SceneFile& file, const Configuration& method,
                                    const std::vector<int>& frames, Canvas& canvas) {
  std::vector<std::size_t> by_time(frames.size());
  std::iota(by_time.begin(), by_time.end(), 0U);
  std::ranges::stable_sort(by_time, {}, [&](std::size_t i) { return frames[i]; });
  const std::size_t bytes =
      4 * static_cast<std::size_t>(canvas.width()) * static_cast<std::size_t>(canvas.height());
  std::vector<SheetFrame> drawn(frames.size());
  Player player(file, file.scene, method);
  Picture picture;
  for (const std::size_t i : by_time) {
    player.advance_to(frames[i]);
    compose(player.scene(), player.world(), picture);
    const std::uint8_t* rgba = canvas.draw(picture);
    drawn[i] = {{rgba, rgba + bytes}, fmt::format("{}, {:.2f} s", in_words(method), player.time())};
  }
  return drawn;
}

}  // namespace

void write_still(const SceneFile& file, const StillOptions& options) {
  const std::vector<int> frames = frames_at(file.scene, options.times);
  Canvas canvas(options.width, options.height);
  std::vector<SheetFrame> sheet;
  for (const Configuration& method : options.methods) {
    std::ranges::move(draw_frames(file, method, frames, canvas), std::back_inserter(sheet));
  }
  if (sheet.size() == 1) {
    write_png(options.out.string(), options.width, options.height, sheet.front().rgba.data());
    return;
  }
  const int columns = options.methods.size() > 1 ? static_cast<int>(frames.size()) : 0;
  contact_sheet(options.out.string(), options.width, options.height, sheet, columns);
}

}  // namespace pinchlab
