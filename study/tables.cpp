// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/answer_file.h"
#include "base/csv.h"
#include "base/durable_file.h"
#include "base/partial_file.h"
#include "base/text_checks.h"
#include "study/answers.h"
#include "study/participants_table.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using nlohmann::ordered_json;

// A text that a spreadsheet would take for a formula gets an apostrophe before it, which
// spreadsheets do not show; numbers stay as they are.
std::string harmless(const std::string& text) {
  const bool is_formula = !parse_number(text) &&
                          std::string_view("=+-@\t\r").find(text.front()) != std::string_view::npos;
  return (is_formula ? "'" : "") + text;
}

// The method under test is called pinch, the other cable, as the statistics expect of CSV files.
std::string choice(const json& trial) {
  if (trial["kind"] == "attention") {
    return trial["choice"] == trial["expected"] ? "pass" : "fail";
  }
  const std::string side = trial["choice"];
  const std::string chosen = trial.value(side, side);  // a tie is none of the sides
  return chosen == "baseline" ? "cable" : chosen;
}

std::string pinch_side(const json& trial) {
  return trial["left"] == "pinch" ? "left" : trial["right"] == "pinch" ? "right" : "";
}

// Kinds of studies that a column is for.
constexpr unsigned two_methods = 1, several_methods = 2, thresholds = 4, every_kind = 7;

unsigned kind_of(const json& file) {
  return file["plan"].contains("methods")      ? several_methods
         : file["plan"].contains("graded_hit") ? thresholds
                                               : two_methods;
}

// A column of the answers. One without `value` is the trial's key of that name.
struct Column {
  const char* name;
  const char* description;
  std::string (*value)(const json& file, const json& trial) = nullptr;
  unsigned kinds = every_kind;
  bool is_optional = false;  // left out where no trial, or file, has it
};

const std::vector<Column> columns = {
    {"participant", "Random name of the participant",
     [](const json& file, const json&) { return value_of(file, "participant"); }},
    {"participant_number", "Number that the plan was counterbalanced by, from 0",
     [](const json& file, const json&) { return value_of(file, "participant_number"); }},
    {"position", "Place of the trial in the session, from 1"},
    {"kind", "main: an answer of the study; training: for practice; attention: has a right answer"},
    {"pilot", "true: an answer of a trial run",
     [](const json& file, const json&) { return value_of(file, "pilot"); }, every_kind, true},
    {"demonstration", "What was shown"},
    {"left", "What the left side showed", nullptr, several_methods | thresholds},
    {"right", "What the right side showed", nullptr, several_methods | thresholds},
    {"level", "Of the graded clip", nullptr, thresholds},
    {"correct", "1: a hit, what the plan calls so was chosen; 0: it was not",
     [](const json& file, const json& trial) -> std::string {
       if (trial["kind"] == "attention") return trial["choice"] == trial["expected"] ? "1" : "0";
       const std::string chosen = trial[trial["choice"].get<std::string>()];
       return chosen == file["plan"]["graded_hit"] ? "1" : "0";
     },
     thresholds},
    {"side", "Side that showed pinch joints",
     [](const json&, const json& trial) { return pinch_side(trial); }, two_methods},
    {"choice",
     "What was chosen: pinch, cable or another method, or tie; in attention trials pass or fail",
     [](const json&, const json& trial) { return choice(trial); }, two_methods | several_methods},
    {"chosen_side", "Side that was chosen",
     [](const json&, const json& trial) { return value_of(trial, "choice"); }},
    {"expected", "Side that attention trials should have been answered with", nullptr, every_kind,
     true},
    {"reaction_time_s", "Seconds from the moment the buttons appeared to the choice"},
    {"loops_watched", "Whole loops of the clip before the choice"},
    {"focus_lost_count", "Times the window lost the focus or was hidden"},
    {"frame_count", "Frames that the browser decoded, dropped ones among them"},
    {"dropped_frames", "Frames that the browser dropped"},
    {"loop_gap_median_s", "Seconds that a loop took longer than the clip, middle of all loops"},
    {"loop_gap_max_s", "Seconds that a loop took longer than the clip, at most"},
    {"playback_error_count", "Messages of the player",
     [](const json&, const json& trial) {
       return trial.contains("playback_errors") ? std::to_string(trial["playback_errors"].size())
                                                : "";
     }},
    {"playback_errors", "What the player said, one after the other",
     [](const json&, const json& trial) {
       std::string all;
       for (const json& one : trial.value("playback_errors", json::array())) {
         all += (all.empty() ? "" : " | ") + one.get<std::string>();
       }
       return all;
     }},
    {"clip", "File that was played"},
    {"shown_utc", "When the clip began"},
    {"input", "What the choice was made with: mouse, keyboard or touch"},
    {"window_width_px", "Width of the window, CSS pixels"},
    {"window_height_px", "Height of the window, CSS pixels"},
    {"clip_width_px", "Width at which the clip was shown, CSS pixels"},
    {"clip_height_px", "Height at which the clip was shown, CSS pixels"},
    {"screen_width_px", "Width of the screen, CSS pixels"},
    {"screen_height_px", "Height of the screen, CSS pixels"},
    {"device_pixel_ratio", "Device pixels a CSS pixel"},
    {"preference", "From -3, left by far, over 0, a tie, to 3, right by far", nullptr, every_kind,
     true},
    {"confidence", "How sure the participant was, from 1", nullptr, every_kind, true},
    {"reason", "What the participant wrote about this choice", nullptr, every_kind, true},
    {"where_side", "Clip in which the participant marked where it looks wrong", nullptr, every_kind,
     true},
    {"where_x", "Share of that clip's width, from its left edge", nullptr, every_kind, true},
    {"where_y", "Share of its height, from its upper edge", nullptr, every_kind, true},
    {"where_time_s", "Seconds of the clip at that moment", nullptr, every_kind, true},
};

