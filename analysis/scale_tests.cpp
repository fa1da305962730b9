// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/scale_tests.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_statistics_double.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "analysis/gsl_support.h"
#include "analysis/tests_2afc.h"

namespace pinchlab::analysis {
namespace {

constexpr const char* no_participants =
    "the input does not say whose answers are whose, or there is one participant";

double score_of(const Matrix& inverse_laplacian, const std::vector<double>& wins) {
  double sum = 0.0;
  for (std::size_t i = 0; i < inverse_laplacian.size; ++i) {
    for (std::size_t j = 0; j < inverse_laplacian.size; ++j)
      sum += wins[i] * inverse_laplacian.at(i, j) * wins[j];
  }
  return sum;
}

// Of each method the last that comparisons lead to from it.
std::vector<std::size_t> last_of_part(std::size_t methods,
                                      const std::vector<PairChoices>& choices) {
  std::vector<std::size_t> last(methods);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (const PairChoices& pair : choices) {
    const std::size_t left = last[pair.left], right = last[pair.right];
    if (pair.left_wins + pair.right_wins == 0) continue;
    for (std::size_t& one : last) {
      if (one == left || one == right) one = std::max(left, right);
    }
  }
  return last;
}

// Numbers that rounding may have parted are not more extreme than each other.
bool as_extreme(double value, double observed) {
  return value >= observed - 1e-9 * std::max(1.0, std::abs(observed));
}

double binomial3(std::size_t m) {
  const auto n = static_cast<double>(m);
  return n * (n - 1) * (n - 2) / 6;
}

// Most circular triads among m methods (Kendall and Babington Smith 1940).
double most_triads(std::size_t m) {
  const auto n = static_cast<double>(m);
  return m % 2 == 1 ? (n * n * n - n) / 24 : (n * n * n - 4 * n) / 24;
}

// C(m, 3) - sum of C(wins, 2): every triple that is not circular has one that beats the two others.
long circular_triads(const std::vector<long>& wins) {
  double rest = binomial3(wins.size());
  for (const long w : wins) rest -= static_cast<double>(w * (w - 1)) / 2;
  return std::lround(rest);
}

// P(sum of the circular triads of `rounds` random rounds <= observed).
double chance_of_so_few(std::size_t methods, long rounds, long observed) {
  if (methods > 7 || rounds > 2000) {
    const double mean = static_cast<double>(rounds) * binomial3(methods) / 4;
    const double variance = 3 * mean / 4;  // Moran, Biometrika 34 (1947) 363
    return gsl_cdf_ugaussian_P((static_cast<double>(observed) + 0.5 - mean) / std::sqrt(variance));
  }
  std::vector<double> one = triad_counts(methods);
  const double all = std::accumulate(one.begin(), one.end(), 0.0);
  for (double& count : one) count /= all;
  std::vector<double> sum = {1.0};
  for (long i = 0; i < rounds; ++i) {
    std::vector<double> next(
        std::min(sum.size() + one.size() - 1, static_cast<std::size_t>(observed) + 1));
    for (std::size_t a = 0; a < sum.size(); ++a) {
      for (std::size_t b = 0; b < one.size() && a + b < next.size(); ++b)
        next[a + b] += sum[a] * one[b];
    }
    sum = std::move(next);
  }
  return std::min(1.0, std::accumulate(sum.begin(), sum.end(), 0.0));
}

void count_stochastic_transitivity(std::size_t m, const std::vector<PairChoices>& choices,
                                   Transitivity& result) {
  std::vector<double> wins(m * m);
  for (const PairChoices& pair : choices) {
    wins[pair.left * m + pair.right] +=
        static_cast<double>(pair.left_wins) + static_cast<double>(pair.ties) / 2;
    wins[pair.right * m + pair.left] +=
        static_cast<double>(pair.right_wins) + static_cast<double>(pair.ties) / 2;
  }
  const auto share = [&](std::size_t a, std::size_t b) {
    const double n = wins[a * m + b] + wins[b * m + a];
    return n > 0 ? wins[a * m + b] / n : -1.0;
  };
  std::vector<std::size_t> order(3);
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = i + 1; j < m; ++j) {
      for (std::size_t k = j + 1; k < m; ++k) {
        order = {i, j, k};
        if (share(i, j) < 0 || share(j, k) < 0 || share(i, k) < 0) continue;
        ++result.triples;
        // The arrangement that breaks least is the one that counts.
        long least = 3;
        do {
          const double ab = share(order[0], order[1]), bc = share(order[1], order[2]),
                       ac = share(order[0], order[2]);
          if (ab < 0.5 || bc < 0.5) continue;
          const long broken = ac < 0.5                ? 3
                              : ac < std::min(ab, bc) ? 2
                              : ac < std::max(ab, bc) ? 1
                                                      : 0;
          least = std::min(least, broken);
        } while (std::ranges::next_permutation(order).found);
        result.weak += least >= 3 ? 1 : 0;
        result.moderate += least >= 2 ? 1 : 0;
        result.strong += least >= 1 ? 1 : 0;
      }
    }
  }
}

