// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/csv_columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "analysis/groups.h"
#include "base/answer_columns.h"
#include "base/did_you_mean.h"
#include "base/input_error.h"
#include "base/text_checks.h"

namespace pinchlab::analysis {

namespace fs = std::filesystem;

std::string name_in_file(const ReadOptions& options, const std::string& column) {
  const auto mapped = options.columns.find(column);
  return mapped == options.columns.end() ? column : mapped->second;
}

bool pilot_of(std::string_view value, const std::string& place) {
  if (!value.empty() && value != "true" && value != "false") {
    throw InputError(place, fmt::format("pilot `{}` is unknown; it must be `true` or `false`",
                                        value.substr(0, 60)));
  }
  return value == "true";
}

bool has_columns(const fs::path& path, const ReadOptions& options,
                 const std::vector<std::string>& names) {
  if (!fs::is_regular_file(path) || (path.extension() != ".csv" && path.extension() != ".tsv"))
    return false;
  CsvReader reader(path, options.separator);
  std::vector<std::string_view> fields;
  return reader.next(fields) && std::ranges::all_of(names, [&](const std::string& name) {
           return std::ranges::find(fields, name_in_file(options, name)) != fields.end();
         });
}

void check_mapped_columns(const std::vector<fs::path>& inputs, const ReadOptions& options) {
  std::vector<std::string> there;
  std::string place;  // of the first header
  for (const fs::path& input : inputs) {
    if (options.columns.empty() || !has_columns(input, options, {})) continue;
    CsvReader reader(input, options.separator);
    std::vector<std::string_view> fields;
    reader.next(fields);
    if (place.empty()) place = reader.place();
    there.insert(there.end(), fields.begin(), fields.end());
  }
  const std::string all = fmt::format("`{}`", fmt::join(there, "`, `"));
  for (const auto& [ours, theirs] : options.columns) {
    if (place.empty() || std::ranges::find(there, theirs) != there.end()) continue;
    throw InputError(
        place, fmt::format("--map-column {}={}: there is no column `{}`{}; there are {}", ours,
                           theirs, theirs, did_you_mean(theirs, there), all));
  }
}

CsvColumns::CsvColumns(const fs::path& path, const ReadOptions& options,
                       std::vector<std::string> names, const std::vector<std::string>& ignored)
    : reader_(path, options.separator), names_(std::move(names)), place_(names_.size(), -1) {
  if (!reader_.next(fields_)) throw InputError(reader_.place(), "the file is empty");
  width_ = fields_.size();
  std::vector<std::string> known;
  for (const std::string& name : names_) known.push_back(name_in_file(options, name));
  for (const std::string& name : ignored) known.push_back(name_in_file(options, name));
  for (std::size_t i = 0; i < width_; ++i) {
    const auto found = std::ranges::find(known, fields_[i]);
    if (found == known.end()) {
      if (options.ignore_other_columns || is_column_beside_answers(fields_[i])) continue;
      fail(
          fmt::format("unknown column `{}`{}; columns are {}. Name columns with --map-column, or "
                      "pass --ignore-other-columns",
                      fields_[i], did_you_mean(fields_[i], known), one_of(known)));
    }
    const auto column = static_cast<std::size_t>(found - known.begin());
    if (column >= names_.size()) continue;
    if (place_[column] >= 0) fail(fmt::format("column `{}` stands twice", fields_[i]));
    place_[column] = static_cast<int>(i);
  }
}

bool CsvColumns::next() {
  if (!reader_.next(fields_)) return false;
  if (fields_.size() != width_) {
    fail(fmt::format("{} fields, but the first line has {}", fields_.size(), width_));
  }
  return true;
}

std::string CsvColumns::name(std::size_t column) const {
  if (!has(column)) return "";
  const std::string why = why_not_a_name(at(column));
  if (!why.empty()) fail(fmt::format("bad {}: {}", names_[column], why));
  return std::string(at(column));
}

long CsvColumns::whole(std::size_t column, long low, long high) const {
  const auto number = parse_whole(at(column), low, high);
  if (!number) {
    fail(fmt::format("{} `{}` is not a whole number from {} to {}", names_[column],
                     at(column).substr(0, 60), low, high));
  }
  return *number;
}

bool CsvColumns::is_main(std::size_t column) const {
  if (!has(column)) return true;
  const std::string_view value = at(column);
  if (value != "main" && value != "training" && value != "attention") {
    fail(fmt::format("kind `{}` is unknown; it must be `main`, `training` or `attention`",
                     value.substr(0, 60)));
  }
  return value == "main";
}

void CsvColumns::check_pilot(std::size_t column, SameStudy& same_study) const {
  same_study.check_pilot(has(column) && pilot_of(at(column), reader_.place()), reader_.place());
}

void CsvColumns::check_position(std::size_t column, const std::string& participant) {
  if (!has(column) || at(column).empty()) return;
  const long position = whole(column, 1, 65535);
  if (participant.empty()) return;
  const auto [known, is_new] =
      line_of_position_.try_emplace({participant, position}, reader_.line());
  if (is_new) return;
  fail(fmt::format(
      "participant `{}` has two answers at position {} (also in line {}), and a copy would count "
      "twice; take it out, or if it is none let positions count all trials of one participant",
      participant, position, known->second));
}

void CsvColumns::check_totals(const std::string& words) {
  const auto [known, is_new] = line_of_totals_.try_emplace(words, reader_.line());
  if (is_new) return;
  fail(
      fmt::format("says the same as line {}, and a copy would count twice; take it out, or if it "
                  "is none make one row of the two",
                  known->second));
}

void CsvColumns::fail(const std::string& message) const {
  throw InputError(reader_.place(), message);
}

Exclusions::Exclusions(const ReadOptions& options) : list_(exclusions_of(options)) {
  for (const Exclusion& exclusion : list_) found_.emplace(exclusion.participant, false);
}

bool Exclusions::excluded(const std::string& participant) {
  const auto found = found_.find(participant);
  if (found == found_.end()) return false;
  found->second = true;
  return true;
}

std::vector<Exclusion> Exclusions::finish() const {
  for (const auto& [name, found] : found_) {
    if (found) continue;
    throw InputError("--exclude",
                     fmt::format("participant `{}` is in no input; correct the list or take the "
                                 "row out",
                                 name));
  }
  return list_;
}

std::string why_nothing_is_left(const std::vector<Exclusion>& exclusions) {
  return exclusions.empty() ? "no answers; a report needs at least one"
                            : "all participants are left out, by --exclude or by the rules of the "
                              "design; a report needs at least one";
}

}  // namespace pinchlab::analysis
