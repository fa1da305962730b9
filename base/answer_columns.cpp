// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/answer_columns.h"

#include <algorithm>
#include <array>

namespace pinchlab {
namespace {

constexpr std::array<std::string_view, 27> names = {"participant_number",
                                                    "chosen_side",
                                                    "expected",
                                                    "loops_watched",
                                                    "focus_lost_count",
                                                    "frame_count",
                                                    "dropped_frames",
                                                    "loop_gap_median_s",
                                                    "loop_gap_max_s",
                                                    "playback_error_count",
                                                    "playback_errors",
                                                    "clip",
                                                    "shown_utc",
                                                    "input",
                                                    "window_width_px",
                                                    "window_height_px",
                                                    "clip_width_px",
                                                    "clip_height_px",
                                                    "screen_width_px",
                                                    "screen_height_px",
                                                    "device_pixel_ratio",
                                                    "confidence",
                                                    "reason",
                                                    "where_side",
                                                    "where_x",
                                                    "where_y",
                                                    "where_time_s"};
// Of the parts of a questionnaire, before the question's name.
constexpr std::array<std::string_view, 3> parts = {"screen_", "before_", "after_"};

}  // namespace

bool is_column_beside_answers(std::string_view name) {
  return std::ranges::find(names, name) != names.end() ||
         std::ranges::any_of(parts, [&](std::string_view part) { return name.starts_with(part); });
}

}  // namespace pinchlab
