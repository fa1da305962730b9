// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One row a participant.

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pinchlab::study {

/// A cell: the text, number or flag that `object` has there; empty without it.
std::string value_of(const nlohmann::json& object, const char* key);

struct ParticipantsTable {
  std::vector<std::string> names, descriptions;  ///< of the columns; the first is `participant`
  std::vector<std::vector<std::string>> rows;  ///< as many cells as columns, in order of the files
};

/// Of answer files that were checked. `with_ids`: with the ids of the site that sent the
/// participants, if there are any.
ParticipantsTable participants_table(const std::vector<nlohmann::json>& files, bool with_ids);

/// Columns of the study's own questions: `before_age`, `after_comments` -> the question.
using QuestionColumns = std::map<std::string, std::string>;
QuestionColumns question_columns(const std::vector<nlohmann::json>& files);

/// What a participant answered there; empty if nothing.
std::string own_answer(const nlohmann::json& file, const std::string& column);

}  // namespace pinchlab::study
