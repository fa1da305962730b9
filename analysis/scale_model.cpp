// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/scale_model.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_randist.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "analysis/gsl_support.h"

namespace pinchlab::analysis {
namespace {

constexpr std::size_t left_wins = 0, right_wins = 1, tie = 2;
using Three = std::array<double, 3>;

// Probabilities of the outcomes, and their derivatives by d and by the parameter of ties
// (ln nu or tau).
struct Law {
  Three p{}, by_d{}, by_tie{};
};

// Davidson's law is an exponential family with the statistics (1/2, -1/2, 0) of d and (0, 0, 1) of
// ln nu, so that dp = p (statistic - its mean).
Law davidson(double d, std::optional<double> log_nu) {
  const double top = std::max(std::abs(d) / 2, log_nu.value_or(0.0));  // against overflow
  Law law;
  law.p = {std::exp(d / 2 - top), std::exp(-d / 2 - top), log_nu ? std::exp(*log_nu - top) : 0.0};
  const double sum = law.p[0] + law.p[1] + law.p[2];
  for (double& p : law.p) p /= sum;
  const double mean = (law.p[left_wins] - law.p[right_wins]) / 2;
  law.by_d = {law.p[0] * (0.5 - mean), law.p[1] * (-0.5 - mean), -law.p[2] * mean};
  if (log_nu) {
    const double t = law.p[tie];
    law.by_tie = {-law.p[0] * t, -law.p[1] * t, t * (1 - t)};
  }
  return law;
}

Law glenn_david(double d, std::optional<double> tau) {
  const double z = d / std::numbers::sqrt2, margin = tau.value_or(0.0);
  Law law;
  law.p = {gsl_cdf_ugaussian_P(z - margin), gsl_cdf_ugaussian_P(-z - margin), 0.0};
  const double left = gsl_ran_ugaussian_pdf(z - margin), right = gsl_ran_ugaussian_pdf(z + margin);
  law.by_d = {left / std::numbers::sqrt2, -right / std::numbers::sqrt2, 0.0};
  if (tau) {
    law.p[tie] = std::max(0.0, 1.0 - law.p[0] - law.p[1]);
    law.by_d[tie] = -law.by_d[0] - law.by_d[1];
    law.by_tie = {-left, -right, left + right};
  }
  return law;
}

Law law_of(ScaleModel model, double d, std::optional<double> tie_parameter) {
  return model == ScaleModel::bradley_terry ? davidson(d, tie_parameter)
                                            : glenn_david(d, tie_parameter);
}

// Parameters: the values of all methods but the first, whose value is 0; the side; the ties.
struct Design {
  ScaleModel model;
  std::size_t methods;
  bool with_side, with_ties;
  [[nodiscard]] std::size_t size() const {
    return methods - 1 + (with_side ? 1 : 0) + (with_ties ? 1 : 0);
  }
  [[nodiscard]] std::size_t side() const { return methods - 1; }
  [[nodiscard]] std::size_t ties() const { return size() - 1; }
};

double value_of(const std::vector<double>& parameters, std::size_t method) {
  return method == 0 ? 0.0 : parameters[method - 1];
}

Law law_at(const Design& design, const std::vector<double>& parameters, const PairChoices& pair) {
  const double d = value_of(parameters, pair.left) - value_of(parameters, pair.right) +
                   (design.with_side ? parameters[design.side()] : 0.0);
  return law_of(design.model, d,
                design.with_ties ? std::optional(parameters[design.ties()]) : std::nullopt);
}

// Adds `by_d` times the derivative of d by the parameters, and `by_tie`.
void add_gradient(const Design& design, const PairChoices& pair, double by_d, double by_tie,
                  std::vector<double>& sum) {
  if (pair.left > 0) sum[pair.left - 1U] += by_d;
  if (pair.right > 0) sum[pair.right - 1U] -= by_d;
  if (design.with_side) sum[design.side()] += by_d;
  if (design.with_ties) sum[design.ties()] += by_tie;
}

struct Scored {
  double log_likelihood = 0.0;
  std::vector<double> score;
  Matrix information;                                     // expected
  std::map<std::uint32_t, std::vector<double>> clusters;  // scores by participant
};

Scored evaluate(const Design& design, const std::vector<PairChoices>& choices,
                const std::vector<double>& parameters) {
  Scored result;
  result.score.assign(design.size(), 0.0);
  result.information = Matrix(design.size());
  for (const PairChoices& pair : choices) {
    const Law law = law_at(design, parameters, pair);
    const Three counts = {static_cast<double>(pair.left_wins), static_cast<double>(pair.right_wins),
                          static_cast<double>(pair.ties)};
    double by_d = 0.0, by_tie = 0.0, info_d = 0.0, info_mixed = 0.0, info_tie = 0.0;
    for (const std::size_t k : {left_wins, right_wins, tie}) {
      if (k == tie && !design.with_ties) continue;
      const double p = std::max(law.p[k], 1e-300);
      result.log_likelihood += counts[k] > 0 ? counts[k] * std::log(p) : 0.0;
      by_d += counts[k] * law.by_d[k] / p;
      by_tie += counts[k] * law.by_tie[k] / p;
      info_d += law.by_d[k] * law.by_d[k] / p;
      info_mixed += law.by_d[k] * law.by_tie[k] / p;
      info_tie += law.by_tie[k] * law.by_tie[k] / p;
    }
    add_gradient(design, pair, by_d, by_tie, result.score);
    std::vector<double>& cluster = result.clusters[pair.participant];
    cluster.resize(design.size());
    add_gradient(design, pair, by_d, by_tie, cluster);
    // The information is n (info_d x x' + ...) with x the derivative of d by the parameters.
    std::vector<double> x(design.size());
    add_gradient(design, pair, 1.0, 0.0, x);
    const auto n = static_cast<double>(pair.total());
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::size_t j = 0; j < x.size(); ++j)
        result.information.at(i, j) += n * info_d * x[i] * x[j];
    }
    if (design.with_ties) {
      const std::size_t t = design.ties();
      for (std::size_t i = 0; i < x.size(); ++i) {
        result.information.at(i, t) += n * info_mixed * x[i];
        result.information.at(t, i) += n * info_mixed * x[i];
      }
      result.information.at(t, t) += n * info_tie;
    }
  }
  return result;
}

