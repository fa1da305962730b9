// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/clip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "base/partial_file.h"
#include "base/sha256.h"
#include "demos/legibility.h"
#include "demos/pair_report.h"
#include "demos/scenes/fineness.h"
#include "demos/version.h"
#include "render/canvas.h"
#include "render/frame_hash.h"
#include "render/picture/compose.h"
#include "render/picture/frame_marks.h"
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

struct Made {
  std::string frames_hash;  // of the raw frames (RGBA, top row first, one after the other)
  std::vector<ordered_json> accuracy;  // of the methods whose error was asked for
  std::vector<std::string> broken_promises, hard_to_see;
};

void add_new(const std::vector<std::string>& lines, std::vector<std::string>& all) {
  for (const std::string& line : lines) {
    if (std::ranges::find(all, line) == all.end()) all.push_back(line);
  }
}

/// How fine one method's steps are.
Fineness find_fineness(const ClipPlan& plan, const Configuration& method,
                       std::optional<double> time_limit, Made& made) {
  const Fineness found =
      find_fineness(*plan.source, plan.scene, method, plan.scene.frame_count - 1, time_limit);
  if (found.believed) {
    made.accuracy.push_back(ordered_json{{"method", to_string(method)},
                                         {"steps_per_frame", found.steps_per_frame},
                                         {"believed_error_m", *found.believed}});
    std::vector<std::string> missed;
    add_missed_error(found, method, missed);
    add_new(missed, made.broken_promises);
  }
  return found;
}

Made write_video(const ClipPlan& plan, const std::string& path, const std::function<void()>& tick,
                 std::optional<double> time_limit) {
  Made made;
  std::deque<Player> players;
  std::vector<int> factors;
  for (const Configuration& method : plan.methods) {
    factors.push_back(find_fineness(plan, method, time_limit, made).factor);
    players.emplace_back(*plan.source, made_finer(plan.scene, factors.back()), method);
    players.back().give_up_after(time_limit);
  }
  std::vector<Picture> pictures(players.size());
  std::vector<const Picture*> panels(pictures.size());
  std::ranges::transform(pictures, panels.begin(), [](const Picture& p) { return &p; });
  const Scenery scenery = set_scenery(plan.scene, plan.source->look, plan.theme.theme,
                                      rehearsal_limit(*plan.source, time_limit));
  made.hard_to_see = hard_to_see(plan.scene, scenery, panel_width(plan), plan.video.height);
  Canvas canvas(plan.video.width, plan.video.height);
  VideoWriter video(path, plan.video);
  FrameHash frames;
  std::vector<std::uint8_t> turned;
  const double width = static_cast<double>(plan.video.width) / static_cast<double>(players.size());
  const double height = plan.video.height;  // px, of a panel
  for (const std::int64_t step : plan.steps) {
    for (std::size_t i = 0; i < players.size(); ++i) {
      players[i].advance_to_step(step * factors[i]);
      compose(plan.scene, scenery, players[i].world(), pictures[i]);
      if (i > 0) pictures[i].add(divider(scenery, width, height));
      if (plan.burn_time) pictures[i].add(time_label(scenery, players[i].time(), width / height));
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
  for (const Player& player : players) add_new(player.broken_promises(), made.broken_promises);
  video.finish();
  made.frames_hash = frames.hex();
  return made;
}

Made write_poster(const ClipPlan& plan, const std::string& path, const std::function<void()>& tick,
                  std::optional<double> time_limit) {
  const int width = panel_width(plan);
  const std::size_t bytes = frame_bytes(width, plan.video.height);
  const Scenery scenery = set_scenery(plan.scene, plan.source->look, plan.theme.theme,
                                      rehearsal_limit(*plan.source, time_limit));
  Canvas canvas(width, plan.video.height);
  Picture picture;
  FrameHash frames;
  std::vector<SheetFrame> sheet;
  Made made;
  made.hard_to_see = hard_to_see(plan.scene, scenery, width, plan.video.height);
  for (const Configuration& method : plan.methods) {
    const Fineness fineness = find_fineness(plan, method, time_limit, made);
    Player player(*plan.source, made_finer(plan.scene, fineness.factor), method);
    player.give_up_after(time_limit);
    player.advance_to(poster_frame(plan));
    add_new(player.broken_promises(), made.broken_promises);
    compose(plan.scene, scenery, player.world(), picture);
    const std::uint8_t* rgba = canvas.draw(picture);
    frames.add(std::as_bytes(std::span(rgba, bytes)));
    sheet.push_back(
        {{rgba, rgba + bytes}, fmt::format("{}, {:.2f} s", in_words(method), player.time())});
  }
  contact_sheet(path, width, plan.video.height, sheet, static_cast<int>(plan.methods.size()),
                plan.theme.theme);
  tick();
  made.frames_hash = frames.hex();
  return made;
}

}  // namespace

int panel_width(const ClipPlan& plan) {
  return plan.product == Product::clip ? plan.video.width / static_cast<int>(plan.methods.size())
                                       : plan.video.width;
}

std::string made_as(const ClipPlan& plan) {
  return plan.equal_sizes_with.empty() ? plan.file
                                       : fmt::format("{}.unpadded{}", plan.file, partial_ending);
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
      {"error_m", scene.error},
  };
  if (plan.upside_down) {
    entry["upside_down_panel"] = *plan.upside_down;
  }
  if (plan.product == Product::poster) {
    entry["time_s"] = static_cast<double>(poster_frame(plan)) / scene.frames_per_second;
  } else {
    entry["frame_count"] = plan.steps.size();
    entry["duration_s"] = static_cast<double>(plan.steps.size()) / scene.frames_per_second;
  }
  if (plan.product == Product::clip) {
    entry["codec"] = to_string(plan.video.codec);
    entry["settings"] = describe(plan.video);
    for (const Slow& slow : plan.playback.slow) {
      entry["slow"].push_back({slow.from, slow.to, slow.factor});
    }
    for (const Freeze& freeze : plan.playback.freeze) {
      entry["freeze"].push_back({freeze.at, freeze.seconds});
    }
  }
  if (!plan.theme.name.empty()) {
    entry["theme"] = plan.theme.name;
    entry["theme_sha256"] = plan.theme.sha256;
  }
  if (plan.burn_time) entry["burn_time"] = true;
  if (!plan.equal_sizes_with.empty()) entry["equal_sizes_with"] = plan.equal_sizes_with;
  entry["version"] = version;
  return entry;
}

ordered_json make_clip(const ClipPlan& plan, const std::filesystem::path& folder,
                       const std::function<void()>& tick, std::optional<double> time_limit) {
  const std::string path = (folder / made_as(plan)).string();
  ordered_json entry = plan_entry(plan);
  Made made;
  switch (plan.product) {
    case Product::clip:
      made = write_video(plan, path, tick, time_limit);
      break;
    case Product::poster:
      made = write_poster(plan, path, tick, time_limit);
      break;
    case Product::report:
      entry["report"] = to_json(report_pair(*plan.source, plan.scene, plan.video.width,
                                            plan.video.height, path, tick, time_limit));
      break;
  }
  if (plan.product != Product::report) entry["raw_frames_murmur3"] = made.frames_hash;
  entry["sha256"] = sha256_of_file(path);
  if (!made.accuracy.empty()) entry["accuracy"] = made.accuracy;
  if (!made.broken_promises.empty()) entry["broken_promises"] = made.broken_promises;
  if (!made.hard_to_see.empty()) entry["hard_to_see"] = made.hard_to_see;
  return entry;
}

}  // namespace pinchlab
