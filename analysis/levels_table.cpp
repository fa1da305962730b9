// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/levels_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "analysis/csv_inputs.h"
#include "analysis/groups.h"
#include "base/csv_reader.h"
#include "base/did_you_mean.h"
#include "base/input_error.h"
#include "base/text_checks.h"

namespace pinchlab::analysis {

namespace fs = std::filesystem;

namespace {

using Fields = std::vector<std::string_view>;

enum Column { level, correct, trials, choice, participant, demonstration, kind, known_columns };
const std::vector<std::string> column_names{
    "level", "correct", "trials", "choice", "participant", "demonstration", "kind",
    // What the tidy form may hold besides, which no threshold depends on:
    "group", "side", "position", "reaction_time_s"};

std::string name_in_file(const ReadOptions& options, const std::string& column) {
  const auto mapped = options.columns.find(column);
  return mapped == options.columns.end() ? column : mapped->second;
}

struct NaturalLess {
  bool operator()(const std::string& a, const std::string& b) const { return natural_less(a, b); }
};
// series -> participant -> level -> cell
using Cells =
    std::map<std::string, std::map<std::string, std::map<double, LevelCell>>, NaturalLess>;

class LevelsReader {
 public:
  LevelsReader(const fs::path& path, const ReadOptions& options)
      : options_(options), reader_(path, options.separator) {
    Fields fields;
    if (!reader_.next(fields)) throw InputError(reader_.place(), "the file is empty");
    width_ = fields.size();
    place_.fill(-1);
    std::vector<std::string> names;
    for (const std::string& column : column_names) names.push_back(name_in_file(options, column));
    for (size_t i = 0; i < fields.size(); ++i) {
      const auto found = std::find(names.begin(), names.end(), fields[i]);
      if (found == names.end()) {
        if (options.ignore_other_columns) continue;
        fail(
            fmt::format("unknown column `{}`{}; columns are {}. Name columns with --map-column, or "
                        "pass --ignore-other-columns",
                        fields[i], did_you_mean(fields[i], names), one_of(names)));
      }
      const auto column = static_cast<size_t>(found - names.begin());
      if (column >= known_columns) continue;
      if (place_[column] >= 0) fail(fmt::format("column `{}` stands twice", fields[i]));
      place_[column] = static_cast<int>(i);
    }
    if (has(correct) == has(choice))
      fail("a table of levels needs either a column `correct` or a column `choice`");
    if (has(trials) && !has(correct)) fail("a column `trials` needs a column `correct` of counts");
  }

  [[nodiscard]] bool has(Column column) const { return place_[column] >= 0; }

  void read(Cells& cells, std::map<std::string, bool>& excluded) {
    Fields fields;
    while (reader_.next(fields)) {
      if (fields.size() != width_) {
        fail(fmt::format("{} fields, but the first line has {}", fields.size(), width_));
      }
      const std::string person = name(fields, participant, "participant");
      if (const auto found = excluded.find(person); found != excluded.end()) {
        found->second = true;
        continue;
      }
      if (!is_main(fields)) continue;
      const LevelCell cell = cell_of(fields);
      LevelCell& sum = cells[name(fields, demonstration, "demonstration")][person][cell.level];
      sum.level = cell.level;
      sum.trials += cell.trials;
      sum.hits += cell.hits;
    }
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(reader_.place(), message);
  }
  [[nodiscard]] std::string_view at(const Fields& fields, Column column) const {
    return fields[static_cast<size_t>(place_[column])];
  }
  [[nodiscard]] std::string name(const Fields& fields, Column column, const char* what) const {
    if (!has(column)) return "";
    const std::string why = why_not_a_name(at(fields, column));
    if (!why.empty()) fail(fmt::format("bad {}: {}", what, why));
    return std::string(at(fields, column));
  }
  [[nodiscard]] bool is_main(const Fields& fields) const {
    if (!has(kind)) return true;
    const std::string_view value = at(fields, kind);
    if (value != "main" && value != "training" && value != "attention") {
      fail(fmt::format("kind `{}` is unknown; it must be `main`, `training` or `attention`",
                       value.substr(0, 60)));
    }
    return value == "main";
  }
  [[nodiscard]] std::int64_t whole(const Fields& fields, Column column, long low, long high) const {
    const auto number = parse_whole(at(fields, column), low, high);
    if (!number) {
      fail(fmt::format("{} `{}` is not a whole number from {} to {}", column_names[column],
                       at(fields, column).substr(0, 60), low, high));
    }
    return *number;
  }
  [[nodiscard]] LevelCell cell_of(const Fields& fields) const {
    LevelCell cell;
    const auto value = parse_number(at(fields, level));
    if (!value || std::abs(*value) > 1e9) {
      fail(fmt::format("level `{}` is not a number from -1e9 to 1e9 (with a decimal point)",
                       at(fields, level).substr(0, 60)));
    }
    cell.level = *value;
    cell.trials = has(trials) ? whole(fields, trials, 1, 1000000000) : 1;
    if (has(correct)) {
      cell.hits = whole(fields, correct, 0, static_cast<long>(cell.trials));
    } else {
      const std::string_view chosen = at(fields, choice);
      if (chosen != options_.pinch_value && chosen != options_.cable_value) {
        fail(
            fmt::format("choice `{}` is unknown; it must be `{}` or `{}` (other names: "
                        "--pinch-value, --cable-value)",
                        chosen.substr(0, 60), options_.pinch_value, options_.cable_value));
      }
      cell.hits = chosen == options_.pinch_value ? 1 : 0;
    }
    return cell;
  }

  const ReadOptions& options_;
  CsvReader reader_;
  size_t width_ = 0;
  std::array<int, known_columns> place_{};
};

}  // namespace

bool has_levels(const fs::path& path, const ReadOptions& options) {
  if (!fs::is_regular_file(path) || (path.extension() != ".csv" && path.extension() != ".tsv"))
    return false;
  CsvReader reader(path, options.separator);
  Fields fields;
  if (!reader.next(fields)) return false;
  return std::find(fields.begin(), fields.end(), name_in_file(options, "level")) != fields.end();
}

LevelsTable read_levels(const std::vector<fs::path>& inputs, const ReadOptions& options) {
  LevelsTable table;
  if (!options.exclude_file.empty()) table.exclusions = read_exclusions(options.exclude_file);
  std::map<std::string, bool> excluded;
  for (const Exclusion& exclusion : table.exclusions)
    excluded.emplace(exclusion.participant, false);
  Cells cells;
  std::set<fs::path> seen;
  for (const fs::path& input : inputs) {
    if (!has_levels(input, options)) {
      throw InputError(input.string(),
                       "has no column `level`, but another input has; analyse them in two runs");
    }
    if (!seen.insert(fs::canonical(input)).second)
      throw InputError(input.string(), "is named twice among the inputs");
    LevelsReader reader(input, options);
    const bool is_correct = reader.has(correct);
    if (!table.sources.empty() && is_correct != table.correct) {
      throw InputError(input.string(), "has another kind of answers (`correct` or `choice`) than " +
                                           table.sources.front());
    }
    table.correct = is_correct;
    table.sources.push_back(input.string());
    reader.read(cells, excluded);
  }
  for (const auto& [name, found] : excluded) {
    if (!found) {
      throw InputError("--exclude", fmt::format("participant `{}` is in no input; correct the list "
                                                "or take the row out",
                                                name));
    }
  }
  if (cells.empty()) throw InputError(table.sources.front(), "no answers; a report needs some");
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
