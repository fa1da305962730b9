// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/scale_report.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/tests_2afc.h"

namespace pinchlab::analysis {
namespace {

double variance_of_difference(const Matrix& covariance, std::size_t i, std::size_t j) {
  return covariance.at(i, i) + covariance.at(j, j) - 2 * covariance.at(i, j);
}

// A standard error from its variance that is read and that of independent answers.
Estimate error_of(double variance, double of_independent) {
  return variance > roundoff_share * of_independent
             ? Estimate(std::sqrt(variance))
             : Estimate::none("participants do not differ at all");
}

// Half an interval's width in standard errors: Student's with N - 1 degrees of freedom where
// participants are the unit.
double reach(const ScaleFit& fit, double alpha) {
  return fit.robust.size > 0 ? gsl_cdf_tdist_Qinv(alpha / 2, static_cast<double>(fit.clusters) - 1)
                             : gsl_cdf_ugaussian_Qinv(alpha / 2);
}

double two_sided_p(const ScaleFit& fit, double z) {
  return fit.robust.size > 0
             ? 2 * gsl_cdf_tdist_Q(std::abs(z), static_cast<double>(fit.clusters) - 1)
             : 2 * gsl_cdf_ugaussian_Q(std::abs(z));
}

Scale scale_of(const std::string& name, const ComparisonsTable& table,
               const std::vector<PairChoices>& choices, const ScaleOptions& options) {
  Scale scale;
  scale.name = name;
  for (const PairChoices& pair : choices) scale.answers += pair.total();
  const std::size_t methods = table.methods.size();
  scale.bradley_terry = fit_scale(ScaleModel::bradley_terry, methods, choices);
  scale.thurstone = fit_scale(ScaleModel::thurstone, methods, choices);
  const ScaleFit& fit =
      options.model == ScaleModel::bradley_terry ? scale.bradley_terry : scale.thurstone;
  for (std::size_t i = 0; i < methods; ++i) {
    ScaleValueOf& value = scale.values.emplace_back();
    if (!fit.why_not.empty()) {
      value.value = value.low = value.high = Estimate::none(fit.why_not);
      continue;
    }
    const Estimate error = error_of(fit.read().at(i, i), fit.covariance.at(i, i));
    const double half = reach(fit, options.alpha) * error.value;
    value = {fit.values[i], error, error};
    if (error) value.low = fit.values[i] - half, value.high = fit.values[i] + half;
  }
  return scale;
}

ScalePair pair_of(const ScaleReport& report, const ComparisonsTable& table, std::size_t first,
                  std::size_t second) {
  ScalePair pair;
  pair.first = first;
  pair.second = second;
  for (const PairChoices& choices : table.choices) {
    const bool same = choices.left == first && choices.right == second;
    const bool turned = choices.left == second && choices.right == first;
    if (!same && !turned) continue;
    pair.wins += same ? choices.left_wins : choices.right_wins;
    pair.losses += same ? choices.right_wins : choices.left_wins;
    pair.ties += choices.ties;
  }
  const ScaleFit& fit = report.fit();
  if (!fit.why_not.empty()) {
    pair.low = pair.high = pair.p = Estimate::none(fit.why_not);
    return pair;
  }
  pair.difference = fit.values[first] - fit.values[second];
  const Estimate error = error_of(variance_of_difference(fit.read(), first, second),
                                  variance_of_difference(fit.covariance, first, second));
  pair.low = pair.high = pair.p = error;
  if (error) {
    const double half = reach(fit, report.options.alpha) * error.value;
    pair.low = pair.difference - half;
    pair.high = pair.difference + half;
    pair.p = two_sided_p(fit, pair.difference / error.value);
  }
  const Outcomes expected = outcomes(report.options.model, fit, first, second);
  pair.expected_share = expected.left / (expected.left + expected.right);
  return pair;
}

bool in_both_orders(const ComparisonsTable& table) {
  const auto shown = [&](std::size_t left, std::size_t right) {
    return std::ranges::any_of(table.choices, [&](const PairChoices& pair) {
      return pair.left == left && pair.right == right;
    });
  };
  return std::ranges::all_of(table.choices,
                             [&](const PairChoices& pair) { return shown(pair.right, pair.left); });
}

}  // namespace

ScaleReport analyse_scale(const ComparisonsTable& table, const ScaleOptions& options) {
  ScaleReport report;
  report.options = options;
  report.participants = table.participants.size();
  const std::size_t methods = table.methods.size(), demonstrations = table.demonstrations.size();
  report.all = scale_of("all", table, table.choices, options);
  for (std::size_t i = 0; i < demonstrations && demonstrations > 1; ++i) {
    std::vector<PairChoices> own;
    std::ranges::copy_if(table.choices, std::back_inserter(own),
                         [&](const PairChoices& pair) { return pair.demonstration == i; });
    report.demonstrations.push_back(scale_of(table.demonstrations[i], table, own, options));
  }
  const ScaleFit& fit = report.fit();
  report.order.resize(methods);
  std::iota(report.order.begin(), report.order.end(), std::size_t{0});
  report.equal = equal_scale(methods, table.choices, options.seed, options.resamples);
  report.transitivity = transitivity(methods, report.participants, demonstrations, table.choices);
  if (report.participants > 1) {
    report.observers = observer_fits(options.model, methods, report.participants, table.choices);
  }
  report.p_side = Estimate::none("not every pair was shown in both orders");
  if (!fit.why_not.empty()) {
    report.difference.p = report.difference.statistic = Estimate::none(fit.why_not);
  } else {
    std::ranges::stable_sort(report.order, std::greater<>(),
                             [&](std::size_t i) { return fit.values[i]; });
    report.difference = scale_difference(options.model, fit, methods, demonstrations, table.choices,
                                         options.seed, options.resamples);
    if (in_both_orders(table)) {
      report.with_side = fit_scale(options.model, methods, table.choices, true);
      const ScaleFit& side = report.with_side;
      report.p_side = !side.why_not.empty() ? Estimate::none(side.why_not)
                      : side.side_se
                          ? Estimate(two_sided_p(side, side.side.value / side.side_se.value))
                          : side.side_se;
    }
  }
  report.circumstances = circumstances(table.sessions, table.has_session_records);
  report.besides = analyse_besides(table.besides, options.alpha, options.seed);
  std::vector<double> p;
  for (std::size_t i = 0; i < methods; ++i) {
    for (std::size_t j = i + 1; j < methods; ++j) {
      report.pairs.push_back(pair_of(report, table, report.order[i], report.order[j]));
      p.push_back(report.pairs.back().p ? report.pairs.back().p.value : 1.0);
    }
  }
  const std::vector<double> adjusted = holm(p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    report.pairs[i].p_holm =
        report.pairs[i].p ? Estimate(adjusted[i]) : Estimate::none(report.pairs[i].p.why_not);
  }
  return report;
}

}  // namespace pinchlab::analysis
