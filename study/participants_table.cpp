// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/participants_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/design_file.h"

namespace pinchlab::study {
namespace {

using nlohmann::json;

// What an exclusion rule is about, of one participant; empty where the file does not hold it.
std::string measured(const json& file, const char* key) {
  const auto rule = std::ranges::find(exclusion_rules(), key, &ExclusionRule::key);
  const double value = measure(*rule, file);
  return std::isnan(value) ? "" : fmt::format("{}", value);
}

std::string of_first_trial(const json& file, const char* key) {
  return value_of(file["trials"].front(), key);
}

std::string free_text(const json& file, const char* key) {
  return file.contains("free_text") ? value_of(file["free_text"], key) : "";
}

std::string recruited(const json& file, const char* key) {
  return file.contains("recruited") ? value_of(file["recruited"], key) : "";
}

struct ParticipantColumn {
  const char* name;
  const char* description;
  std::string (*value)(const json& file) = nullptr;  // without: the file's key of that name
};

const std::vector<ParticipantColumn> participant_columns = {
    {"participant", "Random name of the participant"},
    {"participant_number", "Number that the plan was counterbalanced by, from 0"},
    {"language", "Of the page"},
    {"started_utc", "When the participant began"},
    {"saved_utc", "When the answers were saved"},
    {"resumed_count", "Times that the page was loaded again"},
    {"software_version", "Of the program that served the study"},
    {"seed", "Of the plan"},
    {"pilot", "true: an answer of a trial run"},
    {"consent_version", "Of the information that the participant agreed to",
     [](const json& file) {
       return file.contains("study") ? value_of(file["study"], "consent_version") : "";
     }},
    {"answers", "Main trials",
     [](const json& file) {
       return std::to_string(std::ranges::count(file["trials"], json("main"),
                                                [](const json& trial) { return trial["kind"]; }));
     }},
    {"one_side_share", "Share of main trials in which the side that was chosen more often was",
     [](const json& file) { return measured(file, "one_side_over"); }},
    {"median_reaction_time_s", "Seconds from the moment the buttons appeared, of main trials",
     [](const json& file) { return measured(file, "median_reaction_time_s_under"); }},
    {"failed_checks", "Attention checks without the right answer",
     [](const json& file) { return measured(file, "failed_checks_over"); }},
    {"focus_lost_count", "Times the window lost the focus or was hidden in main trials",
     [](const json& file) { return measured(file, "focus_lost_over"); }},
    {"dropped_frames_share", "Share of the frames of main trials that the browser dropped",
     [](const json& file) { return measured(file, "dropped_frames_over"); }},
    {"smallest_clip_width_px", "Least width at which a main trial was shown, CSS pixels",
     [](const json& file) { return measured(file, "clip_width_px_under"); }},
    {"screen_width_px", "Width of the screen in the first trial, CSS pixels",
     [](const json& file) { return of_first_trial(file, "screen_width_px"); }},
    {"screen_height_px", "Height of the screen in the first trial, CSS pixels",
     [](const json& file) { return of_first_trial(file, "screen_height_px"); }},
    {"device_pixel_ratio", "Device pixels a CSS pixel in the first trial",
     [](const json& file) { return of_first_trial(file, "device_pixel_ratio"); }},
    {"user_agent", "What the browser says it is"},
    {"common_details", "Optional text: details that choices were based on",
     [](const json& file) { return free_text(file, "common_details"); }},
    {"thoughts", "Optional text: thoughts about the test",
     [](const json& file) { return free_text(file, "thoughts"); }}};

// Ids of the site that sent the participants: for its researchers, not for data that are shared.
const std::vector<ParticipantColumn> id_columns = {
    {"recruited_participant", "Id of the participant at the site that sent them",
     [](const json& file) { return recruited(file, "participant"); }},
    {"recruited_study", "Id of the study there",
     [](const json& file) { return recruited(file, "study"); }},
    {"recruited_session", "Id of the session there",
     [](const json& file) { return recruited(file, "session"); }}};

bool is_recruited(const json& file) {
  return file.contains("recruited");
}

}  // namespace

std::string value_of(const json& object, const char* key) {
  if (!object.contains(key)) return "";
  const json& value = object[key];
  return value.is_string() ? value.get<std::string>() : value.dump();
}

QuestionColumns question_columns(const std::vector<json>& files) {
  QuestionColumns columns;
  for (const json& file : files) {
    if (!file.contains("questionnaires")) continue;
    for (const auto& [part, answers] : file["questionnaires"].items()) {
      for (const auto& [name, entry] : answers.items()) {
        columns[std::string(part).append("_").append(name)] = entry["question"];
      }
    }
  }
  return columns;
}

std::string own_answer(const json& file, const std::string& column) {
  const std::size_t line = column.find('_');
  const json part =
      file.value("questionnaires", json::object()).value(column.substr(0, line), json::object());
  const auto found = part.find(column.substr(line + 1));
  return found == part.end() ? "" : value_of(*found, "answer");
}

ParticipantsTable participants_table(const std::vector<json>& files, bool with_ids) {
  std::vector<ParticipantColumn> columns = participant_columns;
  if (with_ids && std::ranges::any_of(files, is_recruited)) {
    columns.insert(columns.end(), id_columns.begin(), id_columns.end());
  }
  ParticipantsTable table;
  for (const ParticipantColumn& column : columns) {
    table.names.emplace_back(column.name);
    table.descriptions.emplace_back(column.description);
  }
  const QuestionColumns own = question_columns(files);
  for (const auto& [name, question] : own) {
    table.names.push_back(name);
    table.descriptions.push_back(question);
  }
  for (const json& file : files) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    for (const ParticipantColumn& column : columns) {
      cells.push_back(column.value != nullptr ? column.value(file) : value_of(file, column.name));
    }
    for (const auto& [name, question] : own) cells.push_back(own_answer(file, name));
  }
  return table;
}

}  // namespace pinchlab::study
