// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// study.json: what a study shows and says. README.md documents every key.

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "study/plan.h"

namespace pinchlab::study {

/// A pair with an obvious answer: a demonstration beside itself upside down, or two side-by-side
/// files of the researcher's own in the clips' folder that differ in the side of the right answer.
struct AttentionCheck {
  std::string name;
  std::string demonstration;  ///< that is shown beside itself; empty: a pair of one's own
  std::string left, right;    ///< files of one's own: right answer on the left, on the right
};

struct Config {
  std::vector<std::string> demonstrations;  ///< empty: all that there are
  std::vector<std::string> training;
  std::vector<AttentionCheck> attention_checks;
  int repetitions = 1;
  bool both_orders = false;
  int participant_limit = 0;  ///< 0: none
  bool one_time_links = false;
  std::string language = "en";               ///< of the texts, a BCP 47 tag
  std::map<std::string, std::string> texts;  ///< every text of the page, by its key
};

/// The delivered texts of a language, or nothing if there are none.
std::map<std::string, std::string> delivered_texts(const std::string& language);

/// What a study is without a file: every pair once, in English.
Config default_config();

/// Reads a file strictly: throws InputError with the place and the cure.
Config read_config(const std::filesystem::path& path);

/// The same for a parsed document; `file` is for messages.
Config parse_config(const nlohmann::json& document, const std::string& file);

/// What the plan depends on. `config.demonstrations` must not be empty.
PlanOptions plan_options(const Config& config);

}  // namespace pinchlab::study
