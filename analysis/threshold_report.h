// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The report of a threshold study: psychometric functions of graded series.

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/besides.h"
#include "analysis/circumstances.h"
#include "analysis/levels_table.h"

namespace pinchlab::analysis {

struct ThresholdReport {
  PsychometricModel model;
  PsychometricOptions options;
  std::vector<PsychometricFit> fits;  ///< one a series
  Circumstances circumstances;
  Besides besides;
};

/// Fits every series. Throws InputError where the model cannot take the levels (Weibull's function
/// needs positive ones).
ThresholdReport analyse_thresholds(const LevelsTable& table, const PsychometricModel& model,
                                   const PsychometricOptions& options);

/// The answer in plain words, one paragraph.
std::string threshold_words(const ThresholdReport& report, const LevelsTable& table);

/// Every number; what cannot be computed is null, with the reason beside it.
std::string threshold_json(const ThresholdReport& report, const LevelsTable& table);

/// Writes report.html, report.md, report.json, thresholds.csv, participants.csv and the figure
/// into `folder` and returns the names. Throws std::runtime_error.
std::vector<std::string> write_threshold_report(const ThresholdReport& report,
                                                const LevelsTable& table,
                                                const std::filesystem::path& folder,
                                                bool with_figures);

}  // namespace pinchlab::analysis
