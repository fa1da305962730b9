// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/levels_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "analysis/besides.h"
#include "analysis/circumstances.h"
#include "analysis/csv_columns.h"
#include "analysis/csv_inputs.h"
#include "analysis/distinct_inputs.h"
#include "analysis/groups.h"
#include "base/answer_file.h"
#include "base/csv_reader.h"
#include "base/input_error.h"
#include "base/text_checks.h"

namespace pinchlab::analysis {

namespace fs = std::filesystem;

namespace {

enum Column { level, correct, trials, choice, participant, demonstration, kind, pilot, position };
const std::vector<std::string> column_names{"level",  "correct",     "trials",
                                            "choice", "participant", "demonstration",
                                            "kind",   "pilot",       "position"};
// What the tidy form may hold besides, which no threshold depends on.
const std::vector<std::string> other_columns{"group", "side", "reaction_time_s", "left", "right"};

struct NaturalLess {
  bool operator()(const std::string& a, const std::string& b) const { return natural_less(a, b); }
};
// series -> participant -> level -> cell
using Cells =
    std::map<std::string, std::map<std::string, std::map<double, LevelCell>>, NaturalLess>;

void add(Cells& cells, const std::string& series, const std::string& person,
         const LevelCell& cell) {
  LevelCell& sum = cells[series][person][cell.level];
  sum.level = cell.level;
  sum.trials += cell.trials;
  sum.hits += cell.hits;
}

LevelCell cell_of(const CsvColumns& csv, const ReadOptions& options) {
  LevelCell cell;
  const auto value = parse_number(csv.at(level));
  if (!value || std::abs(*value) > 1e9) {
    csv.fail(fmt::format("level `{}` is not a number from -1e9 to 1e9 (with a decimal point)",
                         csv.at(level).substr(0, 60)));
  }
  cell.level = *value;
  cell.trials = csv.has(trials) ? csv.whole(trials, 1, 1000000000) : 1;
  if (csv.has(correct)) {
    cell.hits = csv.whole(correct, 0, static_cast<long>(cell.trials));
  } else {
    const std::string_view chosen = csv.at(choice);
    if (chosen != options.pinch_value && chosen != options.cable_value) {
      csv.fail(
          fmt::format("choice `{}` is unknown; it must be `{}` or `{}` (other names: "
                      "--pinch-value, --cable-value)",
                      chosen.substr(0, 60), options.pinch_value, options.cable_value));
    }
    cell.hits = chosen == options.pinch_value ? 1 : 0;
  }
  return cell;
}

// Returns whether hits are correct answers.
bool read_csv(const fs::path& path, const ReadOptions& options, Exclusions& exclusions,
              SameStudy& same_study, DistinctInputs& distinct, Cells& cells) {
  CsvColumns csv(path, options, column_names, other_columns);
  if (csv.has(correct) == csv.has(choice))
    csv.fail("a table of levels needs either a column `correct` or a column `choice`");
  if (csv.has(trials) && !csv.has(correct))
    csv.fail("a column `trials` needs a column `correct` of counts");
  while (csv.next()) {
    const std::string person = csv.name(participant);
    if (exclusions.excluded(person)) continue;
    csv.check_pilot(pilot, same_study);
    if (!csv.is_main(kind)) continue;
    distinct.has_rows_of(person, path.string());
    csv.check_position(position, person);
    const std::string series = csv.name(demonstration);
    const LevelCell cell = cell_of(csv, options);
    if (cell.trials > 1) {
      csv.check_totals(
          fmt::format("{}\n{}\n{} {} {}", person, series, cell.level, cell.trials, cell.hits));
    }
    add(cells, series, person, cell);
  }
  return csv.has(correct);
}

// Whether some of a series' answers are a participant's, and others are of who knows whom.
bool mixes_names(const Cells::value_type& series) {
  return series.second.size() > 1 && series.second.contains("");
}

void read_file(const AnswerFile& file, Cells& cells) {
  for (const Trial& trial : file.trials) {
    if (trial.kind != TrialKind::main) continue;
    const std::string& chosen = trial.choice == Side::left ? trial.left : trial.right;
    add(cells, trial.demonstration, file.participant,
        {trial.level, 1, chosen == file.graded_hit ? 1 : 0});
  }
}

}  // namespace

bool has_levels(const fs::path& path, const ReadOptions& options) {
  return has_columns(path, options, {"level"}) || kind_of_answers(path) == AnswersKind::graded;
}

LevelsTable read_levels(const std::vector<fs::path>& inputs, const ReadOptions& options) {
  LevelsTable table;
  Exclusions exclusions(options);
  const auto excluded = [&](const std::string& name) { return exclusions.excluded(name); };
  Cells cells;
  DistinctInputs distinct;
  SameStudy same_study;
  for (const fs::path& input : inputs) {
    if (!has_levels(input, options)) {
      throw InputError(input.string(),
                       "has no levels, but another input has; analyse them in two runs");
    }
    distinct.add(input);
    bool is_correct = true;
    if (has_columns(input, options, {"level"})) {
      is_correct = read_csv(input, options, exclusions, same_study, distinct, cells);
    } else {
      for (const NamedAnswerFile& named :
           read_answer_files(input, options.allow_missing, same_study, excluded)) {
        table.has_session_records = true;
        distinct.has_file_of(named.file.participant, named.name);
        read_file(named.file, cells);
        note(named.file, table.sessions[named.file.participant]);
        std::ranges::move(besides_of(named.file), std::back_inserter(table.besides));
      }
    }
    if (!table.sources.empty() && is_correct != table.correct) {
      throw InputError(input.string(), "has another kind of answers (`correct` or `choice`) than " +
                                           table.sources.front());
    }
    table.correct = is_correct;
    table.sources.push_back(input.string());
  }
  table.is_pilot = same_study.is_pilot();
  table.exclusions = exclusions.finish();
  if (cells.empty()) throw InputError(table.sources.front(), why_nothing_is_left(table.exclusions));
  if (std::ranges::any_of(cells, mixes_names)) {
    throw InputError(table.sources.front(),
                     "some inputs name participants and some do not; analyse them in two runs");
  }
  for (const auto& [series_name, people] : cells) {
    Series series{series_name, {}};
    for (const auto& [person, levels] : people) {
      Observer observer{person, {}};
      for (const auto& [value, cell] : levels) observer.cells.push_back(cell);
      series.observers.push_back(std::move(observer));
    }
    table.series.push_back(std::move(series));
  }
  return table;
}

}  // namespace pinchlab::analysis
