// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Answers that come in twice would count twice.

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace pinchlab::analysis {

/// Watches over inputs that are read one after the other.
class DistinctInputs {
 public:
  /// Throws InputError if the input was named before, or is a file that holds the same.
  void add(const std::filesystem::path& input);

  /// An answer file holds all of its participant's answers: throws InputError if `source` has some
  /// of them as an answer file, and another one as rows of a table, whichever came first.
  void has_file_of(const std::string& participant, const std::string& source);
  void has_rows_of(const std::string& participant, const std::string& source);

 private:
  std::set<std::filesystem::path> seen_;
  std::map<std::uintmax_t, std::vector<std::filesystem::path>> files_of_size_;  // bytes
  std::map<std::string, std::string> file_of_, rows_of_;  // source by participant
};

}  // namespace pinchlab::analysis
