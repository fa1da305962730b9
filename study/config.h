// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// study.json: what a study shows and says. README.md documents every key.

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "study/plan.h"
#include "study/questionnaire.h"
#include "study/recruiting.h"
#include "study/texts.h"
#include "study/trial_options.h"

namespace pinchlab::study {

/// A pair with an obvious answer: a demonstration beside itself upside down, or two side-by-side
/// files of the researcher's own in the clips' folder that differ in the side of the right answer.
struct AttentionCheck {
  std::string name;
  std::string demonstration;  ///< that is shown beside itself; empty: a pair of one's own
  std::string left, right;    ///< files of one's own: right answer on the left, on the right
};

/// A graded clip beside its reference: two side-by-side files in the clips' folder.
struct GradedStimulus {
  GradedClip clip;
  std::string left, right;  ///< files: the reference on the left, on the right
};

struct Config {
  std::vector<std::string> demonstrations;  ///< empty: all that there are
  std::vector<std::string> training;
  std::vector<AttentionCheck> attention_checks;
  std::vector<std::string> methods;    ///< of a study of three and more
  int pairs_per_demonstration = 0;     ///< 0: all
  std::vector<GradedStimulus> graded;  ///< of a study of thresholds; demonstrations are its series
  std::string graded_hit = "reference";  ///< or "graded": what it is a hit to choose
  int adaptive_trials = 0;  ///< of each series, if its levels are chosen by the answers
  int repetitions = 1;
  bool both_orders = false;
  bool shared_computer = false;  ///< the last page leads to the next participant
  int participant_limit = 0;     ///< 0: none
  bool one_time_links = false;
  std::optional<Recruiting> recruiting;  ///< participants who are sent by a site
  TrialOptions trial;
  Questionnaires questionnaires;  ///< around the trials
  bool is_pilot = false;          ///< a trial run; of the command line, not of the file
  /// Of a pilot whose participants are simulated: the SHA-256 of the truth they answer by.
  std::string simulated_by;
  std::string controller, contact, consent_version;  ///< what the information names; or nothing
  std::string language = "en";                       ///< of the texts, a BCP 47 tag
  std::map<std::string, std::string> texts;  ///< every text of the page that is used, by its key
  /// Other languages that a participant can choose, and their texts.
  std::map<std::string, std::map<std::string, std::string>> translations;
};

/// What a study is without a file: every pair once, in English.
Config default_config();

/// Reads a file strictly: throws InputError with the place and the cure.
Config read_config(const std::filesystem::path& path);

/// The same for a parsed document; `file` is for messages.
Config parse_config(const nlohmann::json& document, const std::string& file);

/// The methods' file with `first` on the left: "03-drop.pinch-cable.mp4".
std::string comparison_file(const std::string& demonstration, const std::string& first,
                            const std::string& second, const std::string& ending);

/// What the plan depends on. `config.demonstrations` must not be empty.
PlanOptions plan_options(const Config& config);

}  // namespace pinchlab::study
