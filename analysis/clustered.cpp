// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/clustered.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <map>
#include <numeric>

#include "analysis/tests_2afc.h"

namespace pinchlab::analysis {

namespace {

constexpr const char* no_participants =
    "the input is a table of counts, which does not say whose answers are whose";
constexpr const char* one_participant =
    "one participant; nothing is known of how participants differ";
constexpr const char* no_variance =
    "participants do not differ at all, so the variance between them is 0";

std::vector<bool> members_of(const AnswersTable& table, const Group& group) {
  std::vector<bool> members(table.demonstrations.size());
  for (std::uint16_t index : group.demonstrations) members[index] = true;
  return members;
}

Cluster sum_of(std::span<const Cluster> clusters) {
  Cluster sum;
  for (const Cluster& cluster : clusters)
    sum.answers += cluster.answers, sum.pinch += cluster.pinch;
  return sum;
}

// How many participants there are of each (answers, pinch): all that the pooled statistics depend
// on.
struct ClusterTypes {
  std::vector<Cluster> type;
  std::vector<double> count;
};

ClusterTypes types_of(std::span<const Cluster> clusters) {
  std::map<Cluster, double> counts;
  for (const Cluster& cluster : clusters) ++counts[cluster];
  ClusterTypes types;
  for (const auto& [type, count] : counts) types.type.push_back(type), types.count.push_back(count);
  return types;
}

// Share of pinch and its linearised variance with participants as clusters.
struct ShareAndVariance {
  double share;
  double variance;
};

template <class Weight>
ShareAndVariance share_and_variance(const std::vector<Cluster>& types, const Weight* weight) {
  double participants = 0.0, answers = 0.0, pinch = 0.0;
  for (size_t t = 0; t < types.size(); ++t) {
    const auto w = static_cast<double>(weight[t]);
    participants += w;
    answers += w * types[t].answers;
    pinch += w * types[t].pinch;
  }
  const double share = pinch / answers;
  double squares = 0.0;
  for (size_t t = 0; t < types.size(); ++t) {
    const double surplus = types[t].pinch - types[t].answers * share;
    squares += static_cast<double>(weight[t]) * surplus * surplus;
  }
  // Identical participants leave round-off only, which must not pass for a variance.
  if (squares < 1e-20 * answers * answers) squares = 0.0;
  return {share, participants / (participants - 1.0) * squares / (answers * answers)};
}

// P(|sum of d_i s_i| >= |sum of d_i|), s_i = +-1, by building up the distribution of the sum.
double exact_flip_p(const std::vector<std::int64_t>& sizes, std::int64_t observed,
                    std::int64_t range) {
  std::vector<double> probability(static_cast<size_t>(2 * range + 1), 0.0);
  std::vector<double> next(probability.size());
  probability[static_cast<size_t>(range)] = 1.0;
  std::int64_t reach = 0;
  for (std::int64_t size : sizes) {
    std::fill(next.begin(), next.end(), 0.0);
    for (std::int64_t sum = -reach; sum <= reach; ++sum) {
      const double half = 0.5 * probability[static_cast<size_t>(sum + range)];
      next[static_cast<size_t>(sum + size + range)] += half;
      next[static_cast<size_t>(sum - size + range)] += half;
    }
    reach += size;
    probability.swap(next);
  }
  double p = 0.0;
  for (std::int64_t sum = -range; sum <= range; ++sum) {
    if (std::abs(sum) >= observed) p += probability[static_cast<size_t>(sum + range)];
  }
  return std::min(1.0, p);
}

// The same by random flips; participants with scores of one size are flipped together.
double monte_carlo_flip_p(const std::vector<std::int64_t>& sizes, std::int64_t observed,
                          gsl_rng* rng) {
  std::map<std::int64_t, unsigned> count_of_size;
  for (std::int64_t size : sizes) ++count_of_size[size];
  constexpr int flips = 99999;
  int as_far = 0;
  for (int i = 0; i < flips; ++i) {
    std::int64_t sum = 0;
    for (const auto& [size, count] : count_of_size) {
      sum += size * (2 * static_cast<std::int64_t>(gsl_ran_binomial(rng, 0.5, count)) - count);
    }
    as_far += std::abs(sum) >= observed ? 1 : 0;
  }
  return (1.0 + as_far) / (1.0 + flips);
}

}  // namespace

std::vector<Cluster> clusters_of(const AnswersTable& table, const Group& group) {
  const std::vector<bool> member = members_of(table, group);
  std::vector<Cluster> clusters;
  each_participant(table.answers, [&](std::span<const Answer> own) {
    Cluster cluster;
    for (const Answer& answer : own) {
      if (!member[answer.demonstration]) continue;
      ++cluster.answers;
      cluster.pinch += answer.chose_pinch ? 1 : 0;
    }
    if (cluster.answers > 0) clusters.push_back(cluster);
  });
  return clusters;
}

RaoScott rao_scott(std::span<const Cluster> clusters) {
  RaoScott result;
  const auto all = [&](const char* reason) {
    result.variance = result.design_effect = result.icc = Estimate::none(reason);
    result.chi_square = result.p = result.p_f = Estimate::none(reason);
    return result;
  };
  if (clusters.empty()) return all(no_participants);
  if (clusters.size() == 1) return all(one_participant);
  const Cluster sum = sum_of(clusters);
  const ClusterTypes types = types_of(clusters);
  const auto [share, variance] = share_and_variance(types.type, types.count.data());
  result.variance = variance;
  if (sum.pinch == 0 || sum.pinch == sum.answers) {
    const char* reason = "every answer is the same, so there is no variance to compare";
    result.design_effect = result.icc = Estimate::none(reason);
    result.chi_square = result.p = result.p_f = Estimate::none(reason);
    return result;
  }
  const double answers = sum.answers;
  const auto participants = static_cast<double>(clusters.size());
  const double effect = variance / (share * (1.0 - share) / answers);
  result.design_effect = effect;
  const double mean = answers / participants;
  result.icc = mean > 1.0 ? Estimate((effect - 1.0) / (mean - 1.0))
                          : Estimate::none("one answer a participant");
  if (variance == 0.0) {
    result.chi_square = result.p = result.p_f = Estimate::none(no_variance);
    return result;
  }
  const double corrected = chi_square_half({sum.pinch, sum.answers - sum.pinch}) / effect;
  result.chi_square = corrected;
  result.p = chi_square_p(corrected, 1.0);
  const GslErrorsOff guard;
  result.p_f = gsl_cdf_fdist_Q(corrected, 1.0, participants - 1.0);
  return result;
}

SignFlip sign_flip_test(std::vector<std::int64_t> scores, RandomUse use, std::uint64_t seed) {
  SignFlip result;
  const std::int64_t observed =
      std::abs(std::accumulate(scores.begin(), scores.end(), std::int64_t{0}));
  std::int64_t divisor = 0;
  for (std::int64_t& score : scores) {
    score = std::abs(score);
    divisor = std::gcd(divisor, score);
  }
  std::erase(scores, 0);
  if (scores.empty()) {
    result.p = 1.0;  // every sign pattern gives the observed sum, 0
    return result;
  }
  std::int64_t range = 0;
  for (std::int64_t& score : scores) range += score /= divisor;
  result.exact =
      range <= 1000000 && static_cast<double>(range) * static_cast<double>(scores.size()) <= 1e8;
  if (result.exact) {
    result.p = exact_flip_p(scores, observed / divisor, range);
  } else {
    const Rng rng = make_rng(use, seed);
    result.p = monte_carlo_flip_p(scores, observed / divisor, rng.get());
  }
  return result;
}

std::vector<std::int64_t> preference_scores(std::span<const Cluster> clusters) {
  std::vector<std::int64_t> scores;
  for (const Cluster& cluster : clusters) scores.push_back(2 * cluster.pinch - cluster.answers);
  return scores;
}

ClusterBootstrap cluster_bootstrap(std::span<const Cluster> clusters, double alpha, int resamples,
                                   gsl_rng* rng) {
  ClusterBootstrap result;
  const auto all = [&](const char* reason) {
    result.low = result.high = result.p = Estimate::none(reason);
    return result;
  };
  if (clusters.empty()) return all(no_participants);
  if (clusters.size() == 1) return all(one_participant);
  const ClusterTypes types = types_of(clusters);
  const auto [share, variance] = share_and_variance(types.type, types.count.data());
  if (variance == 0.0) return all(no_variance);

  const double error = std::sqrt(variance);
  const double observed = std::abs(share - 0.5) / error;
  std::vector<double> distance(static_cast<size_t>(resamples));
  std::vector<unsigned> drawn(types.type.size());
  int as_far = 0;
  for (double& t : distance) {
    gsl_ran_multinomial(rng, drawn.size(), static_cast<unsigned>(clusters.size()),
                        types.count.data(), drawn.data());
    const auto again = share_and_variance(types.type, drawn.data());
    const double away = std::abs(again.share - share);
    // A resample of identical participants is infinitely far unless it hits the share itself.
    t = again.variance > 0.0 ? away / std::sqrt(again.variance)
        : away > 1e-12       ? std::numeric_limits<double>::infinity()
                             : 0.0;
    as_far += t >= observed ? 1 : 0;
  }
  result.resamples = resamples;
  result.p = (1.0 + as_far) / (1.0 + resamples);
  const auto rank = static_cast<size_t>(std::ceil((1.0 - alpha) * (resamples + 1.0)));
  const size_t index = std::min(rank, distance.size()) - 1;
  std::nth_element(distance.begin(), distance.begin() + static_cast<std::ptrdiff_t>(index),
                   distance.end());
  if (!std::isfinite(distance[index])) {
    result.low = result.high = Estimate::none(
        "too few participants that differ: resamples without variance "
        "are too many");
    return result;
  }
  result.low = std::max(0.0, share - distance[index] * error);
  result.high = std::min(1.0, share + distance[index] * error);
  return result;
}

CochranQ cochran_q(const AnswersTable& table, const Group& group) {
  CochranQ result;
  const auto all = [&](const char* reason) {
    result.q = result.df = result.p = Estimate::none(reason);
    return result;
  };
  if (table.answers.empty()) return all(no_participants);
  if (group.demonstrations.size() < 2) return all("one demonstration cannot differ from itself");
  const std::vector<bool> member = members_of(table, group);
  const size_t k = group.demonstrations.size();
  const size_t complete = k * static_cast<size_t>(table.answers_per_demonstration);
  std::vector<double> column(table.demonstrations.size(), 0.0);
  std::vector<double> score(table.demonstrations.size());
  double total = 0.0;
  double spread = 0.0;  // sum over participants of K sum of squares - square of sum
  each_participant(table.answers, [&](std::span<const Answer> own) {
    size_t answers = 0;
    std::fill(score.begin(), score.end(), 0.0);
    for (const Answer& answer : own) {
      if (!member[answer.demonstration]) continue;
      ++answers;
      score[answer.demonstration] += answer.chose_pinch ? 1.0 : 0.0;
    }
    if (answers < complete) return;
    ++result.participants;
    double sum = 0.0, squares = 0.0;
    for (std::uint16_t j : group.demonstrations) {
      column[j] += score[j];
      sum += score[j];
      squares += score[j] * score[j];
    }
    total += sum;
    spread += static_cast<double>(k) * squares - sum * sum;
  });
  if (result.participants == 0)
    return all("no participant chose in every demonstration as often as it was shown");
  // Of one alone Q is df, whatever the answers are.
  if (result.participants == 1) return all("only one participant chose in every demonstration");
  if (spread == 0.0)
    return all("no participant answered differently from one demonstration to another");
  const auto width = static_cast<double>(k);
  double column_squares = 0.0;
  for (double sum : column) column_squares += sum * sum;
  const double q = (width - 1.0) * (width * column_squares - total * total) / spread;
  result.q = q;
  result.df = width - 1.0;
  result.p = chi_square_p(q, width - 1.0);
  return result;
}

Pooled pooled_tests(const AnswersTable& table, const Group& group, double alpha, int resamples,
                    std::uint64_t seed) {
  Counts counts;
  for (std::uint16_t index : group.demonstrations) {
    counts.pinch += table.counts[index].pinch;
    counts.cable += table.counts[index].cable;
  }
  Pooled result;
  result.chi_square = chi_square_half(counts);
  result.p_naive = chi_square_p(result.chi_square.value, 1.0);
  const std::vector<Cluster> clusters = clusters_of(table, group);
  result.participants = static_cast<int>(clusters.size());
  result.rao_scott = rao_scott(clusters);
  if (clusters.empty()) {
    result.sign_flip.p = Estimate::none(no_participants);
  } else {
    result.sign_flip = sign_flip_test(preference_scores(clusters), RandomUse::sign_flip, seed);
  }
  const Rng rng = make_rng(RandomUse::bootstrap, seed);
  result.bootstrap = cluster_bootstrap(clusters, alpha, resamples, rng.get());
  return result;
}

}  // namespace pinchlab::analysis
