// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

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

constexpr const char* repeated =
    "each participant answered more than once, and the answers of one participant are not "
    "independent";

Reading reading_of_participants(const Pooled& pooled) {
  return {.p = pooled.sign_flip.p,
          .test = "sign-flip test over participants",
          .low = pooled.bootstrap.low,
          .high = pooled.bootstrap.high,
          .interval = "cluster bootstrap"};
}

Reading reading_of_answers(const Row& row, const char* test) {
  return {.p = row.p_exact,
          .test = test,
          .low = row.wilson.low,
          .high = row.wilson.high,
          .interval = "Wilson"};
}

Reading no_reading_of_one() {
  const Estimate none =
      Estimate::none("one participant; nothing is known of how participants differ");
  return {.p = none, .test = "no test", .low = none, .high = none, .interval = "no interval"};
}

DemonstrationResult analyse_demonstration(const AnswersTable& table, std::uint16_t index,
                                          const AnalysisOptions& options) {
  DemonstrationResult result;
  Row& row = result.row;
  row = make_row(table.demonstrations[index], table.counts[index], options.alpha);
  if (table.answers_per_demonstration == 1) {
    row.read = reading_of_answers(row, "exact binomial test");
  } else {
    row.why_not_independent = repeated;
    const Pooled pooled =
        pooled_tests(table, {row.name, {index}}, options.alpha, options.bootstrap, options.seed);
    row.read = pooled.participants > 1 ? reading_of_participants(pooled) : no_reading_of_one();
  }
  result.scale = scale_value(row.counts, row.read.low, row.read.high);
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
  if (table.answers_per_demonstration > 1) {
    result.heterogeneity.chi_square = result.heterogeneity.df = result.heterogeneity.p =
        Estimate::none(fmt::format("{}; read Cochran's Q", repeated));
  }
  result.cochran_q = cochran_q(table, group);
  result.mixed_model = fit_mixed_model(mixed_data(table, group), options.alpha);
  const bool one_answer_each =
      group.demonstrations.size() == 1 && !(table.answers_per_demonstration > 1);
  Row& row = result.row;
  row.read =
      one_answer_each                  ? reading_of_answers(row, "exact binomial test")
      : result.pooled.participants > 1 ? reading_of_participants(result.pooled)
      : table.participants.empty()
          ? reading_of_answers(row, "exact binomial test that takes all answers as independent")
          : no_reading_of_one();
  result.scale = scale_value(row.counts, row.read.low, row.read.high);
  return result;
}

// Who gave only ties, and what was answered by ties only, is in no count of choices.
Input input_of(const AnswersTable& table) {
  Input input;
  for (const Counts& counts : table.counts) input.answers += counts.total();
  std::set<std::string_view> participants(table.participants.begin(), table.participants.end());
  std::set<std::string_view> demonstrations(table.demonstrations.begin(),
                                            table.demonstrations.end());
  for (const GradedAnswer& answer : table.graded) {
    input.ties += answer.grade == 0 ? 1 : 0;
    participants.insert(answer.participant);
    demonstrations.insert(answer.demonstration);
  }
  input.answers += input.ties;
  input.participants = participants.size();
  input.demonstrations = demonstrations.size();
  return input;
}

}  // namespace

Difference difference_read(const GroupResult& group) {
  const CochranQ& cochran = group.cochran_q;
  if (cochran.p) return {"Cochran's Q", cochran.q, cochran.df, cochran.p, cochran.participants};
  const Heterogeneity& pearson = group.heterogeneity;
  if (group.pooled.participants == 1) return {"X²", pearson.chi_square, pearson.df, cochran.p, 0};
  return {"X²", pearson.chi_square, pearson.df, pearson.p, 0};
}

const Row& first_tested(const std::vector<const Row*>& rows) {
  const auto tested = std::ranges::find_if(rows, [](const Row* row) { return bool(row->read.p); });
  return tested == rows.end() ? *rows.front() : **tested;
}

std::vector<const Row*> rows_of(const std::vector<DemonstrationResult>& demonstrations) {
  std::vector<const Row*> rows;
  rows.reserve(demonstrations.size());
  for (const DemonstrationResult& result : demonstrations) rows.push_back(&result.row);
  return rows;
}

// Groups with the same members are one hypothesis by several names: it counts once.
void adjust_groups(const std::vector<Group>& groups, std::vector<GroupResult>& results) {
  std::vector<Row*> rows;
  std::vector<double> flips;
  std::map<std::vector<std::uint16_t>, size_t> place;  // in the family, by members
  for (size_t i = 0; i < groups.size(); ++i) {
    if (!place.emplace(groups[i].demonstrations, rows.size()).second) continue;
    rows.push_back(&results[i].row);
    const Estimate& p = results[i].pooled.sign_flip.p;
    flips.push_back(p ? p.value : 1.0);
  }
  adjust_family(rows);
  const std::vector<double> adjusted = holm(flips);
  for (size_t i = 0; i < groups.size(); ++i) {
    const size_t same = place.at(groups[i].demonstrations);
    results[i].p_sign_flip_holm = adjusted[same];
    results[i].row.p_holm = rows[same]->p_holm;
    results[i].row.p_bh = rows[same]->p_bh;
    results[i].row.read.p_holm = rows[same]->read.p_holm;
    results[i].row.read.p_bh = rows[same]->read.p_bh;
  }
}

Report analyse_table(const AnswersTable& table, const AnalysisOptions& options) {
  check_options(options);
  Report report;
  report.options = options;
  report.input = input_of(table);
  for (size_t i = 0; i < table.demonstrations.size(); ++i) {
    report.demonstrations.push_back(
        analyse_demonstration(table, static_cast<std::uint16_t>(i), options));
  }
  for (const Group& group : table.groups)
    report.groups.push_back(analyse_group(table, group, options));

  // Demonstrations are one family of tests, groups another.
  std::vector<Row*> rows;
  for (DemonstrationResult& result : report.demonstrations) rows.push_back(&result.row);
  adjust_family(rows);
  adjust_groups(table.groups, report.groups);

  report.side_bias = side_bias(table, options.seed);
  report.order_effect = order_effect(table, options.seed);
  report.reaction_times = reaction_times(table, options.pinch_label, options.cable_label);
  report.circumstances = circumstances(named_sessions(table), table.has_session_records);
  report.graded = graded_preferences(table);
  report.besides = analyse_besides(table.besides, options.alpha, options.seed);
  return report;
}

}  // namespace pinchlab::analysis
