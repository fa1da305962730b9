// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/distinct_inputs.h"

#include <fmt/format.h>

#include "base/input_error.h"
#include "base/read_file.h"

namespace pinchlab::analysis {

namespace fs = std::filesystem;

namespace {

void refuse_if_in(const std::map<std::string, std::string>& others, const std::string& participant,
                  const std::string& source) {
  const auto other = others.find(participant);
  if (other == others.end()) return;
  throw InputError(source, fmt::format("participant `{}` has answers in {} too, as answer file and "
                                       "as rows of a table; keep one of the two",
                                       participant, other->second));
}

}  // namespace

void DistinctInputs::add(const fs::path& input) {
  if (!seen_.insert(fs::canonical(input)).second)
    throw InputError(input.string(), "is named twice among the inputs");
  if (!fs::is_regular_file(input)) return;
  std::vector<fs::path>& others = files_of_size_[fs::file_size(input)];
  for (const fs::path& other : others) {
    if (read_whole(other) != read_whole(input)) continue;
    throw InputError(
        input.string(),
        fmt::format("holds the same answers as {}; name one of the two", other.string()));
  }
  others.push_back(input);
}

void DistinctInputs::has_file_of(const std::string& participant, const std::string& source) {
  refuse_if_in(rows_of_, participant, source);
  file_of_.emplace(participant, source);
}

void DistinctInputs::has_rows_of(const std::string& participant, const std::string& source) {
  if (participant.empty() || rows_of_.contains(participant)) return;
  refuse_if_in(file_of_, participant, source);
  rows_of_.emplace(participant, source);
}

}  // namespace pinchlab::analysis
