// SPDX-License-Identifier: GPL-3.0-or-later
// Graded preferences in the report.
#include <fmt/format.h>

#include "analysis/document.h"

namespace pinchlab::analysis {

std::vector<Block> graded_blocks(const Report& report) {
  if (report.graded.empty()) return {};
  const GradedPreference& all = report.graded.back();
  const AnalysisOptions& options = report.options;
  TableBlock block;
  block.caption =
      fmt::format("Preferences from -3 ({} by far) to 3 ({} by far), over the participants' means",
                  options.cable_label, options.pinch_label);
  block.header = {"",
                  "answers",
                  "ties",
                  "mean",
                  fmt::format("for {} : against : neither", options.pinch_label),
                  "W+",
                  "p signed-rank",
                  "p Holm",
                  "p sign"};
  for (const GradedPreference& row : report.graded) {
    const SignedRank& test = row.test;
    block.rows.push_back({{row.name},
                          {fmt::format("{}", row.answers)},
                          {fmt::format("{}", row.ties)},
                          {fmt::format("{:.2f}", row.mean)},
                          {fmt::format("{} : {} : {}", test.positive, test.negative, test.zeros)},
                          {fmt::format("{:g}", test.w_plus)},
                          p_cell(test.p, options.alpha),
                          {p_text(row.p_holm)},
                          {p_text(test.p_sign)}});
  }
  return {Heading{"Graded preferences"},
          Paragraph{fmt::format(
              "Preferences were given in seven grades. {} of {} answers {} left out of all counts, "
              "shares and tests of choices in this report, and {} 0 here. "
              "Each participant's mean grade counts once: Wilcoxon's signed-rank test (two-sided, "
              "{}; means of 0 are dropped, equal ones share their ranks) and the sign test "
              "(exact) ask whether they lie on one side of 0.",
              all.ties, all.answers, all.ties == 1 ? "was a tie: it is" : "were ties: they are",
              all.ties == 1 ? "is" : "are",
              all.test.is_exact ? "exact" : "by the normal approximation")},
          std::move(block)};
}

}  // namespace pinchlab::analysis
