// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/pair_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "demos/scenes/fineness.h"
#include "render/canvas.h"
#include "render/mesh.h"
#include "render/picture/compose.h"
#include "render/png.h"

namespace pinchlab {
namespace {

using nlohmann::ordered_json;

constexpr int block = 2;                // px of the half-size pictures: 4 of the clip
constexpr double visible_step = 0.2;    // of the scale
constexpr double visible_share = 1e-3;  // of the blocks
constexpr double still_window = 0.25;   // s
constexpr double still_reach = 1.0;     // px

/// Two pictures side by side as means of blocks, 0..255.
struct Blocks {
  int columns, rows;                // of one picture
  std::vector<std::uint8_t> means;  // rows x 2 columns x 4, top row first

  const std::uint8_t* at(int panel, int column, int row) const {
    return means.data() +
           4 * (static_cast<std::size_t>(row) * 2 * static_cast<std::size_t>(columns) +
                static_cast<std::size_t>(panel) * static_cast<std::size_t>(columns) +
                static_cast<std::size_t>(column));
  }
  int difference(int column, int row) const {  // the largest of red, green and blue
    const std::uint8_t *a = at(0, column, row), *b = at(1, column, row);
    int most = 0;
    for (int k = 0; k < 3; ++k) most = std::max(most, std::abs(a[k] - b[k]));
    return most;
  }
};

void take_means(const std::uint8_t* rgba, Blocks& blocks) {
  const std::size_t columns = 2 * static_cast<std::size_t>(blocks.columns);
  const std::size_t row_bytes = columns * block * 4;
  blocks.means.resize(columns * static_cast<std::size_t>(blocks.rows) * 4);
  std::uint8_t* to = blocks.means.data();
  for (std::size_t y = 0; y < static_cast<std::size_t>(blocks.rows); ++y) {
    const std::uint8_t *above = rgba + y * block * row_bytes, *below = above + row_bytes;
    for (std::size_t x = 0; x < columns; ++x, above += 8, below += 8) {
      for (std::size_t k = 0; k < 4; ++k) {
        *to++ = static_cast<std::uint8_t>((above[k] + above[k + 4] + below[k] + below[k + 4]) / 4);
      }
    }
  }
}

bool differs_to_the_eye(const Blocks& blocks) {
  int count = 0;
  for (int y = 0; y < blocks.rows; ++y) {
    for (int x = 0; x < blocks.columns; ++x) {
      count += static_cast<int>(blocks.difference(x, y) > 255 * visible_step);
    }
  }
  return count >= visible_share * blocks.columns * blocks.rows;
}

/// Of each body where it is and how it is turned, frame by frame.
struct Poses {
  std::vector<std::vector<Vec2>> position;
  std::vector<std::vector<double>> angle;
  void add(const World& world) {
    position.push_back(world.position);
    angle.push_back(world.angle);
  }
};

/// px by which the fastest centre or rim has got away between two frames.
double motion(const Scene& scene, const Poses& poses, std::size_t from, std::size_t to,
              double scale) {
  double most = 0.0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const double turned = std::abs(poses.angle[to][b] - poses.angle[from][b]);
    most = std::max({most, (poses.position[to][b] - poses.position[from][b]).norm(),
                     2.0 * scene.bodies[b].radius * std::sin(0.5 * std::min(turned, 3.0))});
  }
  return scale * most;
}

/// Runs of flagged frames; a frame lasts until the next.
std::vector<Interval> intervals(const std::vector<char>& flags, int frames_per_second) {
  std::vector<Interval> found;
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (flags[i] == 0) continue;
    const std::size_t first = i;
    while (i < flags.size() && flags[i] != 0) ++i;
    found.push_back({static_cast<double>(first) / frames_per_second,
                     static_cast<double>(i) / frames_per_second});
  }
  return found;
}

