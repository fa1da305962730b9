// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <nlohmann/json.hpp>

#include "analysis/design_check.h"
#include "analysis/json_estimate.h"
#include "analysis/report.h"

namespace pinchlab::analysis {

namespace {

using nlohmann::ordered_json;

ordered_json graded_json(const std::vector<GradedPreference>& graded) {
  ordered_json rows = ordered_json::array();
  for (const GradedPreference& one : graded) {
    ordered_json row = {{"name", one.name},
                        {"answers", one.answers},
                        {"ties", one.ties},
                        {"participants", one.participants},
                        {"mean", one.mean},
                        {"participants_for", one.test.positive},
                        {"participants_against", one.test.negative},
                        {"participants_neither", one.test.zeros},
                        {"w_plus", one.test.w_plus},
                        {"exact", one.test.is_exact}};
    put(row, "p_signed_rank", one.test.p);
    put(row, "p_signed_rank_holm", one.p_holm);
    put(row, "p_sign", one.test.p_sign);
    rows.push_back(std::move(row));
  }
  return {{"ties", "left out of all counts, shares and tests of choices; 0 here"}, {"rows", rows}};
}

// A number that holds only if the row's answers are independent of each other.
void put_naive(ordered_json& object, const Row& row, const std::string& key, double value) {
  put(object, key,
      row.why_not_independent.empty() ? Estimate(value) : Estimate::none(row.why_not_independent));
}

void put_row(ordered_json& object, const Row& row) {
  object["name"] = row.name;
  object["pinch"] = row.counts.pinch;
  object["cable"] = row.counts.cable;
  object["share"] = row.share;
  put(object, "p_read", row.read.p);
  object["test_read"] = row.read.test;
  put(object, "p_read_holm", row.read.p_holm);
  put(object, "p_read_bh", row.read.p_bh);
  put(object, "low_read", row.read.low);
  put(object, "high_read", row.read.high);
  object["interval_read"] = row.read.interval;
  put_naive(object, row, "chi_square", row.chi_square);
  put_naive(object, row, "p_chi_square", row.p_chi_square);
  put_naive(object, row, "p_exact", row.p_exact);
  put_naive(object, row, "wilson_low", row.wilson.low);
  put_naive(object, row, "wilson_high", row.wilson.high);
  put_naive(object, row, "clopper_pearson_low", row.clopper_pearson.low);
  put_naive(object, row, "clopper_pearson_high", row.clopper_pearson.high);
  object["cohens_h"] = row.cohens_h;
  put_naive(object, row, "p_holm", row.p_holm);
  put_naive(object, row, "p_bh", row.p_bh);
  put_naive(object, row, "log_bayes_factor", row.log_bayes_factor);
  const double bayes_factor = std::exp(row.log_bayes_factor);
  if (std::isfinite(bayes_factor)) {
    put_naive(object, row, "bayes_factor", bayes_factor);
  } else {
    put(object, "bayes_factor", Estimate::none("too large for a number; see log_bayes_factor"));
  }
  object["bayes_factor_prior"] = "share ~ Beta(1, 1) against share = 1/2";
}

void put_scale(ordered_json& object, const ScaleValue& scale) {
  put(object, "bradley_terry_log_odds", scale.bradley_terry_log_odds);
  put(object, "thurstone_d", scale.thurstone_d);
  put(object, "jod", scale.jod);
  put(object, "jod_low", scale.jod_low);
  put(object, "jod_high", scale.jod_high);
}

ordered_json pooled_json(const Pooled& pooled) {
  ordered_json object;
  put(object, "chi_square", pooled.chi_square);
  put(object, "p_naive", pooled.p_naive);
  object["participants"] = pooled.participants;
  put(object, "design_effect", pooled.rao_scott.design_effect);
  put(object, "intraclass_correlation", pooled.rao_scott.icc);
  put(object, "rao_scott_chi_square", pooled.rao_scott.chi_square);
  put(object, "p_rao_scott", pooled.rao_scott.p);
  put(object, "p_rao_scott_f", pooled.rao_scott.p_f);
  put(object, "p_sign_flip", pooled.sign_flip.p);
  object["sign_flip_exact"] = pooled.sign_flip.exact;
  put(object, "bootstrap_low", pooled.bootstrap.low);
  put(object, "bootstrap_high", pooled.bootstrap.high);
  put(object, "p_bootstrap", pooled.bootstrap.p);
  object["bootstrap_resamples"] = pooled.bootstrap.resamples;
  return object;
}

ordered_json heterogeneity_json(const Heterogeneity& heterogeneity) {
  ordered_json object;
  put(object, "chi_square", heterogeneity.chi_square);
  put(object, "df", heterogeneity.df);
  put(object, "p", heterogeneity.p);
  return object;
}

ordered_json cochran_json(const CochranQ& cochran) {
  ordered_json object;
  put(object, "q", cochran.q);
  put(object, "df", cochran.df);
  put(object, "p", cochran.p);
  object["participants"] = cochran.participants;
  return object;
}

ordered_json mixed_json(const MixedModel& model) {
  ordered_json object;
  object["method"] = "logistic, random intercepts of participant and demonstration, Laplace";
  put(object, "intercept_log_odds", model.intercept);
  put(object, "intercept_low_log_odds", model.intercept_low);
  put(object, "intercept_high_log_odds", model.intercept_high);
  put(object, "p_likelihood_ratio", model.p);
  put(object, "sd_participant_log_odds", model.sd_participant);
  put(object, "sd_demonstration_log_odds", model.sd_demonstration);
  put(object, "mean_share", model.mean_share);
  put(object, "deviance", model.deviance);
  return object;
}

ordered_json side_json(const SideBias& side) {
  ordered_json object;
  object["left"] = side.chosen.pinch;
  object["right"] = side.chosen.cable;
  put(object, "bias", side.bias);
  put(object, "mantel_haenszel_chi_square", side.chi_square);
  put(object, "p_mantel_haenszel", side.p);
  put(object, "p_sign_flip", side.p_sign_flip);
  object["pinch_when_shown_left"] = side.shown_left.pinch;
  object["cable_when_pinch_left"] = side.shown_left.cable;
  object["pinch_when_shown_right"] = side.shown_right.pinch;
  object["cable_when_pinch_right"] = side.shown_right.cable;
  object["side_not_recorded"] = side.unknown;
  return object;
}

ordered_json order_json(const OrderEffect& order) {
  ordered_json object;
  object["positions"] = ordered_json::array();
  for (size_t i = 0; i < order.by_position.size(); ++i) {
    object["positions"].push_back({{"position", i + 1},
                                   {"pinch", order.by_position[i].pinch},
                                   {"cable", order.by_position[i].cable}});
  }
  put(object, "share_by_place", order.share_by_place);
  put(object, "trend_chi_square", order.chi_square);
  put(object, "p_trend", order.p_trend);
  put(object, "p_sign_flip", order.p_sign_flip);
  return object;
}

ordered_json times_json(const std::vector<ReactionTimes>& rows) {
  ordered_json array = ordered_json::array();
  for (const ReactionTimes& row : rows) {
    ordered_json object;
    object["name"] = row.name;
    object["answers"] = row.answers;
    put(object, "median_s", row.median_s);
    put(object, "lower_quartile_s", row.lower_quartile_s);
    put(object, "upper_quartile_s", row.upper_quartile_s);
    put(object, "shortest_s", row.shortest_s);
    put(object, "longest_s", row.longest_s);
    array.push_back(std::move(object));
  }
  return array;
}

ordered_json input_json(const Report& report, const AnswersTable& table) {
  ordered_json object;
  object["files"] = table.sources.size();
  object["participants"] = report.input.participants;
  object["answers"] = report.input.answers;
  if (!report.graded.empty()) object["ties"] = report.input.ties;
  object["answers_per_demonstration"] = table.answers_per_demonstration;
  object["groups_from"] = table.groups_from;
  object["incomplete_participants"] = table.incomplete;
  object["excluded"] = ordered_json::array();
  for (const Exclusion& exclusion : table.exclusions) {
    object["excluded"].push_back(
        {{"participant", exclusion.participant}, {"reason", exclusion.reason}});
  }
  return object;
}

}  // namespace

std::string report_json(const Report& report, const AnswersTable& table) {
  ordered_json document;
  document["format"] = "pinchlab-report";
  document["version"] = 1;
  document["software_version"] = PINCHLAB_VERSION;
  document["answer"] = plain_words(report, table);
  if (table.design) document["design"] = design_json(*table.design);
  document["alpha"] = report.options.alpha;
  document["seed"] = report.options.seed;
  document["methods"] = {{"pinch", report.options.pinch_label},
                         {"cable", report.options.cable_label}};
  document["input"] = input_json(report, table);
  document["demonstrations"] = ordered_json::array();
  for (const DemonstrationResult& result : report.demonstrations) {
    ordered_json object;
    put_row(object, result.row);
    put_scale(object, result.scale);
    object["groups"] = result.groups;
    document["demonstrations"].push_back(std::move(object));
  }
  document["groups"] = ordered_json::array();
  for (const GroupResult& result : report.groups) {
    ordered_json object;
    put_row(object, result.row);
    put_scale(object, result.scale);
    object["demonstrations"] = ordered_json::array();
    for (std::uint16_t index : result.demonstrations) {
      object["demonstrations"].push_back(table.demonstrations[index]);
    }
    object["pooled"] = pooled_json(result.pooled);
    put(object, "p_sign_flip_holm",
        result.pooled.sign_flip.p ? Estimate(result.p_sign_flip_holm) : result.pooled.sign_flip.p);
    object["heterogeneity"] = heterogeneity_json(result.heterogeneity);
    object["cochran_q"] = cochran_json(result.cochran_q);
    object["mixed_model"] = mixed_json(result.mixed_model);
    document["groups"].push_back(std::move(object));
  }
  document["pooled"] = pooled_json(report.all().pooled);
  document["heterogeneity"] = heterogeneity_json(report.all().heterogeneity);
  document["cochran_q"] = cochran_json(report.all().cochran_q);
  document["mixed_model"] = mixed_json(report.all().mixed_model);
  document["side_bias"] = side_json(report.side_bias);
  document["order_effect"] = order_json(report.order_effect);
  document["reaction_times"] = times_json(report.reaction_times);
  put_circumstances(document, report.circumstances);
  if (!report.graded.empty()) document["graded_preferences"] = graded_json(report.graded);
  put_besides(document, report.besides);
  return document.dump(2) + "\n";
}

}  // namespace pinchlab::analysis
