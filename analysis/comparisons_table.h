// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Choices among three methods and more, two of them at a time: what scales are fitted to.

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/answers_table.h"
#include "analysis/scale_model.h"

namespace pinchlab::analysis {

struct ComparisonsTable {
  std::vector<std::string> sources;
  std::vector<std::string> methods;         ///< in natural order, at least two
  std::vector<std::string> participants;    ///< in order; empty if not known whose choices they are
  std::vector<std::string> demonstrations;  ///< in natural order; one without a name if not known
  std::vector<PairChoices> choices;         ///< by participant, demonstration, methods
  std::vector<Exclusion> exclusions;
  std::map<std::string, Session> sessions;  ///< by participant; of answer files
  std::vector<BesidesAnswer> besides;       ///< of answer files
  bool is_pilot = false;                    ///< answers of a trial run
  bool has_session_records = false;
  std::int64_t answers = 0, ties = 0;
  std::optional<DesignCheck> design;  ///< if the study has a frozen one
};

/// Is this a CSV file with the columns `left` and `right`, or an answer file (or a folder of them)
/// whose plan names methods? False for other kinds of files.
bool has_comparisons(const std::filesystem::path& path, const ReadOptions& options);

/// Reads CSV files with the columns `left`, `right` (methods) and `choice` (one of the two, or
/// `tie`) or the counts `left_wins`, `right_wins` and, if there are any, `ties`, and if known
/// participant, demonstration and kind; answer files, and folders of them. Throws InputError.
ComparisonsTable read_comparisons(const std::vector<std::filesystem::path>& inputs,
                                  const ReadOptions& options);

}  // namespace pinchlab::analysis
