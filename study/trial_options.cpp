// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/trial_options.h"

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

}  // namespace pinchlab::study