// How often the score is as extreme where participants' answers change sides by chance; `wins` less
// losses are each participant's.
void flip_signs(EqualScale& result, const Matrix& metric,
                const std::vector<std::vector<double>>& wins, const Rng& rng, int resamples) {
  constexpr std::size_t most_exact = 16;
  const std::size_t participants = wins.size();
  result.exact = participants <= most_exact;
  const auto flipped = [&](const auto& is_flipped) {
    std::vector<double> total(wins.front().size());
    for (std::size_t i = 0; i < participants; ++i) {
      const double sign = is_flipped(i) ? -1.0 : 1.0;
      for (std::size_t j = 0; j < total.size(); ++j) total[j] += sign * wins[i][j];
    }
    return as_extreme(score_of(metric, total), result.score) ? 1.0 : 0.0;
  };
  double extreme = 0.0;
  if (result.exact) {
    // The last never turns: turning all changes nothing.
    const std::uint64_t patterns = std::uint64_t{1} << (participants - 1);
    for (std::uint64_t pattern = 0; pattern < patterns; ++pattern)
      extreme += flipped([&](std::size_t i) { return ((pattern >> i) & 1U) == 1; });
    result.p_sign_flip = extreme / static_cast<double>(patterns);
    return;
  }
  for (int i = 0; i < resamples; ++i)
    extreme += flipped([&](std::size_t) { return gsl_rng_uniform_int(rng.get(), 2) == 1; });
  result.p_sign_flip = (extreme + 1) / (resamples + 1.0);
}

}  // namespace

EqualScale equal_scale(std::size_t methods, const std::vector<PairChoices>& choices,
                       std::uint64_t seed, int resamples) {
  // Among methods that are compared with each other wins minus losses add up to 0, so that all but
  // the last say everything, and the same rows of the Laplacian have an inverse.
  const std::vector<std::size_t> last = last_of_part(methods, choices);
  std::vector<std::size_t> row(methods);
  std::size_t size = 0;
  for (std::size_t i = 0; i < methods; ++i) row[i] = last[i] == i ? methods : size++;
  EqualScale result;
  result.df = static_cast<double>(size);
  if (size == 0) {
    result.p_chi_square = result.p_sign_flip = Estimate::none("all answers are ties");
    return result;
  }
  Matrix laplacian(size);
  std::map<std::uint32_t, std::vector<double>> by_participant;
  std::vector<double> sum(size);
  for (const PairChoices& pair : choices) {
    const auto n = static_cast<double>(pair.left_wins + pair.right_wins);
    const double more = static_cast<double>(pair.left_wins) - static_cast<double>(pair.right_wins);
    std::vector<double>& own = by_participant[pair.participant];
    own.resize(size);
    const std::size_t left = row[pair.left], right = row[pair.right];
    for (auto* wins : {&own, &sum}) {
      if (left < size) (*wins)[left] += more;
      if (right < size) (*wins)[right] -= more;
    }
    for (const auto& [i, j] : {std::pair{left, right}, {right, left}}) {
      if (i < size) laplacian.at(i, i) += n;
      if (i < size && j < size) laplacian.at(i, j) -= n;
    }
  }
  const Matrix metric = inverse(laplacian);
  result.score = score_of(metric, sum);
  result.p_chi_square = chi_square_p(result.score, result.df);
  const std::size_t participants = by_participant.size();
  if (participants < 2) {
    result.p_sign_flip = Estimate::none(no_participants);
    return result;
  }
  std::vector<std::vector<double>> wins;
  wins.reserve(participants);
  for (auto& [participant, own] : by_participant) wins.push_back(std::move(own));
  flip_signs(result, metric, wins, make_rng(RandomUse::sign_flip, seed, methods), resamples);
  return result;
}

