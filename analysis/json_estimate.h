// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Estimates in report.json.

#include <nlohmann/json.hpp>
#include <string>

#include "analysis/estimate.h"

namespace pinchlab::analysis {

/// What cannot be computed is null, with the reason beside it under "<key>_reason".
inline void put(nlohmann::ordered_json& object, const std::string& key, const Estimate& estimate) {
  if (estimate) {
    object[key] = estimate.value;
  } else {
    object[key] = nullptr;
    object[key + "_reason"] = estimate.why_not;
  }
}

}  // namespace pinchlab::analysis
