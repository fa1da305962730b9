// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/comparisons_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "analysis/besides.h"
#include "analysis/circumstances.h"
#include "analysis/csv_columns.h"
#include "analysis/distinct_inputs.h"
#include "base/answer_file.h"
#include "base/input_error.h"
#include "base/text_checks.h"

namespace pinchlab::analysis {

namespace fs = std::filesystem;

namespace {

enum Column {
  left,
  right,
  choice,
  left_wins,
  right_wins,
  ties,
  participant,
  demonstration,
  kind,
  pilot,
  position
};
const std::vector<std::string> column_names{"left",       "right", "choice",      "left_wins",
                                            "right_wins", "ties",  "participant", "demonstration",
                                            "kind",       "pilot", "position"};
const std::vector<std::string> other_columns{"group", "reaction_time_s", "preference"};

constexpr long most_answers = 1000000000;

// A record in words.
struct Row {
  std::string participant, demonstration, left, right;
  std::int64_t left_wins = 0, right_wins = 0, ties = 0;
};

Row row_of(const CsvColumns& csv) {
  Row row{csv.name(participant), csv.name(demonstration), csv.name(left), csv.name(right), 0, 0, 0};
  if (row.left == row.right)
    csv.fail(fmt::format("`{}` is compared with itself; a pair shows two methods", row.left));
  if (csv.has(choice)) {
    if (row.left == "tie" || row.right == "tie") {
      csv.fail(
          "`tie` as `choice` is neither of the two, so that no method can have that name; "
          "give it another");
    }
    const std::string_view chosen = csv.at(choice);
    row.left_wins = chosen == row.left ? 1 : 0;
    row.right_wins = chosen == row.right ? 1 : 0;
    row.ties = chosen == "tie" ? 1 : 0;
    if (row.left_wins + row.right_wins + row.ties == 0) {
      csv.fail(fmt::format("choice `{}` must be `{}`, `{}` or `tie`", chosen.substr(0, 60),
                           row.left, row.right));
    }
  } else {
    row.left_wins = csv.whole(left_wins, 0, most_answers);
    row.right_wins = csv.whole(right_wins, 0, most_answers);
    row.ties = csv.has(ties) ? csv.whole(ties, 0, most_answers) : 0;
  }
  return row;
}

void read_csv(const fs::path& path, const ReadOptions& options, Exclusions& exclusions,
              SameStudy& same_study, DistinctInputs& distinct, std::vector<Row>& rows) {
  CsvColumns csv(path, options, column_names, other_columns);
  const bool has_counts = csv.has(left_wins) && csv.has(right_wins);
  if (csv.has(choice) == has_counts || (csv.has(ties) && !has_counts)) {
    csv.fail(
        "comparisons need either a column `choice`, or `left_wins`, `right_wins` and, if there are "
        "any, `ties`");
  }
  while (csv.next()) {
    if (exclusions.excluded(csv.name(participant))) continue;
    csv.check_pilot(pilot, same_study);
    if (!csv.is_main(kind)) continue;
    rows.push_back(row_of(csv));
    const Row& row = rows.back();
    csv.check_position(position, row.participant);
    if (row.left_wins + row.right_wins + row.ties > 1) {
      csv.check_totals(fmt::format("{}\n{}\n{}\n{}\n{} {} {}", row.participant, row.demonstration,
                                   row.left, row.right, row.left_wins, row.right_wins, row.ties));
    }
    distinct.has_rows_of(rows.back().participant, path.string());
  }
}

void read_file(const AnswerFile& file, std::vector<Row>& rows) {
  for (const Trial& trial : file.trials) {
    if (trial.kind != TrialKind::main) continue;
    rows.push_back({file.participant, trial.demonstration, trial.left, trial.right,
                    trial.choice == Side::left ? 1 : 0, trial.choice == Side::right ? 1 : 0,
                    trial.choice == Side::unknown ? 1 : 0});
  }
}

// Names in natural order, and where each is.
std::vector<std::string> sorted(const std::set<std::string>& names,
                                std::map<std::string, std::size_t>& place) {
  std::vector<std::string> result(names.begin(), names.end());
  std::ranges::stable_sort(result, natural_less);
  for (std::size_t i = 0; i < result.size(); ++i) place[result[i]] = i;
  return result;
}

void fill(const std::vector<Row>& rows, ComparisonsTable& table) {
  std::set<std::string> methods, people, demonstrations;
  for (const Row& row : rows) {
    methods.insert({row.left, row.right});
    demonstrations.insert(row.demonstration);
    if (row.participant.empty()) continue;
    people.insert(row.participant);
  }
  const bool some_unknown =
      std::ranges::any_of(rows, [](const Row& row) { return row.participant.empty(); });
  if (!people.empty() && some_unknown) {
    throw InputError(table.sources.front(),
                     "some inputs name participants and some do not; analyse them in two runs");
  }
  constexpr std::size_t most_methods = 100;
  if (methods.size() > most_methods) {
    throw InputError(table.sources.front(), fmt::format("{} methods; at most {} have a scale",
                                                        methods.size(), most_methods));
  }
  std::map<std::string, std::size_t> method, person, demonstration;
  table.methods = sorted(methods, method);
  table.demonstrations = sorted(demonstrations, demonstration);
  table.participants = sorted(people, person);
  for (const Row& row : rows) {
    const PairChoices pair{
        row.participant.empty() ? 0U : static_cast<std::uint32_t>(person[row.participant]),
        static_cast<std::uint16_t>(demonstration[row.demonstration]),
        static_cast<std::uint16_t>(method[row.left]),
        static_cast<std::uint16_t>(method[row.right]),
        row.left_wins,
        row.right_wins,
        row.ties};
    if (pair.total() == 0) continue;
    table.answers += pair.total();
    table.ties += pair.ties;
    table.choices.push_back(pair);
  }
  // So that sums do not depend on the order of the inputs.
  std::ranges::sort(table.choices, {}, [](const PairChoices& pair) {
    return std::tuple(pair.participant, pair.demonstration, pair.left, pair.right, pair.left_wins,
                      pair.right_wins, pair.ties);
  });
}

}  // namespace

bool has_comparisons(const fs::path& path, const ReadOptions& options) {
  return has_columns(path, options, {"left", "right"}) ||
         kind_of_answers(path) == AnswersKind::comparisons;
}

ComparisonsTable read_comparisons(const std::vector<fs::path>& inputs, const ReadOptions& options) {
  ComparisonsTable table;
  Exclusions exclusions(options);
  const auto excluded = [&](const std::string& name) { return exclusions.excluded(name); };
  std::vector<Row> rows;
  DistinctInputs distinct;
  SameStudy same_study;
  for (const fs::path& input : inputs) {
    if (!has_comparisons(input, options)) {
      throw InputError(input.string(),
                       "has no comparisons of named methods, but another input has; analyse them "
                       "in two runs");
    }
    distinct.add(input);
    table.sources.push_back(input.string());
    if (has_columns(input, options, {"left", "right"})) {
      read_csv(input, options, exclusions, same_study, distinct, rows);
      continue;
    }
    table.has_session_records = true;
    for (const NamedAnswerFile& named :
         read_answer_files(input, options.allow_missing, same_study, excluded)) {
      distinct.has_file_of(named.file.participant, named.name);
      read_file(named.file, rows);
      note(named.file, table.sessions[named.file.participant]);
      std::ranges::move(besides_of(named.file), std::back_inserter(table.besides));
    }
  }
  table.is_pilot = same_study.is_pilot();
  table.exclusions = exclusions.finish();
  fill(rows, table);
  if (table.answers == 0)
    throw InputError(table.sources.front(), why_nothing_is_left(table.exclusions));
  if (table.answers == table.ties)
    throw InputError(table.sources.front(), "all answers are ties; a scale needs choices");
  return table;
}

}  // namespace pinchlab::analysis
