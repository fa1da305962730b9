// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/questionnaire.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>

namespace pinchlab::study {
namespace {

using nlohmann::json;

constexpr std::size_t most_questions = 50, most_choices = 50;
constexpr std::size_t longest_name = 40, longest_label = 500, longest_question = 2000;  // bytes
constexpr long longest_answer = 5000, usual_answer = 1000;  // characters
constexpr std::size_t most_characters = 40000;              // of all texts of a questionnaire
constexpr std::size_t bytes_a_character = 4;                // of UTF-8
constexpr double largest_number = 1e9;
constexpr const char* key_cure = "; study/README.md has the keys";

const std::vector<std::string> kinds = {"choice", "scale", "number", "text"};

std::string read_name(JsonObject& object, std::set<std::string>& names) {
  std::string name = object.text("name", longest_name);
  const bool is_name =
      !name.empty() && 'a' <= name[0] && name[0] <= 'z' && std::ranges::all_of(name, [](char c) {
        return ('a' <= c && c <= 'z') || ('0' <= c && c <= '9') || c == '_';
      });
  if (!is_name) {
    object.fail("name",
                fmt::format("must be 1 to {} of a-z, 0-9 and `_`, first a letter", longest_name));
  }
  if (!names.insert(name).second) object.fail("name", fmt::format("`{}` stands twice", name));
  return name;
}

std::string read_words(JsonObject& object, const char* key, std::size_t longest) {
  std::string words = object.text(key, longest);
  if (words.find_first_not_of(" \n") == std::string::npos) object.fail(key, "is empty");
  return words;
}

void read_choices(JsonObject& object, Question& question) {
  for (const json& entry : object.array("choices", most_choices)) {
    const std::string choice = entry.is_string() ? entry.get<std::string>() : "";
    if (choice.find_first_not_of(' ') == std::string::npos || choice.size() > longest_label ||
        std::ranges::find(question.choices, choice) != question.choices.end()) {
      object.fail("choices",
                  fmt::format("must hold texts of 1 to {} bytes, none twice", longest_label));
    }
    question.choices.push_back(choice);
  }
  if (question.choices.size() < 2) object.fail("choices", "must be two or more");
}

void read_number(JsonObject& object, Question& question) {
  question.least = object.number("min", -largest_number, largest_number);
  question.most = object.number("max", -largest_number, largest_number);
  if (question.most <= question.least) object.fail("max", "must be more than min");
  if (object.has("whole")) question.is_whole = object.flag("whole");
  if (question.is_whole && std::ceil(question.least) > std::floor(question.most)) {
    object.fail("max", "leaves no whole number");
  }
}

Question read_question(JsonObject object, std::set<std::string>& names) {
  Question question;
  question.name = read_name(object, names);
  question.text = read_words(object, "text", longest_question);
  const std::string kind = object.choice("kind", kinds);
  question.kind = static_cast<QuestionKind>(std::ranges::find(kinds, kind) - kinds.begin());
  if (object.has("required")) question.is_required = object.flag("required");
  switch (question.kind) {
    case QuestionKind::choice:
      read_choices(object, question);
      break;
    case QuestionKind::scale:
      question.points = static_cast<int>(object.whole("points", 2, 11));
      question.low = read_words(object, "low", longest_label);
      question.high = read_words(object, "high", longest_label);
      break;
    case QuestionKind::number:
      read_number(object, question);
      break;
    case QuestionKind::text:
      question.longest = static_cast<std::size_t>(
          object.has("longest") ? object.whole("longest", 1, longest_answer) : usual_answer);
      break;
  }
  object.finish(key_cure);
  return question;
}

Questionnaire read_one(JsonObject& object, const char* key, const std::string& file,
                       std::set<std::string>& names) {
  Questionnaire questionnaire;
  if (!object.has(key)) return questionnaire;
  const json& entries = object.array(key, most_questions);
  std::size_t characters = 0;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    questionnaire.push_back(read_question(
        JsonObject(entries[i], file, fmt::format("{}/{}", object.pointer_to(key), i)), names));
    characters += questionnaire.back().longest;
  }
  if (questionnaire.empty()) object.fail(key, "is empty; leave it out to ask nothing");
  if (characters > most_characters) {
    object.fail(key, fmt::format("its texts could hold {} characters; at most {} together",
                                 characters, most_characters));
  }
  return questionnaire;
}

json to_json(const Question& question) {
  json object = {{"name", question.name},
                 {"kind", kinds[static_cast<std::size_t>(question.kind)]},
                 {"text", question.text},
                 {"required", question.is_required}};
  switch (question.kind) {
    case QuestionKind::choice:
      object["choices"] = question.choices;
      break;
    case QuestionKind::scale:
      object.update({{"points", question.points}, {"low", question.low}, {"high", question.high}});
      break;
    case QuestionKind::number:
      object.update(
          {{"min", question.least}, {"max", question.most}, {"whole", question.is_whole}});
      break;
    case QuestionKind::text:
      object["longest"] = question.longest;
      break;
  }
  return object;
}

json check_answer(const Question& question, JsonObject& answers) {
  const std::string& name = question.name;
  switch (question.kind) {
    case QuestionKind::choice:
      return answers.choice(name, question.choices);
    case QuestionKind::scale:
      return answers.whole(name, 1, question.points);
    case QuestionKind::number: {
      const double number = answers.number(name, question.least, question.most);
      if (question.is_whole && number != std::floor(number)) {
        answers.fail(name, "must be a whole number");
      }
      return question.is_whole ? json(static_cast<std::int64_t>(number)) : json(number);
    }
    case QuestionKind::text:
      break;
  }
  return read_words(answers, name.c_str(), bytes_a_character * question.longest);
}

// The question in words, with those at the ends of a scale.
std::string words_of(const Question& question) {
  return question.kind != QuestionKind::scale
             ? question.text
             : fmt::format("{} (1: {}; {}: {})", question.text, question.low, question.points,
                           question.high);
}

}  // namespace

