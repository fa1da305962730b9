// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a study asks in each trial besides, or instead of, the choice; all of it off by default.

#include <nlohmann/json.hpp>

#include "base/json_object.h"

namespace pinchlab::study {

inline constexpr int longest_reason = 2000;  ///< characters

struct TrialOptions {
  int confidence = 0;        ///< points of the scale that is asked after each choice; 0: none
  bool is_graded = false;    ///< seven grades from left to right, the middle one a tie, for two
  int reason = 0;            ///< characters that can be written after each choice; 0: none
  bool click_where = false;  ///< a click in the clips on where it looks wrong

  friend bool operator==(const TrialOptions&, const TrialOptions&) = default;
};

/// Reads `confidence`, `preference`, `reason` and `click_where`. Throws InputError.
TrialOptions read_trial_options(JsonObject& object);

/// The same keys, but for those that are off; empty where all are.
nlohmann::json to_json(const TrialOptions& options);

}  // namespace pinchlab::study
