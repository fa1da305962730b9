// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The report of a study of three methods and more: their scale.

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/comparisons_table.h"
#include "analysis/report.h"
#include "analysis/scale_tests.h"

namespace pinchlab::analysis {

struct ScaleOptions {
  double alpha = 0.05;
  int resamples = 9999;  ///< of sign flips and exchanges
  std::uint64_t seed = 1;
  ScaleModel model = ScaleModel::bradley_terry;  ///< that is read
};

/// A value with its interval on the scale.
struct ScaleValueOf {
  Estimate value, low, high;
};

/// Two methods: is the one above the other?
struct ScalePair {
  std::size_t first = 0, second = 0;  ///< methods, the higher one first
  std::int64_t wins = 0, losses = 0, ties = 0;
  double difference = 0.0;      ///< on the scale
  Estimate low, high;           ///< of the difference
  double expected_share = 0.5;  ///< that the first wins, by the scale, of answers without tie
  Estimate p, p_holm;           ///< Wald's test of the difference
};

/// The methods of one demonstration, or of all.
struct Scale {
  std::string name;
  std::int64_t answers = 0;
  ScaleFit bradley_terry, thurstone;
  std::vector<ScaleValueOf> values;  ///< of the model that is read; one a method
};

struct ScaleReport {
  ScaleOptions options;
  std::size_t participants = 0;
  Scale all;
  std::vector<Scale> demonstrations;  ///< empty if there is one
  std::vector<std::size_t> order;     ///< methods from the highest value to the lowest
  EqualScale equal;
  ScaleDifference difference;  ///< of demonstrations
  std::vector<ScalePair> pairs;
  ScaleFit with_side;  ///< with the value of standing on the left
  Estimate p_side;
  Transitivity transitivity;
  std::vector<ObserverFit> observers;
  Circumstances circumstances;
  Besides besides;
  [[nodiscard]] const ScaleFit& fit() const {
    return options.model == ScaleModel::bradley_terry ? all.bradley_terry : all.thurstone;
  }
};

ScaleReport analyse_scale(const ComparisonsTable& table, const ScaleOptions& options);

/// The answer in plain words, one paragraph.
std::string scale_words(const ScaleReport& report, const ComparisonsTable& table);

/// Every number; what cannot be computed is null, with the reason beside it.
std::string scale_json(const ScaleReport& report, const ComparisonsTable& table);

/// Tables: scale.csv, pairs.csv and, where participants are known, participants.csv.
std::vector<CsvTable> scale_csv(const ScaleReport& report, const ComparisonsTable& table);

/// A value on Thurstone's scale in just-objectionable differences: at 1 JOD three of four people
/// choose the better (Perez-Ortiz and Mantiuk, arXiv 1712.03686).
double jod_of(double thurstone);

/// Writes report.html, report.md, report.json, scale.csv, pairs.csv, participants.csv and the
/// figure into `folder` and returns the names. Throws std::runtime_error.
std::vector<std::string> write_scale_report(const ScaleReport& report,
                                            const ComparisonsTable& table,
                                            const std::filesystem::path& folder, bool with_figures);

}  // namespace pinchlab::analysis
