// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/answers_table.h"

#include <set>

#include "analysis/besides.h"
#include "analysis/circumstances.h"
#include "analysis/csv_inputs.h"
#include "analysis/groups.h"
#include "analysis/table_builder.h"
#include "base/answer_file.h"
#include "base/input_error.h"

namespace pinchlab::analysis {

namespace fs = std::filesystem;

namespace {

// Reads answer files into the builder and watches over what must agree between them.
class AnswerFiles {
 public:
  AnswerFiles(TableBuilder& builder, SameStudy& same_study, bool allow_missing)
      : builder_(builder), same_study_(same_study), allow_missing_(allow_missing) {}

  void read(const fs::path& path) {
    const auto excluded = [&](const std::string& name) { return builder_.excluded(name); };
    for (const NamedAnswerFile& named :
         read_answer_files(path, allow_missing_, same_study_, excluded)) {
      const AnswerFile& file = named.file;
      if (!file.methods.empty() || !file.graded_hit.empty()) {
        throw InputError(named.name,
                         "compares other methods than the rest of the inputs; analyse "
                         "each study in a run of its own");
      }
      builder_.begin_source(named.name);
      builder_.expect_answers_per_demonstration(file.answers_per_demonstration, named.name);
      builder_.note_session_records();
      for (size_t i = 0; i < file.trials.size(); ++i) add_trial(file, file.trials[i], i);
      note(file, builder_.session(file.participant));
      builder_.add_besides(besides_of(file));
    }
  }

 private:
  void add_trial(const AnswerFile& file, const Trial& trial, size_t index) {
    if (trial.kind != TrialKind::main) return;
    RawAnswer answer;
    answer.participant = file.participant;
    answer.demonstration = trial.demonstration;
    answer.pinch_side = trial.left == "pinch" ? Side::left : Side::right;
    answer.chose_pinch = trial.choice == answer.pinch_side;
    answer.position = trial.position;
    answer.reaction_time_s = trial.reaction_time_s;
    if (trial.preference) {
      answer.grade = (answer.pinch_side == Side::left ? -1 : 1) * *trial.preference;
    }
    builder_.add_answer(answer, index + 1);
  }

  TableBuilder& builder_;
  SameStudy& same_study_;
  bool allow_missing_;
};

// Answer files call the methods pinch and baseline, reports what the options say.
void name_methods(BesidesAnswer& answer, const ReadOptions& options) {
  const auto named = [&](std::string& method) {
    if (!method.empty()) method = method == "pinch" ? options.pinch_value : options.cable_value;
  };
  answer.first = options.pinch_value;
  answer.second = options.cable_value;
  named(answer.chosen);
  if (answer.place) named(answer.place->clip);
}

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
  TableBuilder builder(exclusions_of(options), options.allow_missing);
  SameStudy same_study;
  AnswerFiles answer_files(builder, same_study, options.allow_missing);
  for (const fs::path& input : inputs) {
    if (fs::is_directory(input) || input.extension() == ".json") {
      answer_files.read(input);
    } else if (input.extension() == ".csv" || input.extension() == ".tsv") {
      builder.begin_source(input.string());
      read_csv_input(input, options, same_study, builder);
    } else {
      throw InputError(input.string(),
                       "unknown kind of file; answers come as .json, .csv or .tsv, or as a "
                       "folder of .json files");
    }
  }
  AnswersTable table = builder.finish();
  table.is_pilot = same_study.is_pilot();
  for (BesidesAnswer& answer : table.besides) name_methods(answer, options);
  assign_groups(table, options.groups_file, builder.column_groups());
  return table;
}

}  // namespace pinchlab::analysis
