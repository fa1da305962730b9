// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/trial_options.h"

#include "study/session.h"

namespace pinchlab::study {

using nlohmann::json;

TrialOptions read_trial_options(JsonObject& object) {
  TrialOptions options;
  if (object.has("confidence")) {
    options.confidence = static_cast<int>(object.whole("confidence", 2, 9));
  }
  if (object.has("preference")) {
    options.is_graded = object.choice("preference", {"forced", "graded"}) == "graded";
    if (options.is_graded && object.has("series")) {
      object.fail("preference", "cannot be graded in a study of series, which needs two choices");
    }
  }
  if (object.has("reason")) {
    options.reason = static_cast<int>(object.whole("reason", 1, longest_reason));
  }
  if (object.has("click_where")) options.click_where = object.flag("click_where");
  return options;
}

json to_json(const TrialOptions& options) {
  json object = json::object();
  if (options.confidence > 0) object["confidence"] = options.confidence;
  if (options.is_graded) object["preference"] = "graded";
  if (options.reason > 0) object["reason"] = options.reason;
  if (options.click_where) object["click_where"] = true;
  return object;
}

void check_asked(const TrialAnswer& answer, const TrialOptions& options) {
  const auto refuse = [](const char* key, const char* why) {
    throw Refused(422, std::string("request: /") + key + ": " + why);
  };
  if (answer.preference.has_value() != options.is_graded) {
    refuse("preference", options.is_graded ? "is missing" : "was not asked");
  }
  if (answer.confidence.has_value() != (options.confidence > 0)) {
    refuse("confidence", options.confidence > 0 ? "is missing" : "was not asked");
  }
  if (answer.confidence && *answer.confidence > options.confidence) {
    refuse("confidence", "is beyond the scale");
  }
  constexpr std::size_t bytes_a_character = 4;
  if (answer.reason.size() > bytes_a_character * static_cast<std::size_t>(options.reason)) {
    refuse("reason", options.reason > 0 ? "is too long" : "was not asked");
  }
  if (answer.where && !options.click_where) refuse("where_side", "was not asked");
}

}  // namespace pinchlab::study
