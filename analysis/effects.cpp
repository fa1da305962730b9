// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/effects.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_statistics_double.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/clustered.h"

namespace pinchlab::analysis {

namespace {

std::string why_no_answers(const AnswersTable& table) {
  return table.answers.empty() ? "the input is a table of counts" : "";
}

ReactionTimes spread(std::string name, std::vector<double>& seconds) {
  ReactionTimes row;
  row.name = std::move(name);
  row.answers = static_cast<std::int64_t>(seconds.size());
  if (seconds.empty()) {
    const Estimate none = Estimate::none("no reaction times in the input");
    row.median_s = row.lower_quartile_s = row.upper_quartile_s = row.shortest_s = row.longest_s =
        none;
    return row;
  }
  std::sort(seconds.begin(), seconds.end());
  const auto quantile = [&](double f) {
    return gsl_stats_quantile_from_sorted_data(seconds.data(), 1, seconds.size(), f);
  };
  row.median_s = quantile(0.5);
  row.lower_quartile_s = quantile(0.25);
  row.upper_quartile_s = quantile(0.75);
  row.shortest_s = seconds.front();
  row.longest_s = seconds.back();
  return row;
}

}  // namespace

namespace {

// One demonstration's answers whose side is known, by where the pinch clip was.
struct SideStratum {
  std::int64_t left = 0, left_pinch = 0;  // answers with pinch on the left; of them, for pinch
  std::int64_t total = 0, pinch = 0;      // on either side
};

std::vector<SideStratum> side_strata(const AnswersTable& table, SideBias& result) {
  std::vector<SideStratum> strata(table.demonstrations.size());
  for (const Answer& answer : table.answers) {
    if (answer.pinch_side == Side::unknown) {
      ++result.unknown;
      continue;
    }
    const bool pinch_left = answer.pinch_side == Side::left;
    ++(answer.chose_pinch == pinch_left ? result.chosen.pinch : result.chosen.cable);
    Counts& shown = pinch_left ? result.shown_left : result.shown_right;
    ++(answer.chose_pinch ? shown.pinch : shown.cable);
    SideStratum& stratum = strata[answer.demonstration];
    ++stratum.total;
    stratum.pinch += answer.chose_pinch ? 1 : 0;
    stratum.left += pinch_left ? 1 : 0;
    stratum.left_pinch += pinch_left && answer.chose_pinch ? 1 : 0;
  }
  return strata;
}

// Mantel and Haenszel (1959): surplus of pinch choices on the left over what the margins of each
// stratum let expect, squared, over its hypergeometric variance.
void mantel_haenszel(const std::vector<SideStratum>& strata, SideBias& result) {
  double surplus = 0.0, variance = 0.0, weights = 0.0;
  for (const SideStratum& stratum : strata) {
    const auto n = static_cast<double>(stratum.total);
    const auto left = static_cast<double>(stratum.left);
    const auto pinch = static_cast<double>(stratum.pinch);
    if (stratum.total < 2) continue;
    surplus += static_cast<double>(stratum.left_pinch) - left * pinch / n;
    variance += left * (n - left) * pinch * (n - pinch) / (n * n * (n - 1.0));
    weights += left * (n - left) / n;
  }
  if (weights == 0.0 || variance == 0.0) {
    result.bias = result.chi_square = result.p = Estimate::none(
        weights == 0.0 ? "in no demonstration was pinch shown on both sides"
                       : "within each demonstration with both sides every answer is the same");
    return;
  }
  result.bias = 0.5 * surplus / weights;
  result.chi_square = surplus * surplus / variance;
  result.p = chi_square_p(result.chi_square.value, 1.0);
}

// One score a participant: sum of +-(n y - k) over the answers, + where pinch was on the left, with
// n answers in the demonstration and k of them for pinch. Sides drawn the other way round were as
// likely, so that without a bias its sign is a fair coin's.
std::vector<std::int64_t> side_scores(const AnswersTable& table,
                                      const std::vector<SideStratum>& strata) {
  std::vector<std::int64_t> scores;
  each_participant(table.answers, [&](std::span<const Answer> own) {
    std::int64_t score = 0;
    for (const Answer& answer : own) {
      if (answer.pinch_side == Side::unknown) continue;
      const SideStratum& stratum = strata[answer.demonstration];
      const std::int64_t centred = (answer.chose_pinch ? stratum.total : 0) - stratum.pinch;
      score += answer.pinch_side == Side::left ? centred : -centred;
    }
    scores.push_back(score);
  });
  return scores;
}

}  // namespace

SideBias side_bias(const AnswersTable& table, std::uint64_t seed) {
  SideBias result;
  const std::vector<SideStratum> strata = side_strata(table, result);
  if (result.chosen.total() == 0) {
    std::string reason = why_no_answers(table);
    if (reason.empty()) reason = "no sides in the input";
    result.bias = result.chi_square = result.p = result.p_sign_flip = Estimate::none(reason);
    return result;
  }
  mantel_haenszel(strata, result);
  result.p_sign_flip =
      result.p ? sign_flip_test(side_scores(table, strata), RandomUse::side_flip, seed).p
               : result.p;
  return result;
}

namespace {

// Where each participant's ties are, in the order of positions.
std::map<std::string, std::vector<int>> places_of_ties(const AnswersTable& table) {
  std::map<std::string, std::vector<int>> places;
  for (const GradedAnswer& answer : table.graded) {
    if (answer.grade == 0 && answer.position > 0)
      places[answer.participant].push_back(answer.position);
  }
  for (auto& [participant, of_one] : places) std::ranges::sort(of_one);
  return places;
}

// Counts the answers by their ranks, and returns a score a participant: n sum(rank y) - sum(rank)
// sum(y), the covariance of rank and choice in integers. Ties take their places in the session, so
// that a session in the opposite order has the opposite score.
std::vector<std::int64_t> order_scores(const AnswersTable& table, OrderEffect& result) {
  std::vector<std::int64_t> scores;
  std::vector<const Answer*> in_order;
  const auto ties = places_of_ties(table);
  each_participant(table.answers, [&](std::span<const Answer> own) {
    in_order.clear();
    for (const Answer& answer : own) {
      if (answer.position > 0) in_order.push_back(&answer);
    }
    std::ranges::sort(in_order, {}, &Answer::position);
    const auto tied = ties.find(table.participants[own.front().participant]);
    std::int64_t ranks = 0, pinch = 0, pinch_ranks = 0;
    for (size_t i = 0; i < in_order.size(); ++i) {
      size_t rank = i + 1;
      if (tied != ties.end()) {
        const auto& places = tied->second;
        rank += static_cast<size_t>(std::ranges::lower_bound(places, int{in_order[i]->position}) -
                                    places.begin());
      }
      if (result.by_position.size() < rank) result.by_position.resize(rank);
      Counts& counts = result.by_position[rank - 1];
      ++(in_order[i]->chose_pinch ? counts.pinch : counts.cable);
      ranks += static_cast<std::int64_t>(rank);
      if (!in_order[i]->chose_pinch) continue;
      ++pinch;
      pinch_ranks += static_cast<std::int64_t>(rank);
    }
    scores.push_back(static_cast<std::int64_t>(in_order.size()) * pinch_ranks - ranks * pinch);
  });
  return scores;
}

}  // namespace

OrderEffect order_effect(const AnswersTable& table, std::uint64_t seed) {
  OrderEffect result;
  std::vector<std::int64_t> scores = order_scores(table, result);
  const auto all = [&](const std::string& reason) {
    result.share_by_place = result.chi_square = result.p_trend = result.p_sign_flip =
        Estimate::none(reason);
    return result;
  };
  if (!why_no_answers(table).empty()) return all(why_no_answers(table));
  if (result.by_position.empty()) return all("no positions in the input");
  // Cochran and Armitage: squared covariance of position and choice over its variance.
  double n = 0.0, pinch = 0.0, x = 0.0, xx = 0.0, xy = 0.0;
  for (size_t i = 0; i < result.by_position.size(); ++i) {
    const auto position = static_cast<double>(i + 1);
    const auto total = static_cast<double>(result.by_position[i].total());
    n += total;
    pinch += static_cast<double>(result.by_position[i].pinch);
    x += position * total;
    xx += position * position * total;
    xy += position * static_cast<double>(result.by_position[i].pinch);
  }
  if (pinch == 0.0 || pinch == n) return all("every answer is the same");
  const auto places = std::ranges::count_if(
      result.by_position, [](const Counts& counts) { return counts.total() > 0; });
  if (places < 2) return all("every answer is at the same place of its session");
  const double share = pinch / n;
  const double covariance = xy - share * x;
  const double squares = xx - x * x / n;
  const double chi_square = covariance * covariance / (share * (1.0 - share) * squares);
  result.share_by_place = covariance / squares;
  result.chi_square = chi_square;
  result.p_trend = chi_square_p(chi_square, 1.0);
  result.p_sign_flip = sign_flip_test(std::move(scores), RandomUse::order_flip, seed).p;
  return result;
}

std::vector<ReactionTimes> reaction_times(const AnswersTable& table, const std::string& pinch_label,
                                          const std::string& cable_label) {
  std::vector<ReactionTimes> rows;
  const auto add = [&](const std::string& name, auto wanted) {
    std::vector<double> seconds;
    for (const Answer& answer : table.answers) {
      if (answer.reaction_time_s >= 0.0 && wanted(answer))
        seconds.push_back(answer.reaction_time_s);
    }
    rows.push_back(spread(name, seconds));
    return !seconds.empty();
  };
  if (!add("all answers", [](const Answer&) { return true; })) return rows;
  add("answers for " + pinch_label, [](const Answer& answer) { return answer.chose_pinch; });
  add("answers for " + cable_label, [](const Answer& answer) { return !answer.chose_pinch; });
  std::vector<std::vector<double>> seconds(table.demonstrations.size());
  for (const Answer& answer : table.answers) {
    if (answer.reaction_time_s >= 0.0)
      seconds[answer.demonstration].push_back(answer.reaction_time_s);
  }
  for (size_t i = 0; i < seconds.size(); ++i)
    rows.push_back(spread(table.demonstrations[i], seconds[i]));
  return rows;
}

ScaleValue scale_value(const Counts& counts, const Estimate& low, const Estimate& high) {
  const auto z = [](double p) {
    return p > 0.0 && p < 1.0 ? Estimate(gsl_cdf_ugaussian_Pinv(p))
                              : Estimate::none("a share of 0 or 1 is infinitely far on the scale");
  };
  // Perez-Ortiz and Mantiuk (2017): a difference of 1 JOD makes 3 of 4 people choose the better
  // one.
  const double unit = gsl_cdf_ugaussian_Pinv(0.75);
  const auto jod = [&](const Estimate& p) {
    if (!p) return p;
    const Estimate distance = z(p.value);
    return distance ? Estimate(distance.value / unit) : distance;
  };
  const auto pinch = static_cast<double>(counts.pinch), cable = static_cast<double>(counts.cable);
  // Of the lesser share, so that swapping the methods changes signs alone.
  const double sign = pinch <= cable ? 1.0 : -1.0;
  const double lesser = std::min(pinch, cable) / (pinch + cable);
  const Estimate distance = z(lesser);
  const auto times = [](double factor, const Estimate& of) {
    return of ? Estimate(factor * of.value) : of;
  };
  ScaleValue value;
  value.bradley_terry_log_odds = distance ? Estimate(std::log(pinch) - std::log(cable)) : distance;
  value.thurstone_d = times(sign * std::sqrt(2.0), distance);
  value.jod = times(sign, jod(lesser));
  value.jod_low = jod(low);
  value.jod_high = jod(high);
  return value;
}

}  // namespace pinchlab::analysis
