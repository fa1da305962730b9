// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What holds of a trial as the study page tells it and as answer files keep it.

#include <optional>
#include <string>

#include "base/json_object.h"

namespace pinchlab {

struct ToldChoice {
  std::string word;               ///< "left", "right" or "tie"
  std::optional<int> preference;  ///< from -3, left by far, to 3, right by far, where it is graded
};

/// Reads `choice`, which follows from `preference` where there is one. Throws InputError.
ToldChoice read_choice(JsonObject& object);

/// Throws InputError if more frames are told to be dropped than there were.
void check_frames(JsonObject& object, long frame_count, long dropped_frames);

}  // namespace pinchlab
