// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How far the two clips of a pair differ, and when: measured on what they show.

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "demos/events.h"
#include "demos/scenes/scene_json.h"

namespace pinchlab {

struct Interval {
  double from = 0.0, to = 0.0;  // s
};

/// What the report says of one clip of the pair.
struct ClipReport {
  Method method = Method::pinch;
  std::vector<Interval> still;  ///< when nothing moves to the eye
  double end_speed = 0.0;       ///< px/s, of the fastest centre or rim in the last two frames
  std::vector<Event> events;
};

struct PairReport {
  int frame_count = 0;
  int frames_per_second = 1;
  std::vector<Interval> differs;        ///< when the clips differ to the eye
  std::optional<int> first_difference;  ///< frame
  double largest_distance = 0.0;        ///< px, between a body's centres in the two clips
  int largest_at = 0;                   ///< frame
  std::string largest_body;             ///< its name
  double largest_turn = 0.0;            ///< rad, between a body's angles in the two clips
  std::string largest_turn_body;
  ClipReport pinch, baseline;
};

/// A frame differs to the eye where the means of some blocks of 4 x 4 px differ in a colour by more
/// than a fifth of the scale; fewer than one block in a thousand do not count. (An outline that is
/// off by about 1.5 px does it.)
///
/// Nothing moves to the eye where within a quarter of a second no body's centre and no point of a
/// rim moves by 1 px.
///
/// Pixels are those of a clip of `width` x `height`; the pictures that are compared are half as
/// large. A strip of both clips and their difference at equal distances in time is written to
/// `strip`, a PNG file. Calls `tick` after every frame. Throws
/// std::runtime_error where a simulation fails, or one takes longer than `time_limit` (s).
PairReport report_pair(const SceneFile& file, const Scene& scene, int width, int height,
                       const std::string& strip, const std::function<void()>& tick,
                       std::optional<double> time_limit = std::nullopt);

/// The sum of the intervals, s, and the longest one.
double total(const std::vector<Interval>& intervals);
double longest(const std::vector<Interval>& intervals);

nlohmann::ordered_json to_json(const PairReport& report);

}  // namespace pinchlab