ScaleDifference scale_difference(ScaleModel model, const ScaleFit& fit, std::size_t methods,
                                 std::size_t demonstrations,
                                 const std::vector<PairChoices>& choices, std::uint64_t seed,
                                 int resamples) {
  ScaleDifference result;
  // Residual wins of each method, by participant and demonstration.
  std::map<std::uint32_t, std::vector<std::vector<double>>> residuals;
  for (const PairChoices& pair : choices) {
    auto& own = residuals[pair.participant];
    own.resize(demonstrations, std::vector<double>(methods));
    const Outcomes expected = outcomes(model, fit, pair.left, pair.right);
    const double more = static_cast<double>(pair.left_wins) - static_cast<double>(pair.right_wins) -
                        static_cast<double>(pair.total()) * (expected.left - expected.right);
    own[pair.demonstration][pair.left] += more;
    own[pair.demonstration][pair.right] -= more;
  }
  if (demonstrations < 2 || residuals.size() < 2) {
    result.statistic = result.p =
        Estimate::none(demonstrations < 2 ? "one demonstration" : no_participants);
    return result;
  }
  std::vector<std::size_t> order(demonstrations);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto statistic = [&](const auto& shuffle) {
    std::vector<double> sums(demonstrations * methods);
    for (const auto& [participant, own] : residuals) {
      shuffle();
      for (std::size_t i = 0; i < demonstrations; ++i) {
        for (std::size_t j = 0; j < methods; ++j) sums[i * methods + j] += own[order[i]][j];
      }
    }
    return std::inner_product(sums.begin(), sums.end(), sums.begin(), 0.0);
  };
  const double observed = statistic([] {});
  const Rng rng = make_rng(RandomUse::order_flip, seed, demonstrations);
  int extreme = 0;
  for (int i = 0; i < resamples; ++i) {
    const double value = statistic(
        [&] { gsl_ran_shuffle(rng.get(), order.data(), order.size(), sizeof(std::size_t)); });
    extreme += as_extreme(value, observed) ? 1 : 0;
  }
  result.statistic = observed;
  result.p = (extreme + 1.0) / (resamples + 1.0);
  return result;
}

std::vector<double> triad_counts(std::size_t methods) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < methods; ++i) {
    for (std::size_t j = i + 1; j < methods; ++j) pairs.emplace_back(i, j);
  }
  std::vector<double> counts(static_cast<std::size_t>(most_triads(methods)) + 1);
  std::vector<long> wins(methods);
  for (std::uint64_t way = 0; way < std::uint64_t{1} << pairs.size(); ++way) {
    std::ranges::fill(wins, 0);
    for (std::size_t k = 0; k < pairs.size(); ++k)
      ++wins[((way >> k) & 1U) == 1 ? pairs[k].first : pairs[k].second];
    ++counts[static_cast<std::size_t>(circular_triads(wins))];
  }
  return counts;
}

