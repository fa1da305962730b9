// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// All results of an analysis as plain data, computed once; the writers below turn it into pages and
// tables.

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "analysis/answers_table.h"
#include "analysis/besides.h"
#include "analysis/circumstances.h"
#include "analysis/clustered.h"
#include "analysis/effects.h"
#include "analysis/graded_preference.h"
#include "analysis/mixed_model.h"
#include "analysis/tests_2afc.h"

namespace pinchlab::analysis {

struct AnalysisOptions {
  double alpha = 0.05;   ///< in (0, 1)
  int bootstrap = 9999;  ///< resamples, 99 .. 1000000
  std::uint64_t seed = 1;
  std::string pinch_label = "pinch";
  std::string cable_label = "cable";
};

struct DemonstrationResult {
  Row row;
  ScaleValue scale;
  std::vector<std::string> groups;  ///< that it belongs to, "all" left out
};

struct GroupResult {
  Row row;
  std::vector<std::uint16_t> demonstrations;
  Pooled pooled;
  double p_sign_flip_holm = 1.0;  ///< over the groups; holds if pooled.sign_flip.p does
  Heterogeneity heterogeneity;
  CochranQ cochran_q;
  MixedModel mixed_model;
  ScaleValue scale;
};

/// The test to read of whether the demonstrations of a group differ: Cochran's Q where there is
/// one, otherwise Pearson's X^2, which takes all answers as independent.
struct Difference {
  std::string name;
  Estimate statistic, df, p;
  int participants = 0;  ///< that Cochran's Q is of: those who chose in all demonstrations
};
Difference difference_read(const GroupResult& group);

/// How much went in, ties among it.
struct Input {
  std::int64_t answers = 0, ties = 0;
  size_t participants = 0, demonstrations = 0;
};

struct Report {
  AnalysisOptions options;
  Input input;
  std::vector<DemonstrationResult> demonstrations;
  std::vector<GroupResult> groups;  ///< the last one is "all"
  SideBias side_bias;
  OrderEffect order_effect;
  std::vector<ReactionTimes> reaction_times;
  Circumstances circumstances;
  std::vector<GradedPreference> graded;  ///< empty where preferences were not graded
  Besides besides;

  [[nodiscard]] const GroupResult& all() const { return groups.back(); }
};

/// The first row that has a test, by which tables and figures name their tests and intervals; the
/// first one where none has.
const Row& first_tested(const std::vector<const Row*>& rows);

/// The rows of all demonstrations.
std::vector<const Row*> rows_of(const std::vector<DemonstrationResult>& demonstrations);

/// Computes everything. Throws InputError for options out of range.
Report analyse_table(const AnswersTable& table, const AnalysisOptions& options);

/// One figure: its file name without extension, a caption, and its gnuplot script.
struct Figure {
  std::string name;
  std::string caption;
  std::string script;    ///< stands alone: writes NAME.svg and NAME.pdf into the current folder
  std::string svg = {};  ///< the drawing, once gnuplot has made it
};
std::vector<Figure> make_figures(const Report& report);

/// The report for programs; pages.h has those for people.
std::string report_json(const Report& report, const AnswersTable& table);

/// CSV tables: file name and content.
struct CsvTable {
  std::string name;
  std::string content;
};
std::vector<CsvTable> report_csv(const Report& report, const AnswersTable& table);

/// Streams the answers as a tidy CSV that `read_answers` reads back to the same table. Does nothing
/// for a table of counts.
void write_tidy_csv(const AnswersTable& table, std::ostream& out);

/// The answer to the study's question in plain words, one paragraph.
std::string plain_words(const Report& report, const AnswersTable& table);

/// Writes the whole report into `folder` (made if need be): every file is finished elsewhere in it
/// first and then renamed. Returns the names written. Throws std::runtime_error if writing or
/// gnuplot fails.
std::vector<std::string> write_report(const Report& report, const AnswersTable& table,
                                      const std::filesystem::path& folder, bool with_figures);

}  // namespace pinchlab::analysis
