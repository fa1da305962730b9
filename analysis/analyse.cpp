// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "analysis/report.h"
#include "base/input_error.h"

namespace pinchlab::analysis {

namespace {

void check_options(const AnalysisOptions& options) {
  if (!(options.alpha > 0.0 && options.alpha < 1.0)) {
    throw InputError("--alpha", fmt::format("{} is not between 0 and 1", options.alpha));
  }
  if (options.bootstrap < 99 || options.bootstrap > 1000000) {
    throw InputError("--bootstrap", fmt::format("{} is not from 99 to 1000000", options.bootstrap));
  }
}

DemonstrationResult analyse_demonstration(const AnswersTable& table, std::uint16_t index,
                                          double alpha) {
  DemonstrationResult result;
  result.row = make_row(table.demonstrations[index], table.counts[index], alpha);
  result.scale = scale_value(result.row.share, result.row.wilson.low, result.row.wilson.high);
  for (const Group& group : table.groups) {
    const auto& members = group.demonstrations;
    if (group.name != all_group &&
        std::find(members.begin(), members.end(), index) != members.end()) {
      result.groups.push_back(group.name);
    }
  }
  return result;
}

GroupResult analyse_group(const AnswersTable& table, const Group& group,
                          const AnalysisOptions& options) {
  GroupResult result;
  std::vector<Counts> counts;
  Counts sum;
  for (std::uint16_t index : group.demonstrations) {
    counts.push_back(table.counts[index]);
    sum.pinch += counts.back().pinch;
    sum.cable += counts.back().cable;
  }
  result.demonstrations = group.demonstrations;
  result.row = make_row(group.name, sum, options.alpha);
  result.pooled = pooled_tests(table, group, options.alpha, options.bootstrap, options.seed);
  result.heterogeneity = heterogeneity(counts);
  result.cochran_q = cochran_q(table, group);
  result.mixed_model = fit_mixed_model(mixed_data(table, group), options.alpha);
  // On the scale, a group's interval is the one that allows for repeated answers, where there is
  // one.
  const ClusterBootstrap& bootstrap = result.pooled.bootstrap;
  result.scale = bootstrap.low
                     ? scale_value(result.row.share, bootstrap.low, bootstrap.high)
                     : scale_value(result.row.share, result.row.wilson.low, result.row.wilson.high);
  return result;
}

}  // namespace

Report analyse_table(const AnswersTable& table, const AnalysisOptions& options) {
  check_options(options);
  Report report;
  report.options = options;
  for (size_t i = 0; i < table.demonstrations.size(); ++i) {
    report.demonstrations.push_back(
        analyse_demonstration(table, static_cast<std::uint16_t>(i), options.alpha));
  }
  for (const Group& group : table.groups)
    report.groups.push_back(analyse_group(table, group, options));

  // Demonstrations are one family of tests, groups another.
  std::vector<Row*> rows;
  for (DemonstrationResult& result : report.demonstrations) rows.push_back(&result.row);
  adjust_family(rows);
  rows.clear();
  std::vector<double> flips;
  for (GroupResult& result : report.groups) {
    rows.push_back(&result.row);
    flips.push_back(result.pooled.sign_flip.p ? result.pooled.sign_flip.p.value : 1.0);
  }
  adjust_family(rows);
  const std::vector<double> adjusted = holm(flips);
  for (size_t i = 0; i < adjusted.size(); ++i) report.groups[i].p_sign_flip_holm = adjusted[i];

  report.side_bias = side_bias(table, options.seed);
  report.order_effect = order_effect(table, options.seed);
  report.reaction_times = reaction_times(table, options.pinch_label, options.cable_label);
  report.attention = attention_checks(table);
  report.playback = playback(table);
  return report;
}

}  // namespace pinchlab::analysis