Transitivity transitivity(std::size_t methods, std::size_t participants, std::size_t demonstrations,
                          const std::vector<PairChoices>& choices) {
  Transitivity result;
  result.most = most_triads(methods);
  result.by_chance = binomial3(methods) / 4;
  result.of_participant.assign(participants, 0);
  result.rounds_of_participant.assign(participants, 0);
  result.consistence = result.p = Estimate::none(
      methods < 3         ? "two methods make no triples"
      : participants == 0 ? "the input does not say whose answers are whose"
                          : "no participant chose once in every pair of a demonstration");
  count_stochastic_transitivity(methods, choices, result);
  if (methods < 3 || participants == 0) return result;
  struct Round {
    std::vector<long> wins;
    std::map<std::pair<std::size_t, std::size_t>, std::int64_t> answers;
    bool is_whole = true;
  };
  std::vector<Round> rounds(participants * demonstrations);
  for (const PairChoices& pair : choices) {
    Round& round = rounds[pair.participant * demonstrations + pair.demonstration];
    round.wins.resize(methods);
    round.wins[pair.left] += pair.left_wins;
    round.wins[pair.right] += pair.right_wins;
    round.answers[{std::min(pair.left, pair.right), std::max(pair.left, pair.right)}] +=
        pair.total();
    round.is_whole = round.is_whole && pair.ties == 0;
  }
  double consistence = 0.0;
  for (std::size_t i = 0; i < rounds.size(); ++i) {
    const Round& round = rounds[i];
    const bool is_once =
        std::ranges::all_of(round.answers, [](const auto& pair) { return pair.second == 1; });
    if (!round.is_whole || !is_once || round.answers.size() != methods * (methods - 1) / 2)
      continue;
    const long triads = circular_triads(round.wins);
    ++result.rounds;
    result.triads += triads;
    result.without += triads == 0 ? 1 : 0;
    consistence += 1 - static_cast<double>(triads) / result.most;
    result.of_participant[i / demonstrations] += triads;
    ++result.rounds_of_participant[i / demonstrations];
  }
  if (result.rounds > 0) {
    result.consistence = consistence / static_cast<double>(result.rounds);
    result.p = chance_of_so_few(methods, result.rounds, result.triads);
  }
  return result;
}

std::vector<ObserverFit> observer_fits(ScaleModel model, std::size_t methods,
                                       std::size_t participants,
                                       const std::vector<PairChoices>& choices) {
  std::vector<ObserverFit> fits;
  std::vector<double> likelihoods;
  for (std::uint32_t who = 0; who < participants; ++who) {
    ObserverFit& fit = fits.emplace_back();
    fit.participant = who;
    std::vector<PairChoices> others, own;
    for (const PairChoices& pair : choices)
      (pair.participant == who ? own : others).push_back(pair);
    const ScaleFit scale = fit_scale(model, methods, others);
    if (!scale.why_not.empty()) {
      fit.log_likelihood = Estimate::none("without this participant, " + scale.why_not);
      continue;
    }
    const bool has_ties =
        std::ranges::any_of(own, [](const PairChoices& pair) { return pair.ties > 0; });
    if (has_ties && !scale.tie) {
      fit.log_likelihood = Estimate::none(
          "the other participants gave no ties, by which to tell how likely those of this one are");
      continue;
    }
    double sum = 0.0;
    for (const PairChoices& pair : own) {
      const Outcomes p = outcomes(model, scale, pair.left, pair.right);
      const auto add = [&](std::int64_t count, double share) {
        if (count > 0) sum += static_cast<double>(count) * std::log(std::max(share, 1e-300));
      };
      add(pair.left_wins, p.left);
      add(pair.right_wins, p.right);
      add(pair.ties, p.tie);
      fit.answers += pair.total();
    }
    if (fit.answers > 0) {
      fit.log_likelihood = sum / static_cast<double>(fit.answers);
      likelihoods.push_back(fit.log_likelihood.value);
    }
  }
  if (likelihoods.size() < fewest_compared) return fits;
  std::ranges::sort(likelihoods);
  const auto quantile = [&](double share) {
    return gsl_stats_quantile_from_sorted_data(likelihoods.data(), 1, likelihoods.size(), share);
  };
  const double low = quantile(0.25), high = quantile(0.75);
  for (ObserverFit& fit : fits) {
    fit.is_far_out = fit.log_likelihood && fit.log_likelihood.value < low - 1.5 * (high - low);
  }
  return fits;
}

std::string why_nobody_is_compared(const std::vector<ObserverFit>& fits) {
  const auto compared = std::ranges::count_if(
      fits, [](const ObserverFit& fit) { return fit.answers > 0 && fit.log_likelihood; });
  return static_cast<std::size_t>(compared) >= fewest_compared
             ? ""
             : "fewer than five participants can be held against a scale of all others";
}

}  // namespace pinchlab::analysis
