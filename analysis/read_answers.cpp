// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/answers_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "analysis/csv_inputs.h"
#include "analysis/groups.h"
#include "analysis/table_builder.h"
#include "base/answer_file.h"
#include "base/input_error.h"
#include "base/strict_json.h"

namespace pinchlab::analysis {

namespace fs = std::filesystem;

namespace {

constexpr size_t answer_file_limit_bytes = size_t{16} << 20;

// The answer files of a folder: every *.json but the description that the Psych-DS layout puts
// there.
std::vector<fs::path> files_of_folder(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool hidden = name.starts_with('.');
    if (!entry.is_regular_file() || hidden || entry.path().extension() != ".json") continue;
    if (name != "dataset_description.json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) {
    throw InputError(folder.string(),
                     "no answer files (*.json) in this folder; name the folder that the study "
                     "page saves to");
  }
  return files;
}

// Reads answer files into the builder and watches over what must agree between them.
class AnswerFiles {
 public:
  AnswerFiles(TableBuilder& builder, bool allow_missing)
      : builder_(builder), allow_missing_(allow_missing) {}

  void read(const fs::path& path) {
    const std::string name = path.string();
    const AnswerFile file = parse_answer_file(read_json_file(path, answer_file_limit_bytes), name);
    const auto [before, is_new] = file_of_.emplace(file.participant, name);
    if (!is_new) {
      throw InputError(name,
                       fmt::format("participant `{}` has a file already: {}; keep one of the two",
                                   file.participant, before->second));
    }
    if (builder_.excluded(file.participant)) return;
    check_plan(file, name);
    same_study_.check(file, name);
    builder_.begin_source(name);
    builder_.expect_answers_per_demonstration(file.answers_per_demonstration, name);
    builder_.note_session_records();
    for (size_t i = 0; i < file.trials.size(); ++i) add_trial(file, file.trials[i], i);
    if (!file.free_text.empty()) builder_.session(file.participant).free_text = file.free_text;
  }

 private:
  // The page saves whole sessions only, so the answers are those of the plan.
  void check_plan(const AnswerFile& file, const std::string& name) const {
    for (const std::string& demonstration : file.planned) {
      const auto count =
          std::count_if(file.trials.begin(), file.trials.end(), [&](const Trial& trial) {
            return trial.kind == TrialKind::main && trial.demonstration == demonstration;
          });
      const bool fewer = count < file.answers_per_demonstration;
      if (count == file.answers_per_demonstration || (fewer && allow_missing_)) continue;
      throw InputError(
          name,
          fmt::format("participant `{}` gave {} answers to demonstration `{}`, but the plan has "
                      "{}; leave the participant out with --exclude{}",
                      file.participant, count, demonstration, file.answers_per_demonstration,
                      fewer ? ", or pass --allow-missing" : ""));
    }
  }

  void add_trial(const AnswerFile& file, const Trial& trial, size_t index) {
    if (trial.kind == TrialKind::attention) {
      builder_.add_attention_check(file.participant, trial.choice == trial.expected);
    }
    if (trial.kind == TrialKind::main) {
      RawAnswer answer;
      answer.participant = file.participant;
      answer.demonstration = trial.demonstration;
      answer.pinch_side = trial.left == "pinch" ? Side::left : Side::right;
      answer.chose_pinch = trial.choice == answer.pinch_side;
      answer.position = trial.position;
      answer.reaction_time_s = trial.reaction_time_s;
      builder_.add_answer(answer, index + 1);
    }
    if (trial.focus_lost_count + trial.dropped_frames + trial.playback_errors > 0) {
      Session& session = builder_.session(file.participant);
      session.focus_lost_count += trial.focus_lost_count;
      session.dropped_frames += trial.dropped_frames;
      session.playback_errors += trial.playback_errors;
    }
  }

  TableBuilder& builder_;
  bool allow_missing_;
  std::map<std::string, std::string> file_of_;  // participant -> file
  SameStudy same_study_;
};

void check_no_input_twice(const std::vector<fs::path>& inputs) {
  std::set<fs::path> seen;
  for (const fs::path& input : inputs) {
    if (!fs::exists(input)) throw InputError(input.string(), "no such file or folder");
    if (!seen.insert(fs::canonical(input)).second) {
      throw InputError(input.string(), "is named twice among the inputs");
    }
  }
}

}  // namespace

AnswersTable read_answers(const std::vector<fs::path>& inputs, const ReadOptions& options) {
  if (inputs.empty())
    throw InputError("input", "name at least one answer file, folder or CSV file");
  check_no_input_twice(inputs);
  TableBuilder builder(options.exclude_file.empty() ? std::vector<Exclusion>{}
                                                    : read_exclusions(options.exclude_file),
                       options.allow_missing);
  AnswerFiles answer_files(builder, options.allow_missing);
  for (const fs::path& input : inputs) {
    if (fs::is_directory(input)) {
      for (const fs::path& file : files_of_folder(input)) answer_files.read(file);
    } else if (input.extension() == ".json") {
      answer_files.read(input);
    } else if (input.extension() == ".csv" || input.extension() == ".tsv") {
      builder.begin_source(input.string());
      read_csv_input(input, options, builder);
    } else {
      throw InputError(input.string(),
                       "unknown kind of file; answers come as .json, .csv or .tsv, or as a "
                       "folder of .json files");
    }
  }
  AnswersTable table = builder.finish();
  assign_groups(table, options.groups_file, builder.column_groups());
  return table;
}

}  // namespace pinchlab::analysis
