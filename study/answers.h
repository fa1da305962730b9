// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The answers as they are kept: one whole file a participant (analysis/answers.schema.json).

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "study/clips.h"
#include "study/plan.h"
#include "study/session.h"

namespace pinchlab::study {

/// A file that was shown.
struct ShownFile {
  std::string name, sha256;
};
using ShownFiles = std::function<ShownFile(const PlannedTrial&, Encoding)>;

/// What was answered.
struct AnsweredStudy {
  PlanOptions plan;
  nlohmann::json shown;                  ///< what_is_shown()
  std::string graded_hit = "reference";  ///< of studies of thresholds
  bool is_pilot = false;                 ///< a trial run
};

/// The plan as answer files hold it.
nlohmann::ordered_json plan_entry(const PlanOptions& options, const std::string& graded_hit);

/// The answer file of a finished session. `code_hash` is withdrawal_hash() of the participant's
/// code.
nlohmann::ordered_json answer_file(const Session& session, const AnsweredStudy& study,
                                   const ShownFiles& shown,
                                   const std::map<std::string, std::string>& free_text,
                                   const std::string& saved_utc, const std::string& code_hash);

/// Where the answers of a participant are.
std::filesystem::path answer_path(const std::filesystem::path& folder, const std::string& id);

/// Checks that the statistics will read the file, writes it durably, reads it back and checks
/// again. When it returns, the answers are safe. Throws std::runtime_error; then there is no file.
void save_answers(const std::filesystem::path& path, const nlohmann::ordered_json& file);

/// Removes the answers that belong to a code and returns their participant's id; nothing if there
/// are none. Throws std::invalid_argument if it cannot be a code.
std::optional<std::string> withdraw(const std::filesystem::path& folder, const std::string& code);

}  // namespace pinchlab::study
