// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A CSV file with known columns, read record by record.

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "analysis/answers_table.h"
#include "base/answer_file.h"
#include "base/csv_reader.h"

namespace pinchlab::analysis {

/// A CSV file that says whose answer to what a record is, besides its own columns.
class CsvColumns {
 public:
  /// Columns are asked for by their place in `names`; `ignored` ones may be there too. Throws
  /// InputError for an empty file, and for columns that are unknown or stand twice.
  CsvColumns(const std::filesystem::path& path, const ReadOptions& options,
             std::vector<std::string> names, const std::vector<std::string>& ignored);

  [[nodiscard]] bool has(std::size_t column) const { return place_[column] >= 0; }

  /// The next record; false at the end. Throws InputError if it has too few or too many fields.
  bool next();

  [[nodiscard]] std::string_view at(std::size_t column) const {
    return fields_[static_cast<std::size_t>(place_[column])];
  }
  /// A name, or "" if there is no such column.
  [[nodiscard]] std::string name(std::size_t column) const;
  [[nodiscard]] long whole(std::size_t column, long low, long high) const;
  /// Of a column `kind`: an answer of the study, not of training or an attention check.
  [[nodiscard]] bool is_main(std::size_t column) const;
  /// Of a column `pilot`: holds the record against those before it.
  void check_pilot(std::size_t column, SameStudy& same_study) const;

  /// Of a column `position`: throws InputError where the participant has an answer there already.
  void check_position(std::size_t column, const std::string& participant);
  /// Throws InputError if another record stands for the same answers in the same words.
  void check_totals(const std::string& words);

  [[noreturn]] void fail(const std::string& message) const;

 private:
  CsvReader reader_;
  std::vector<std::string> names_;
  std::vector<int> place_;
  std::vector<std::string_view> fields_;
  std::size_t width_ = 0;
  // Lines of the records before, by what no two of them may have in common.
  std::map<std::pair<std::string, long>, std::size_t> line_of_position_;
  std::map<std::string, std::size_t> line_of_totals_;
};

/// The name that one of our columns has in the files.
std::string name_in_file(const ReadOptions& options, const std::string& column);

/// Whether a record is an answer of a trial run, by its column `pilot`: "true" or "false", empty
/// where it is none.
bool pilot_of(std::string_view value, const std::string& place);

/// Does the first line of a CSV file have all of these columns? False for other kinds of files.
bool has_columns(const std::filesystem::path& path, const ReadOptions& options,
                 const std::vector<std::string>& names);

/// Throws InputError for a name of a column that is mapped to and that no CSV file among the inputs
/// has.
void check_mapped_columns(const std::vector<std::filesystem::path>& inputs,
                          const ReadOptions& options);

/// Who is to be left out, and who of them turned up.
class Exclusions {
 public:
  explicit Exclusions(const ReadOptions& options);
  /// Is this participant to be left out?
  bool excluded(const std::string& participant);
  /// Throws InputError for a name that nobody bears; otherwise the list.
  std::vector<Exclusion> finish() const;

 private:
  std::vector<Exclusion> list_;
  std::map<std::string, bool> found_;
};

/// Why there is nothing to report where no answer is left.
std::string why_nothing_is_left(const std::vector<Exclusion>& exclusions);

}  // namespace pinchlab::analysis