std::string row(const std::vector<std::string>& values) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += (i == 0 ? "" : ",") + csv_cell(harmless(values[i]));
  }
  return text + "\n";
}

// Psych-DS recommends one (MISSING_README_DOC).
constexpr const char* dataset_readme =
    "# Which cable looks most realistic?\n\n"
    "Answers of the perception study of Pinchlab, exported by `pinchlab study export --psych-ds`.\n"
    "`dataset_description.json` says what each column of `data/study-cables_data.csv` means. "
    "Answers\n"
    "of the kinds training and attention are no answers of the study.\n";

}  // namespace

ordered_json plan_json(std::uint64_t seed, std::uint64_t participants, const PlanOptions& options) {
  ordered_json all = ordered_json::array();
  for (std::uint64_t number = 0; number < participants; ++number) {
    ordered_json trials = ordered_json::array();
    for (const PlannedTrial& trial : make_plan(seed, number, options)) {
      const bool is_check = trial.kind == TrialKind::attention;
      trials.push_back({{"position", trials.size() + 1},
                        {"kind", to_string(trial.kind)},
                        {"demonstration", trial.demonstration},
                        {is_check ? "expected" : trial.first, to_string(trial.pinch)}});
      if (clip_key(trial) != trial.demonstration) {
        trials.back()[trial.second] = to_string(opposite(trial.pinch));
      }
      if (trial.level) trials.back()["level"] = *trial.level;
    }
    all.push_back({{"participant_number", number}, {"trials", trials}});
  }
  return {{"format", "pinchlab-plan 1"}, {"seed", seed}, {"participants", all}};
}

std::string plan_csv(std::uint64_t seed, std::uint64_t participants, const PlanOptions& options) {
  std::string csv =
      "participant_number,position,kind,demonstration,left,right,level,expected_side\n";
  for (std::uint64_t number = 0; number < participants; ++number) {
    int position = 0;
    for (const PlannedTrial& trial : make_plan(seed, number, options)) {
      const bool is_check = trial.kind == TrialKind::attention;
      const std::string side = to_string(trial.pinch);
      const bool is_left = trial.pinch == Side::left;
      csv += row({std::to_string(number), std::to_string(++position), to_string(trial.kind),
                  trial.demonstration,
                  is_check  ? "check"
                  : is_left ? trial.first
                            : trial.second,
                  is_check  ? "check"
                  : is_left ? trial.second
                            : trial.first,
                  trial.level ? fmt::format("{}", *trial.level) : "", is_check ? side : ""});
    }
  }
  return csv;
}

