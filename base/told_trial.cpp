// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/told_trial.h"

#include <fmt/format.h>

namespace pinchlab {

ToldChoice read_choice(JsonObject& object) {
  ToldChoice told{object.choice("choice", {"left", "right", "tie"}), {}};
  if (object.has("preference")) {
    told.preference = static_cast<int>(object.whole("preference", -3, 3));
  }
  const int sign = told.preference.value_or(told.word == "left" ? -1 : 1);
  if (told.word != (sign < 0 ? "left" : sign > 0 ? "right" : "tie")) {
    object.fail("choice",
                "must be left, right or tie as `preference` is less than, more than, or 0");
  }
  return told;
}

void check_frames(JsonObject& object, long frame_count, long dropped_frames) {
  if (dropped_frames <= frame_count) return;
  object.fail("dropped_frames", fmt::format("{} is more than `frame_count` ({}), which counts them "
                                            "too; correct what recorded them",
                                            dropped_frames, frame_count));
}

}  // namespace pinchlab