const Questionnaire* Questionnaires::find(const std::string& part) const {
  const Questionnaire* found = part == "screen"   ? &screen
                               : part == "before" ? &before
                               : part == "after"  ? &after
                                                  : nullptr;
  return found == nullptr || found->empty() ? nullptr : found;
}

Questionnaire screen_questions() {
  const auto number = [](const char* name, const char* text, double least, double most,
                         bool is_required) {
    Question question;
    question.name = name;
    question.kind = QuestionKind::number;
    question.text = text;
    question.is_required = is_required;
    question.least = least;
    question.most = most;
    return question;
  };
  return {
      number("px_per_mm", "CSS pixels a millimetre of the screen, by a card held to it", 1, 20,
             false),
      number("viewing_distance_mm",
             "Distance from the eyes to the screen, as estimated by the "
             "participant",
             200, 3000, true),
      number("refresh_rate_hz", "How often a second the browser redraws, median", 1, 2000, false)};
}

Questionnaires read_questionnaires(JsonObject& object, const std::string& file) {
  std::set<std::string> names;
  Questionnaires questionnaires;
  if (object.has("measure_screen") && object.flag("measure_screen")) {
    questionnaires.screen = screen_questions();
  }
  questionnaires.before = read_one(object, "questionnaire_before", file, names);
  questionnaires.after = read_one(object, "questionnaire_after", file, names);
  return questionnaires;
}

json to_json(const Questionnaires& questionnaires) {
  json object = json::object();
  for (const char* part : questionnaire_parts) {
    const Questionnaire* questionnaire = questionnaires.find(part);
    if (questionnaire == nullptr) continue;
    for (const Question& question : *questionnaire) object[part].push_back(to_json(question));
  }
  return object;
}

Questionnaires questionnaires_from_json(JsonObject object, const std::string& file) {
  std::set<std::string> names;
  Questionnaires questionnaires;
  questionnaires.screen = read_one(object, "screen", file, names);
  questionnaires.before = read_one(object, "before", file, names);
  questionnaires.after = read_one(object, "after", file, names);
  object.finish();
  return questionnaires;
}

json check_answers(const Questionnaire& questionnaire, JsonObject answers) {
  json kept = json::object();
  for (const Question& question : questionnaire) {
    if (!answers.has(question.name) && !question.is_required) continue;
    kept[question.name] = {{"question", words_of(question)},
                           {"answer", check_answer(question, answers)}};
  }
  answers.finish();
  return kept;
}

}  // namespace pinchlab::study