std::vector<double> times(const Matrix& matrix, const std::vector<double>& vector) {
  std::vector<double> product(vector.size());
  for (std::size_t i = 0; i < vector.size(); ++i) {
    for (std::size_t j = 0; j < vector.size(); ++j) product[i] += matrix.at(i, j) * vector[j];
  }
  return product;
}

// Who can be reached from `start` by going from losers to winners (`up`) or back.
std::vector<bool> reached(const std::vector<std::vector<bool>>& won, std::size_t start, bool up) {
  std::vector<bool> seen(won.size());
  std::vector<std::size_t> open = {start};
  seen[start] = true;
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    for (std::size_t next = 0; next < won.size(); ++next) {
      if (!seen[next] && (up ? won[next][at] : won[at][next])) {
        seen[next] = true;
        open.push_back(next);
      }
    }
  }
  return seen;
}

// Whether the likelihood never falls as ties become more likely: wins must then lie at least as far
// apart as the margin of ties grows, and ties at most so far. Bellman and Ford's search finds such
// values unless some circle of methods has more wins than ties.
bool ties_outweigh(std::size_t methods, const std::vector<PairChoices>& choices) {
  std::vector<int> value(methods, 0);
  const auto lower = [&](std::size_t method, int most) {
    const bool is_above = value[method] > most;
    value[method] = std::min(value[method], most);
    return is_above;
  };
  for (std::size_t round = 0; round <= methods; ++round) {
    bool is_changed = false;
    for (const PairChoices& pair : choices) {
      const auto compare = [&](std::size_t winner, std::size_t loser, bool has_won) {
        if (has_won) is_changed |= lower(loser, value[winner] - 1);
        if (pair.ties > 0) is_changed |= lower(loser, value[winner] + 1);
      };
      compare(pair.left, pair.right, pair.left_wins > 0);
      compare(pair.right, pair.left, pair.right_wins > 0);
    }
    if (!is_changed) return true;
  }
  return false;
}

