// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "base/input_error.h"
#include "study/config.h"

namespace pinchlab::study {

/// What is wrong with a configuration; nothing where nothing is.
inline std::string config_error(const nlohmann::json& document) {
  try {
    parse_config(document, "study.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// The same of one that says its format besides.
inline std::string error_with_format(nlohmann::json document) {
  document["format"] = "pinchlab-study 1";
  return config_error(document);
}

}  // namespace pinchlab::study