namespace {

using Cells = std::vector<std::string>;

// The answers of a folder: the columns of its kind of study, and each participant's rows.
struct Answers {
  std::vector<const Column*> columns;  // of trials
  QuestionColumns questions;           // of participants, in each of their rows
  Cells names;                         // of both
  std::vector<std::pair<json, std::vector<Cells>>> participants;  // answer file, rows
};

std::vector<json> files_of(const Answers& answers) {
  std::vector<json> files;
  for (const auto& [file, rows] : answers.participants) files.push_back(file);
  return files;
}

std::vector<const Column*> columns_of(const std::vector<json>& files) {
  const unsigned kind = files.empty() ? two_methods : kind_of(files.front());
  const auto is_there = [&](const Column& column) {
    return std::ranges::any_of(files, [&](const json& file) {
      return file.contains(column.name) ||
             std::ranges::any_of(file["trials"],
                                 [&](const json& trial) { return trial.contains(column.name); });
    });
  };
  std::vector<const Column*> chosen;
  for (const Column& column : columns) {
    const bool is_of_kind = (column.kinds & kind) != 0;
    if (is_of_kind && (!column.is_optional || is_there(column))) chosen.push_back(&column);
  }
  return chosen;
}

Answers read_folder(const fs::path& folder) {
  Answers answers;
  SameStudy same_study;
  for (const fs::path& path : answer_files(folder)) {
    json file = read_answer_json(path);
    same_study.check(parse_answer_file(file, path.string()), path.string());
    answers.participants.emplace_back(std::move(file), std::vector<Cells>());
  }
  const std::vector<json> files = files_of(answers);
  answers.columns = columns_of(files);
  answers.questions = question_columns(files);
  for (const Column* column : answers.columns) answers.names.emplace_back(column->name);
  for (const auto& [name, question] : answers.questions) answers.names.push_back(name);
  for (auto& [file, rows] : answers.participants) {
    for (const json& trial : file["trials"]) {
      Cells& values = rows.emplace_back();
      for (const Column* column : answers.columns) {
        values.push_back(column->value != nullptr ? column->value(file, trial)
                                                  : value_of(trial, column->name));
      }
      for (const auto& [name, question] : answers.questions) {
        values.push_back(own_answer(file, name));
      }
    }
  }
  return answers;
}

ordered_json description(const Answers& answers) {
  ordered_json variables = ordered_json::array();
  const auto add = [&](const std::string& name, const std::string& what) {
    variables.push_back({{"@type", "PropertyValue"}, {"name", name}, {"description", what}});
  };
  for (const Column* column : answers.columns) add(column->name, column->description);
  for (const auto& [name, question] : answers.questions) add(name, question);
  return {{"@context", "https://schema.org/"},
          {"@type", "Dataset"},
          {"name", "Which cable looks most realistic?"},
          {"description",
           "Forced choices between simulations of cables, shown side by side. One row a trial."},
          {"variableMeasured", variables}};
}

std::string csv_of(const Answers& answers) {
  std::string csv = row(answers.names);
  for (const auto& [file, rows] : answers.participants) {
    for (const Cells& values : rows) csv += row(values);
  }
  return csv;
}

std::string csv_of(const ParticipantsTable& table) {
  std::string csv = row(table.names);
  for (const Cells& cells : table.rows) csv += row(cells);
  return csv;
}

// BIDS writes what is not there as n/a, and has no quotes for tabs and ends of lines.
std::string tsv_row(const Cells& cells) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::string text = cells[i].empty() ? "n/a" : cells[i];
    std::ranges::replace_if(
        text, [](char c) { return c == '\t' || c == '\n' || c == '\r'; }, ' ');
    line += (i == 0 ? "" : "\t") + text;
  }
  return line + "\n";
}

}  // namespace

std::string answers_csv(const fs::path& folder) {
  return csv_of(read_folder(folder));
}

std::string participants_csv(const fs::path& folder) {
  return csv_of(participants_table(files_of(read_folder(folder)), true));
}

std::string shared_csv(const fs::path& folder) {
  return csv_of(participants_table(files_of(read_folder(folder)), false));
}

void write_new_folder(const std::map<std::string, std::string>& files, const fs::path& out) {
  if (fs::exists(out) && !(fs::is_directory(out) && fs::is_empty(out))) {
    throw std::runtime_error(
        fmt::format("{}: is there already; name a new folder, or empty it", out.string()));
  }
  for (const auto& [name, bytes] : files) {
    make_folders((out / name).parent_path());
    write_durably(out / name, bytes);
  }
}

std::map<std::string, std::string> bids_files(const fs::path& folder) {
  const Answers answers = read_folder(folder);
  std::map<std::string, std::string> files;
  ParticipantsTable table = participants_table(files_of(answers), false);
  table.names.front() = "participant_id";
  std::string participants = tsv_row(table.names);
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    Cells& cells = table.rows[i];
    const std::string id = "sub-" + cells.front();
    cells.front() = id;
    participants += tsv_row(cells);
    std::string& trials = files[fmt::format("{}/beh/{}_task-cables_beh.tsv", id, id)];
    trials = tsv_row(answers.names);
    for (const Cells& values : answers.participants[i].second) trials += tsv_row(values);
  }
  files["participants.tsv"] = participants;
  ordered_json of_participants, of_trials = {{"TaskName", "cables"}};
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    of_participants[table.names[i]] = {{"Description", table.descriptions[i]}};
  }
  for (const Column* column : answers.columns) {
    of_trials[column->name] = {{"Description", column->description}};
  }
  for (const auto& [name, question] : answers.questions) {
    of_trials[name] = {{"Description", question}};
  }
  files["participants.json"] = of_participants.dump(2) + "\n";
  files["task-cables_beh.json"] = of_trials.dump(2) + "\n";
  const ordered_json dataset = {
      {"Name", "Which cable looks most realistic?"},
      {"BIDSVersion", "1.9.0"},
      {"DatasetType", "raw"},
      {"GeneratedBy", {{{"Name", "Pinchlab"}, {"Version", PINCHLAB_VERSION}}}}};
  files["dataset_description.json"] = dataset.dump(2) + "\n";
  files["README"] =
      "Answers of the perception study of Pinchlab, exported by `pinchlab study export --bids`.\n"
      "Forced choices between simulations of cables, shown side by side; one row a trial.\n";
  return files;
}

void write_bids(const fs::path& folder, const fs::path& out) {
  write_new_folder(bids_files(folder), out);
}

std::map<std::string, std::string> psych_ds_files(const fs::path& folder) {
  const Answers answers = read_folder(folder);
  return {{"data/study-cables_data.csv", csv_of(answers)},
          {"README.md", dataset_readme},
          {"dataset_description.json", description(answers).dump(2) + "\n"}};
}

void write_psych_ds(const fs::path& folder, const fs::path& out) {
  write_new_folder(psych_ds_files(folder), out);
}

}  // namespace pinchlab::study