// Empty, or why there is no finite scale. A tie is half a win of each.
std::string why_no_scale(std::size_t methods, const std::vector<PairChoices>& choices) {
  std::vector<std::vector<bool>> won(methods, std::vector<bool>(methods)), met = won;
  for (const PairChoices& pair : choices) {
    if (pair.left_wins + pair.right_wins + pair.ties == 0) continue;
    met[pair.left][pair.right] = met[pair.right][pair.left] = true;
    if (pair.left_wins + pair.ties > 0) won[pair.left][pair.right] = true;
    if (pair.right_wins + pair.ties > 0) won[pair.right][pair.left] = true;
  }
  const std::vector<bool> compared = reached(met, 0, true);
  if (std::ranges::find(compared, false) != compared.end()) {
    return "some methods were never compared with the others, not even by way of a third, so that "
           "nothing says where they stand to one another";
  }
  for (const bool up : {true, false}) {
    const std::vector<bool> seen = reached(won, 0, up);
    if (std::ranges::find(seen, false) != seen.end()) {
      return "some methods were never chosen over the others, so that the scale has no finite "
             "values";
    }
  }
  const bool has_ties =
      std::ranges::any_of(choices, [](const PairChoices& pair) { return pair.ties > 0; });
  if (has_ties && ties_outweigh(methods, choices)) {
    return "no choices contradict one another but for ties, so that the scale has no finite values";
  }
  return "";
}

// Deviance against the model that gives every ordered pair shares of its own.
double saturated(const std::vector<PairChoices>& choices, double& parameters, bool with_ties) {
  std::map<std::pair<std::uint16_t, std::uint16_t>, Three> sums;
  for (const PairChoices& pair : choices) {
    Three& sum = sums[{pair.left, pair.right}];
    sum[left_wins] += static_cast<double>(pair.left_wins);
    sum[right_wins] += static_cast<double>(pair.right_wins);
    sum[tie] += static_cast<double>(pair.ties);
  }
  double log_likelihood = 0.0;
  for (const auto& [pair, sum] : sums) {
    const double n = sum[0] + sum[1] + sum[2];
    for (const double count : sum) log_likelihood += count > 0 ? count * std::log(count / n) : 0.0;
  }
  parameters = static_cast<double>(sums.size()) * (with_ties ? 2.0 : 1.0);
  return log_likelihood;
}

// Covariance of the values that add up to 0, from that of the parameters.
Matrix centred(const Matrix& covariance, std::size_t methods) {
  const auto at = [&](std::size_t i, std::size_t j) {
    return i == 0 || j == 0 ? 0.0 : covariance.at(i - 1, j - 1);
  };
  std::vector<double> mean(methods);
  double all = 0.0;
  for (std::size_t i = 0; i < methods; ++i) {
    for (std::size_t j = 0; j < methods; ++j) mean[i] += at(i, j) / static_cast<double>(methods);
    all += mean[i] / static_cast<double>(methods);
  }
  Matrix result(methods);
  for (std::size_t i = 0; i < methods; ++i) {
    for (std::size_t j = 0; j < methods; ++j) result.at(i, j) = at(i, j) - mean[i] - mean[j] + all;
  }
  return result;
}

Matrix sandwich(const Matrix& bread, const Scored& scored) {
  const auto n = static_cast<double>(scored.clusters.size());
  Matrix result(bread.size);
  for (const auto& [participant, score] : scored.clusters) {
    const std::vector<double> influence = times(bread, score);
    for (std::size_t i = 0; i < bread.size; ++i) {
      for (std::size_t j = 0; j < bread.size; ++j)
        result.at(i, j) += n / (n - 1) * influence[i] * influence[j];
    }
  }
  return result;
}

void fill(const Design& design, const std::vector<double>& parameters, const Scored& scored,
          const Matrix& bread, ScaleFit& fit) {
  double mean = 0.0;
  for (std::size_t i = 0; i < design.methods; ++i) {
    fit.values.push_back(value_of(parameters, i));
    mean += fit.values.back() / static_cast<double>(design.methods);
  }
  for (double& value : fit.values) value -= mean;
  fit.covariance = centred(bread, design.methods);
  fit.clusters = scored.clusters.size();
  const Matrix robust = fit.clusters > 1 ? sandwich(bread, scored) : Matrix();
  if (robust.size > 0) fit.robust = centred(robust, design.methods);
  if (design.with_side) {
    fit.side = parameters[design.side()];
    const double of_independent = bread.at(design.side(), design.side());
    const double variance =
        robust.size > 0 ? robust.at(design.side(), design.side()) : of_independent;
    fit.side_se = variance > roundoff_share * of_independent
                      ? Estimate(std::sqrt(variance))
                      : Estimate::none("participants do not differ at all");
  }
  if (design.with_ties) {
    const double parameter = parameters[design.ties()];
    fit.tie = design.model == ScaleModel::bradley_terry ? std::exp(parameter) : parameter;
  }
}

}  // namespace