void measure_motion(const Scene& scene, const Poses& poses, double scale, ClipReport& report) {
  const std::size_t count = poses.position.size();
  const auto window = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::lround(still_window * scene.frames_per_second)));
  std::vector<char> still(count, 0);
  for (std::size_t i = window; i < count; ++i) {
    if (motion(scene, poses, i - window, i, scale) >= still_reach) continue;
    std::fill(still.begin() + static_cast<std::ptrdiff_t>(i - window),
              still.begin() + static_cast<std::ptrdiff_t>(i) + 1, 1);
  }
  report.still = intervals(still, scene.frames_per_second);
  if (count > 1) {
    report.end_speed = scene.frames_per_second * motion(scene, poses, count - 2, count - 1, scale);
  }
}

void measure_distance(const Scene& scene, const Poses& pinch, const Poses& baseline, double scale,
                      PairReport& report) {
  for (std::size_t i = 0; i < pinch.position.size(); ++i) {
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const double distance = scale * (pinch.position[i][b] - baseline.position[i][b]).norm();
      if (distance > report.largest_distance) {
        report.largest_distance = distance;
        report.largest_at = static_cast<int>(i);
        report.largest_body = scene.bodies[b].name;
      }
      const double turn = std::abs(pinch.angle[i][b] - baseline.angle[i][b]);
      if (turn > report.largest_turn) {
        report.largest_turn = turn;
        report.largest_turn_body = scene.bodies[b].name;
      }
    }
  }
}

/// Three rows of small pictures: pinch, baseline, and dark where they differ.
class StripOfPictures {
 public:
  StripOfPictures(const Scene& scene, Method baseline) : scene_(scene), baseline_(baseline) {
    for (int i = 0; i < columns; ++i)
      wanted_.push_back((scene.frame_count - 1) * i / (columns - 1));
  }

  void look(int frame, const Blocks& blocks) {
    if (!std::ranges::binary_search(wanted_, frame)) return;
    const double time = static_cast<double>(frame) / scene_.frames_per_second;
    SheetFrame pinch{{}, fmt::format("{}, {:.2f} s", in_words(Method::pinch), time)};
    SheetFrame other{{}, fmt::format("{}, {:.2f} s", in_words(baseline_), time)};
    SheetFrame difference{{}, fmt::format("difference, {:.2f} s", time)};
    for (int y = 0; y < blocks.rows; ++y) {
      for (int x = 0; x < blocks.columns; ++x) {
        const std::uint8_t *a = blocks.at(0, x, y), *b = blocks.at(1, x, y);
        pinch.rgba.insert(pinch.rgba.end(), a, a + 4);
        other.rgba.insert(other.rgba.end(), b, b + 4);
        const auto grey = static_cast<std::uint8_t>(255 - blocks.difference(x, y));
        difference.rgba.insert(difference.rgba.end(), {grey, grey, grey, 255});
      }
    }
    rows_[0].push_back(std::move(pinch));
    rows_[1].push_back(std::move(other));
    rows_[2].push_back(std::move(difference));
  }

  void write(const std::string& path, const Blocks& blocks) {
    std::vector<SheetFrame> all;
    for (auto& row : rows_) std::ranges::move(row, std::back_inserter(all));
    const int used = static_cast<int>(all.size() / rows_.size());
    contact_sheet(path, blocks.columns, blocks.rows, all, used);
  }

 private:
  static constexpr int columns = 8;
  const Scene& scene_;
  Method baseline_;
  std::vector<int> wanted_;  // frames, ascending
  std::array<std::vector<SheetFrame>, 3> rows_;
};

ordered_json intervals_json(const std::vector<Interval>& intervals) {
  ordered_json list = ordered_json::array();
  for (const Interval& interval : intervals) list.push_back({interval.from, interval.to});
  return list;
}

ordered_json clip_json(const ClipReport& clip, double duration) {
  ordered_json events = ordered_json::array();
  for (const Event& event : clip.events) {
    events.push_back({{"what", event.what}, {"from_s", event.from}, {"to_s", event.to}});
  }
  return {{"method", to_string(clip.method)},       {"still_share", total(clip.still) / duration},
          {"longest_still_s", longest(clip.still)}, {"still_s", intervals_json(clip.still)},
          {"end_speed_px_s", clip.end_speed},       {"events", std::move(events)}};
}

}  // namespace

