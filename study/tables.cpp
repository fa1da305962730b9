// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/tables.h"

#include <fmt/format.h>

#include <stdexcept>
#include <vector>

#include "base/answer_file.h"
#include "base/csv.h"
#include "base/durable_file.h"
#include "base/strict_json.h"
#include "study/answers.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using nlohmann::ordered_json;

constexpr std::size_t largest_file = 16U << 20U;  // bytes

// A text that a spreadsheet would take for a formula gets an apostrophe before it, which
// spreadsheets do not show; numbers stay as they are.
std::string harmless(const std::string& text) {
  const bool is_number = text.find_first_not_of("+-.0123456789eE") == std::string::npos;
  const bool is_formula =
      !is_number && std::string_view("=+-@\t\r").find(text.front()) != std::string_view::npos;
  return (is_formula ? "'" : "") + text;
}

std::string value_of(const json& object, const char* key) {
  if (!object.contains(key)) {
    return "";
  }
  const json& value = object[key];
  return value.is_string() ? value.get<std::string>() : value.dump();
}

// The method under test is called pinch, the other cable, as the statistics expect of CSV files.
std::string choice(const json& trial) {
  if (trial["kind"] == "attention") {
    return trial["choice"] == trial["expected"] ? "pass" : "fail";
  }
  return trial[trial["choice"].get<std::string>()] == "pinch" ? "pinch" : "cable";
}

std::string pinch_side(const json& trial) {
  return trial["left"] == "pinch" ? "left" : trial["right"] == "pinch" ? "right" : "";
}

// A column of the answers. One without `value` is the trial's key of that name.
struct Column {
  const char* name;
  const char* description;
  std::string (*value)(const json& file, const json& trial) = nullptr;
};

const std::vector<Column> columns = {
    {"participant", "Random name of the participant",
     [](const json& file, const json&) { return value_of(file, "participant"); }},
    {"participant_number", "Number that the plan was counterbalanced by, from 0",
     [](const json& file, const json&) { return value_of(file, "participant_number"); }},
    {"position", "Place of the trial in the session, from 1"},
    {"kind", "main: an answer of the study; training: for practice; attention: has a right answer"},
    {"demonstration", "What was shown"},
    {"side", "Side that showed pinch joints",
     [](const json&, const json& trial) { return pinch_side(trial); }},
    {"choice", "What was chosen: pinch or cable; in attention trials pass or fail",
     [](const json&, const json& trial) { return choice(trial); }},
    {"chosen_side", "Side that was chosen",
     [](const json&, const json& trial) { return value_of(trial, "choice"); }},
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
};

std::string row(const std::vector<std::string>& values) {
  std::string text;
  for (const std::string& value : values) {
    text += (text.empty() ? "" : ",") + csv_cell(harmless(value));
  }
  return text + "\n";
}

ordered_json description() {
  ordered_json variables = ordered_json::array();
  for (const Column& column : columns) {
    variables.push_back(
        {{"@type", "PropertyValue"}, {"name", column.name}, {"description", column.description}});
  }
  return {{"@context", "https://schema.org/"},
          {"@type", "Dataset"},
          {"name", "Which cable looks most realistic?"},
          {"description",
           "Two-alternative forced choices between simulations of cables with and without pinch "
           "joints, shown side by side. One row a trial."},
          {"variableMeasured", variables}};
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
                        {is_check ? "expected" : "pinch", to_string(trial.pinch)}});
    }
    all.push_back({{"participant_number", number}, {"trials", trials}});
  }
  return {{"format", "pinchlab-plan 1"}, {"seed", seed}, {"participants", all}};
}

std::string plan_csv(std::uint64_t seed, std::uint64_t participants, const PlanOptions& options) {
  std::string csv = "participant_number,position,kind,demonstration,pinch_side,expected_side\n";
  for (std::uint64_t number = 0; number < participants; ++number) {
    int position = 0;
    for (const PlannedTrial& trial : make_plan(seed, number, options)) {
      const bool is_check = trial.kind == TrialKind::attention;
      const std::string side = to_string(trial.pinch);
      csv += row({std::to_string(number), std::to_string(++position), to_string(trial.kind),
                  trial.demonstration, is_check ? "" : side, is_check ? side : ""});
    }
  }
  return csv;
}

std::string answers_csv(const fs::path& folder) {
  std::vector<std::string> names;
  names.reserve(columns.size());
  for (const Column& column : columns) {
    names.emplace_back(column.name);
  }
  std::string csv = row(names);
  SameStudy same_study;
  for (const fs::path& path : answer_files(folder)) {
    const json file = read_json_file(path, largest_file);
    same_study.check(parse_answer_file(file, path.string()), path.string());
    for (const json& trial : file["trials"]) {
      std::vector<std::string> values;
      values.reserve(columns.size());
      for (const Column& column : columns) {
        values.push_back(column.value != nullptr ? column.value(file, trial)
                                                 : value_of(trial, column.name));
      }
      csv += row(values);
    }
  }
  return csv;
}

void write_psych_ds(const fs::path& folder, const fs::path& out) {
  const std::string csv = answers_csv(folder);
  if (fs::exists(out) && !(fs::is_directory(out) && fs::is_empty(out))) {
    throw std::runtime_error(
        fmt::format("{}: is there already; name a new folder, or empty it", out.string()));
  }
  fs::create_directories(out / "data");
  write_durably(out / "data" / "study-cables_data.csv", csv);
  write_durably(out / "README.md", dataset_readme);
  write_durably(out / "dataset_description.json", description().dump(2) + "\n");
}

}  // namespace pinchlab::study
