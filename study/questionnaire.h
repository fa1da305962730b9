// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Questions of the researcher's own, before the trials and after them.

#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/json_object.h"

namespace pinchlab::study {

enum class QuestionKind { choice, scale, number, text };

struct Question {
  std::string name;  ///< that the answer is kept under; none twice in a study
  QuestionKind kind = QuestionKind::text;
  std::string text;  ///< what is asked
  bool is_required = false;
  std::vector<std::string> choices;  ///< of a choice: two or more
  int points = 0;                    ///< of a scale, whose answers are 1 to `points`
  std::string low, high;             ///< of a scale: words at its ends
  double least = 0, most = 0;        ///< of a number
  bool is_whole = false;             ///< of a number
  std::size_t longest = 0;           ///< of a text, characters
};

using Questionnaire = std::vector<Question>;

/// The questionnaires of a study; an empty one is not shown.
struct Questionnaires {
  Questionnaire screen;  ///< screen_questions(), which a page of its own answers, or empty
  Questionnaire before, after;

  [[nodiscard]] bool empty() const { return screen.empty() && before.empty() && after.empty(); }
  /// The one that is called "screen", "before" or "after"; nullptr for others and an empty one.
  [[nodiscard]] const Questionnaire* find(const std::string& part) const;
};

inline constexpr std::array<const char*, 3> questionnaire_parts = {"screen", "before", "after"};

/// What `measure_screen` asks: size of a pixel, viewing distance, refresh rate.
Questionnaire screen_questions();

/// Reads `measure_screen`, `questionnaire_before` and `questionnaire_after` of a configuration
/// strictly. Throws InputError.
Questionnaires read_questionnaires(JsonObject& object, const std::string& file);

/// As a configuration holds them, which is also what the page gets: part -> questions.
nlohmann::json to_json(const Questionnaires& questionnaires);

/// The same read back. Throws InputError.
Questionnaires questionnaires_from_json(JsonObject object, const std::string& file);

/// Checks what a participant answered (name -> answer; questions that need none can be missing) and
/// returns it as it is kept: name -> {"question": in words, "answer"}. Throws InputError.
nlohmann::json check_answers(const Questionnaire& questionnaire, JsonObject answers);

}  // namespace pinchlab::study
