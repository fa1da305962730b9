// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/clip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "base/sha256.h"
#include "demos/pair_report.h"
#include "demos/player.h"
#include "demos/version.h"
#include "render/canvas.h"
#include "render/compose.h"
#include "render/frame_hash.h"
#include "render/png.h"

namespace pinchlab {
namespace {

using nlohmann::ordered_json;

std::vector<std::string> method_names(const ClipPlan& plan) {
  std::vector<std::string> names;
  for (const Configuration& method : plan.methods) {
    names.emplace_back(to_string(method));
  }
  return names;
}

std::size_t frame_bytes(int width, int height) {
  return 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

// A copy of a frame, with one of its panels turned upside down.
void turn(const ClipPlan& plan, int panel, const std::uint8_t* rgba,
          std::vector<std::uint8_t>& turned) {
  const std::size_t row = frame_bytes(plan.video.width, 1);
  const std::size_t part = frame_bytes(panel_width(plan), 1);
  const std::size_t begin = part * static_cast<std::size_t>(panel);
  const auto height = static_cast<std::size_t>(plan.video.height);
  turned.assign(rgba, rgba + row * height);
  for (std::size_t y = 0; y < height; ++y) {
    std::copy_n(rgba + (height - 1 - y) * row + begin, part, turned.data() + y * row + begin);
  }
}

// Returns the hash of the raw frames (RGBA, top row first, one after the other).
std::string write_video(const ClipPlan& plan, const std::string& path,
                        const std::function<void()>& tick) {
  std::deque<Player> players;
  for (const Configuration& method : plan.methods) {
    players.emplace_back(*plan.source, plan.scene, method);
  }
  std::vector<Picture> pictures(players.size());
  std::vector<const Picture*> panels(pictures.size());
  std::ranges::transform(pictures, panels.begin(), [](const Picture& p) { return &p; });
  Canvas canvas(plan.video.width, plan.video.height);
  VideoWriter video(path, plan.video);
  FrameHash frames;
  std::vector<std::uint8_t> turned;
  for (int frame = 0; frame < plan.scene.frame_count; ++frame) {
    for (std::size_t i = 0; i < players.size(); ++i) {
      players[i].advance_to(frame);
      compose(plan.scene, players[i].world(), pictures[i]);
    }
    const std::uint8_t* rgba = canvas.draw(panels);
    if (plan.upside_down) {
      turn(plan, *plan.upside_down, rgba, turned);
      rgba = turned.data();
    }
    frames.add(std::as_bytes(std::span(rgba, frame_bytes(plan.video.width, plan.video.height))));
    if (plan.upside_down) {
      video.add(rgba);
    } else {
      video.add(rgba, canvas.changed());
    }
    tick();
  }
  video.finish();
  return frames.hex();
}

std::string write_poster(const ClipPlan& plan, const std::string& path,
                         const std::function<void()>& tick) {
  const int width = panel_width(plan);
  const std::size_t bytes = frame_bytes(width, plan.video.height);
  Canvas canvas(width, plan.video.height);
  Picture picture;
  FrameHash frames;
  std::vector<SheetFrame> sheet;
  for (const Configuration& method : plan.methods) {
    Player player(*plan.source, plan.scene, method);
    player.advance_to(poster_frame(plan));
    compose(plan.scene, player.world(), picture);
    const std::uint8_t* rgba = canvas.draw(picture);
    frames.add(std::as_bytes(std::span(rgba, bytes)));
    sheet.push_back(
        {{rgba, rgba + bytes}, fmt::format("{}, {:.2f} s", in_words(method), player.time())});
  }
  contact_sheet(path, width, plan.video.height, sheet, static_cast<int>(plan.methods.size()));
  tick();
  return frames.hex();
}

}  // namespace

int panel_width(const ClipPlan& plan) {
  return plan.product == Product::clip ? plan.video.width / static_cast<int>(plan.methods.size())
                                       : plan.video.width;
}

int poster_frame(const ClipPlan& plan) {
  const auto nearest =
      static_cast<int>(std::lround(plan.source->poster_time * plan.scene.frames_per_second));
  return std::min(nearest, plan.scene.frame_count - 1);
}

ordered_json plan_entry(const ClipPlan& plan) {
  const Scene& scene = plan.scene;
  ordered_json entry = {
      {"file", plan.file},
      {"role", plan.role},
      {"scene", plan.source->path.filename().string()},
      {"scene_sha256", plan.source->sha256},
      {"title", scene.title},
      {"methods", method_names(plan)},
      {"panel_width_px", panel_width(plan)},
      {"panel_height_px", plan.video.height},
      {"frames_per_second", scene.frames_per_second},
      {"steps_per_frame", scene.steps_per_frame},
  };
  if (plan.upside_down) {
    entry["upside_down_panel"] = *plan.upside_down;
  }
  if (plan.product == Product::poster) {
    entry["time_s"] = static_cast<double>(poster_frame(plan)) / scene.frames_per_second;
  } else {
    entry["frame_count"] = scene.frame_count;
    entry["duration_s"] = static_cast<double>(scene.frame_count) / scene.frames_per_second;
  }
  if (plan.product == Product::clip) {
    entry["codec"] = to_string(plan.video.codec);
    entry["settings"] = describe(plan.video);
  }
  entry["version"] = version;
  return entry;
}

ordered_json make_clip(const ClipPlan& plan, const std::filesystem::path& folder,
                       const std::function<void()>& tick) {
  const std::string path = (folder / plan.file).string();
  ordered_json entry = plan_entry(plan);
  switch (plan.product) {
    case Product::clip:
      entry["raw_frames_murmur3"] = write_video(plan, path, tick);
      break;
    case Product::poster:
      entry["raw_frames_murmur3"] = write_poster(plan, path, tick);
      break;
    case Product::report:
      entry["report"] = to_json(
          report_pair(*plan.source, plan.scene, plan.video.width, plan.video.height, path, tick));
      break;
  }
  entry["sha256"] = sha256_of_file(path);
  return entry;
}

}  // namespace pinchlab