Matrix inverse(const Matrix& matrix) {
  const GslErrorsOff errors_off;
  Matrix result = matrix;
  const auto n = matrix.size;
  gsl_matrix_view view = gsl_matrix_view_array(result.values.data(), n, n);
  if (n == 0 || gsl_linalg_cholesky_decomp1(&view.matrix) != 0 ||
      gsl_linalg_cholesky_invert(&view.matrix) != 0) {
    return Matrix();
  }
  const bool is_finite =
      std::ranges::all_of(result.values, [](double value) { return std::isfinite(value); });
  return is_finite ? result : Matrix();
}

ScaleFit fit_scale(ScaleModel model, std::size_t methods, const std::vector<PairChoices>& choices,
                   bool with_side) {
  ScaleFit fit;
  fit.side = fit.side_se = Estimate::none("not asked for");
  fit.tie = Estimate::none("there are no ties");
  fit.why_not = why_no_scale(methods, choices);
  if (!fit.why_not.empty()) return fit;
  const bool with_ties =
      std::ranges::any_of(choices, [](const PairChoices& pair) { return pair.ties > 0; });
  const Design design{model, methods, with_side, with_ties};
  std::vector<double> parameters(design.size());
  if (with_ties) parameters[design.ties()] = model == ScaleModel::bradley_terry ? 0.0 : 0.2;
  Scored scored = evaluate(design, choices, parameters);
  Matrix bread = inverse(scored.information);
  constexpr int most_steps = 200;
  constexpr double enough = 1e-10;  // of a value, whose own error is thousands of millions larger
  double longest = 1.0;
  for (int i = 0; i < most_steps && bread.size > 0 && longest > enough; ++i) {
    const std::vector<double> step = times(bread, scored.score);
    longest = 0.0;
    for (const double part : step) longest = std::max(longest, std::abs(part));
    // A step that loses is halved.
    constexpr int most_halvings = 20;
    for (int halvings = 0; halvings < most_halvings; ++halvings) {
      const double share = std::ldexp(1.0, -halvings);
      std::vector<double> next = parameters;
      for (std::size_t j = 0; j < next.size(); ++j) next[j] += share * step[j];
      const bool is_law =
          !with_ties || model == ScaleModel::bradley_terry || next[design.ties()] > 0;
      Scored there = is_law ? evaluate(design, choices, next) : Scored{};
      const double slack = 1e-12 * std::abs(scored.log_likelihood);
      if (is_law && there.log_likelihood >= scored.log_likelihood - slack) {
        parameters = std::move(next);
        scored = std::move(there);
        break;
      }
    }
    bread = inverse(scored.information);
  }
  if (bread.size == 0 || !(longest <= enough)) {
    fit.why_not =
        with_side ? "the sides cannot be told from the methods" : "the fit does not converge";
    return fit;
  }
  double parameters_of_pairs = 0.0;
  fit.log_likelihood = scored.log_likelihood;
  fit.deviance = 2 * (saturated(choices, parameters_of_pairs, with_ties) - scored.log_likelihood);
  fit.df = parameters_of_pairs - static_cast<double>(design.size());
  fill(design, parameters, scored, bread, fit);
  return fit;
}

Outcomes outcomes(ScaleModel model, const ScaleFit& fit, std::size_t left, std::size_t right) {
  const double d = fit.values[left] - fit.values[right] + (fit.side ? fit.side.value : 0.0);
  std::optional<double> parameter;
  if (fit.tie) {
    parameter = model == ScaleModel::bradley_terry ? std::log(fit.tie.value) : fit.tie.value;
  }
  const Law law = law_of(model, d, parameter);
  return {law.p[left_wins], law.p[right_wins], law.p[tie]};
}

}  // namespace pinchlab::analysis
