// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <ostream>
#include <tuple>

#include "analysis/report.h"
#include "base/csv.h"

namespace pinchlab::analysis {

namespace {

// Shortest text that reads back as the same number; nothing where there is no value.
std::string field(const Estimate& estimate) {
  return estimate ? fmt::format("{}", estimate.value) : "";
}

constexpr const char* row_header =
    "name,pinch,cable,share,p_read,test_read,p_read_holm,p_read_bh,low_read,high_read,interval_"
    "read,"
    "cohens_h,chi_square,p_chi_square,p_exact,wilson_low,wilson_high,clopper_pearson_low,"
    "clopper_pearson_high,p_holm,p_bh,log_bayes_factor";
constexpr const char* scale_header = "bradley_terry_log_odds,thurstone_d,jod,jod_low,jod_high";

std::string row_fields(const Row& row) {
  const Reading& read = row.read;
  std::string fields = fmt::format(
      "{},{},{},{},{},{},{},{},{},{},{},{}", csv_cell(row.name), row.counts.pinch, row.counts.cable,
      row.share, field(read.p), csv_cell(read.test), field(read.p_holm), field(read.p_bh),
      field(read.low), field(read.high), csv_cell(read.interval), row.cohens_h);
  for (double naive : {row.chi_square, row.p_chi_square, row.p_exact, row.wilson.low,
                       row.wilson.high, row.clopper_pearson.low, row.clopper_pearson.high,
                       row.p_holm, row.p_bh, row.log_bayes_factor}) {
    fields += row.why_not_independent.empty() ? fmt::format(",{}", naive) : ",";
  }
  return fields;
}

std::string scale_fields(const ScaleValue& scale) {
  return fmt::format("{},{},{},{},{}", field(scale.bradley_terry_log_odds),
                     field(scale.thurstone_d), field(scale.jod), field(scale.jod_low),
                     field(scale.jod_high));
}

CsvTable demonstrations_csv(const Report& report) {
  CsvTable csv{"demonstrations.csv", fmt::format("{},{}\n", row_header, scale_header)};
  for (const DemonstrationResult& result : report.demonstrations) {
    csv.content += fmt::format("{},{}\n", row_fields(result.row), scale_fields(result.scale));
  }
  return csv;
}

CsvTable groups_csv(const Report& report) {
  CsvTable csv{
      "groups.csv",
      fmt::format(
          "{},{},participants,design_effect,intraclass_correlation,rao_scott_chi_square,p_rao_"
          "scott,"
          "p_rao_scott_f,p_sign_flip,bootstrap_low,bootstrap_high,p_bootstrap,"
          "heterogeneity_chi_square,heterogeneity_df,heterogeneity_p,cochran_q,cochran_q_df,"
          "cochran_q_p,mixed_intercept_log_odds,mixed_intercept_low_log_odds,"
          "mixed_intercept_high_log_odds,mixed_p,mixed_sd_participant_log_odds,"
          "mixed_sd_demonstration_log_odds\n",
          row_header, scale_header)};
  for (const GroupResult& result : report.groups) {
    const Pooled& pooled = result.pooled;
    const MixedModel& model = result.mixed_model;
    csv.content += fmt::format("{},{},{}", row_fields(result.row), scale_fields(result.scale),
                               pooled.participants);
    for (const Estimate* estimate : {&pooled.rao_scott.design_effect,
                                     &pooled.rao_scott.icc,
                                     &pooled.rao_scott.chi_square,
                                     &pooled.rao_scott.p,
                                     &pooled.rao_scott.p_f,
                                     &pooled.sign_flip.p,
                                     &pooled.bootstrap.low,
                                     &pooled.bootstrap.high,
                                     &pooled.bootstrap.p,
                                     &result.heterogeneity.chi_square,
                                     &result.heterogeneity.df,
                                     &result.heterogeneity.p,
                                     &result.cochran_q.q,
                                     &result.cochran_q.df,
                                     &result.cochran_q.p,
                                     &model.intercept,
                                     &model.intercept_low,
                                     &model.intercept_high,
                                     &model.p,
                                     &model.sd_participant,
                                     &model.sd_demonstration}) {
      csv.content += "," + field(*estimate);
    }
    csv.content += "\n";
  }
  return csv;
}

CsvTable positions_csv(const Report& report) {
  CsvTable csv{"positions.csv", "position,pinch,cable\n"};
  const auto& positions = report.order_effect.by_position;
  for (size_t i = 0; i < positions.size(); ++i) {
    csv.content += fmt::format("{},{},{}\n", i + 1, positions[i].pinch, positions[i].cable);
  }
  return csv;
}

CsvTable times_csv(const Report& report) {
  CsvTable csv{"reaction_times.csv",
               "name,answers,median_s,lower_quartile_s,upper_quartile_s,shortest_s,longest_s\n"};
  for (const ReactionTimes& row : report.reaction_times) {
    csv.content +=
        fmt::format("{},{},{},{},{},{},{}\n", csv_cell(row.name), row.answers, field(row.median_s),
                    field(row.lower_quartile_s), field(row.upper_quartile_s), field(row.shortest_s),
                    field(row.longest_s));
  }
  return csv;
}

CsvTable texts_csv(const AnswersTable& table) {
  CsvTable csv{"free_text.csv", "participant,question,text\n"};
  for (const auto& [participant, session] : table.sessions) {
    for (const auto& [question, text] : session.free_text) {
      csv.content += fmt::format("{},{},{}\n", csv_cell(table.participants[participant]),
                                 csv_cell(question), csv_cell(text));
    }
  }
  return csv;
}

const char* word(Side side) {
  return side == Side::unknown ? "" : side == Side::left ? "left" : "right";
}

// The one group of each demonstration; empty if some demonstration has several, which a column
// cannot say.
std::vector<std::string> group_column(const AnswersTable& table) {
  std::vector<std::string> names(table.demonstrations.size());
  for (const Group& group : table.groups) {
    if (group.name == all_group) continue;
    for (std::uint16_t index : group.demonstrations) {
      if (!names[index].empty()) return {};
      names[index] = group.name;
    }
  }
  return names;
}

// Side, position, time and kind of an answer, with a comma before each.
template <class OneAnswer>
std::string around(const OneAnswer& answer) {
  std::string text = fmt::format(",{},", word(answer.pinch_side));
  if (answer.position > 0) fmt::format_to(std::back_inserter(text), "{}", answer.position);
  text += ',';
  if (answer.reaction_time_s >= 0.0)
    fmt::format_to(std::back_inserter(text), "{}", answer.reaction_time_s);
  return text + ",main";
}

// Counted from the left side to the right, as column `preference` is.
std::string grade_field(const Answer& answer) {
  if (answer.grade == 0) return ",";
  return fmt::format(",{}", answer.pinch_side == Side::left ? -answer.grade : answer.grade);
}

// In an order that does not depend on that of the inputs.
std::vector<const GradedAnswer*> sorted_ties(const AnswersTable& table) {
  std::vector<const GradedAnswer*> ties;
  for (const GradedAnswer& answer : table.graded) {
    if (answer.grade == 0) ties.push_back(&answer);
  }
  std::ranges::sort(ties, {}, [](const GradedAnswer* tie) {
    return std::tie(tie->participant, tie->demonstration, tie->position, tie->pinch_side,
                    tie->reaction_time_s);
  });
  return ties;
}

}  // namespace

void write_tidy_csv(const AnswersTable& table, std::ostream& out) {
  if (table.answers.empty()) return;
  const bool is_graded = !table.graded.empty();
  std::vector<std::string> groups = group_column(table);
  for (std::string& group : groups) group = csv_cell(group) + ",";
  out << "participant,demonstration," << (groups.empty() ? "" : "group,")
      << "choice,side,position,reaction_time_s,kind" << (is_graded ? ",preference" : "")
      << (table.is_pilot ? ",pilot" : "") << "\n";
  const char* const end = table.is_pilot ? ",true\n" : "\n";
  std::vector<std::string> names;
  for (const std::string& name : table.demonstrations) names.push_back(csv_cell(name));
  for (const Answer& answer : table.answers) {
    out << csv_cell(table.participants[answer.participant]) << "," << names[answer.demonstration]
        << "," << (groups.empty() ? "" : groups[answer.demonstration])
        << (answer.chose_pinch ? "pinch" : "cable") << around(answer)
        << (is_graded ? grade_field(answer) : "") << end;
  }
  for (const GradedAnswer* tie : sorted_ties(table)) {
    const auto found = std::ranges::find(table.demonstrations, tie->demonstration);
    const auto index = static_cast<std::size_t>(found - table.demonstrations.begin());
    out << csv_cell(tie->participant) << "," << csv_cell(tie->demonstration) << ","
        << (index < groups.size() ? groups[index]
            : groups.empty()      ? ""
                                  : ",")
        << "tie" << around(*tie) << ",0" << end;
  }
  for (const auto& [participant, session] : table.sessions) {
    for (int i = 0; i < session.attention_passed + session.attention_failed; ++i) {
      out << csv_cell(table.participants[participant]) << ",attention-check,"
          << (groups.empty() ? "" : ",") << (i < session.attention_passed ? "pass" : "fail")
          << ",,,,attention" << (is_graded ? "," : "") << end;
    }
  }
}

std::vector<CsvTable> report_csv(const Report& report, const AnswersTable& table) {
  std::vector<CsvTable> tables{demonstrations_csv(report), groups_csv(report)};
  if (!report.order_effect.by_position.empty()) tables.push_back(positions_csv(report));
  if (report.reaction_times.front().median_s) tables.push_back(times_csv(report));
  CsvTable texts = texts_csv(table);
  if (texts.content.find('\n') + 1 < texts.content.size()) tables.push_back(std::move(texts));
  for (CsvTable& csv : besides_csv(report.besides)) tables.push_back(std::move(csv));
  return tables;
}

}  // namespace pinchlab::analysis
