// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Answers to graded stimuli: what psychometric functions are fitted to.

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/answers_table.h"
#include "analysis/psychometric.h"

namespace pinchlab::analysis {

/// The answers to one graded series (a demonstration).
struct Series {
  std::string name;                 ///< "" if the input names no demonstrations
  std::vector<Observer> observers;  ///< by name; one without a name if the input has none
};

struct LevelsTable {
  std::vector<std::string> sources;
  std::vector<Series> series;  ///< in natural order
  std::vector<Exclusion> exclusions;
  std::map<std::string, Session> sessions;  ///< by participant; of answer files
  std::vector<BesidesAnswer> besides;       ///< of answer files
  bool has_session_records = false;
  bool is_pilot = false;              ///< answers of a trial run
  std::optional<DesignCheck> design;  ///< if the study has a frozen one
  bool correct = false;  ///< hits are correct answers; otherwise choices of the method under test
};

/// Does the first line of this CSV file have a column of levels? False for other kinds of files.
bool has_levels(const std::filesystem::path& path, const ReadOptions& options);

/// Reads CSV files with the columns `level` and `correct` (0 or 1; with a column `trials` a count)
/// or `choice`, and if known participant, demonstration and kind. Throws InputError.
LevelsTable read_levels(const std::vector<std::filesystem::path>& inputs,
                        const ReadOptions& options);

}  // namespace pinchlab::analysis
