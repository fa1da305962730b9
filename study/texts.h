// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The words of the page: those that are delivered, and what a configuration makes of them.

#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace pinchlab::study {

/// What a study has that needs texts of its own.
struct TextOptions {
  bool recruiting = false, questionnaires = false, screen = false;
  bool graded = false, confidence = false, click_where = false, reason = false;
  bool languages = false;                            ///< that participants choose from
  std::string controller, contact, consent_version;  ///< what the information names; or nothing
};

/// All delivered texts of a language, or nothing if there are none.
std::map<std::string, std::string> delivered_texts(const std::string& language);

/// The texts of a study. `own` are the configuration's, from `pointer` in `file`, which replace
/// delivered ones; texts of options that are not used are left out, so that they change nothing.
/// Throws InputError, also where a language that is not delivered lacks a text.
std::map<std::string, std::string> read_texts(const nlohmann::json& own, const std::string& file,
                                              const std::string& pointer,
                                              const std::string& language,
                                              const TextOptions& options);

}  // namespace pinchlab::study