PairReport report_pair(const SceneFile& file, const Scene& scene, int width, int height,
                       const std::string& strip_path, const std::function<void()>& tick,
                       std::optional<double> time_limit) {
  PairReport report;
  report.frame_count = scene.frame_count;
  report.frames_per_second = scene.frames_per_second;
  report.pinch.method = Method::pinch;
  report.baseline.method = scene.baseline;

  Blocks blocks{
      std::max(smallest_frame / 2, width / 4), std::max(smallest_frame / 2, height / 4), {}};
  const Scenery scenery = for_file(file.path, [&] {
    return set_scenery(scene, file.look, {}, rehearsal_limit(file, time_limit));
  });
  Canvas canvas(2 * block * blocks.columns, block * blocks.rows);
  const auto fine = [&](Method method) {
    return made_finer(scene,
                      find_fineness(file, scene, method, scene.frame_count - 1, time_limit).factor);
  };
  Player pinch(file, fine(Method::pinch), Method::pinch),
      baseline(file, fine(scene.baseline), scene.baseline);
  pinch.give_up_after(time_limit);
  baseline.give_up_after(time_limit);
  Picture pinch_picture, baseline_picture;
  EventWatch pinch_events(scene), baseline_events(scene);
  const auto watch = [](Player& player, EventWatch& events) {
    events.look(player.world(), player.world().time());
    player.on_step([&player, &events] { events.look(player.world(), player.world().time()); });
  };
  watch(pinch, pinch_events);
  watch(baseline, baseline_events);
  Poses pinch_poses, baseline_poses;
  StripOfPictures strip(scene, scene.baseline);
  std::vector<char> differs;
  for (int frame = 0; frame < scene.frame_count; ++frame) {
    pinch.advance_to(frame);
    baseline.advance_to(frame);
    pinch_poses.add(pinch.world());
    baseline_poses.add(baseline.world());
    compose(scene, scenery, pinch.world(), pinch_picture);
    compose(scene, scenery, baseline.world(), baseline_picture);
    const std::array<const Picture*, 2> pair = {&pinch_picture, &baseline_picture};
    take_means(canvas.draw(pair), blocks);
    differs.push_back(differs_to_the_eye(blocks) ? 1 : 0);
    if (differs.back() != 0 && !report.first_difference) report.first_difference = frame;
    strip.look(frame, blocks);
    tick();
  }
  report.differs = intervals(differs, scene.frames_per_second);
  report.pinch.events = pinch_events.events();
  report.baseline.events = baseline_events.events();
  const double scale = Fit(scenery.view, 0, width, height).scale;  // px/m
  measure_motion(scene, pinch_poses, scale, report.pinch);
  measure_motion(scene, baseline_poses, scale, report.baseline);
  measure_distance(scene, pinch_poses, baseline_poses, scale, report);
  strip.write(strip_path, blocks);
  return report;
}

double total(const std::vector<Interval>& intervals) {
  double sum = 0.0;
  for (const Interval& interval : intervals) sum += interval.to - interval.from;
  return sum;
}

double longest(const std::vector<Interval>& intervals) {
  double most = 0.0;
  for (const Interval& interval : intervals) most = std::max(most, interval.to - interval.from);
  return most;
}

ordered_json to_json(const PairReport& report) {
  const double rate = report.frames_per_second, duration = report.frame_count / rate;
  ordered_json value = {
      {"first_difference_s", report.first_difference ? ordered_json(*report.first_difference / rate)
                                                     : ordered_json(nullptr)},
      {"same_share", 1.0 - total(report.differs) / duration},
      {"differs_s", intervals_json(report.differs)},
      {"largest_distance_px", report.largest_distance},
      {"largest_distance_at_s", report.largest_at / rate},
      {"largest_distance_body", report.largest_body},
      {"largest_turn_rad", report.largest_turn},
      {"largest_turn_body", report.largest_turn_body}};
  value["pinch"] = clip_json(report.pinch, duration);
  value["baseline"] = clip_json(report.baseline, duration);
  return value;
}

}  // namespace pinchlab
