// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/size_study.h"

#include <gsl/gsl_randist.h>

#include "analysis/tests_2afc.h"

namespace pinchlab::analysis {

std::vector<Cluster> simulate_study(const SizeCondition& condition, gsl_rng* rng) {
  std::vector<Cluster> clusters;
  for (int i = 0; i < condition.participants; ++i) {
    const double shape = 0.5 * (1.0 / condition.icc - 1.0);
    const double share = condition.icc > 0.0 ? gsl_ran_beta(rng, shape, shape) : 0.5;
    const auto answers = static_cast<unsigned>(condition.demonstrations);
    clusters.push_back(
        {condition.demonstrations, static_cast<int>(gsl_ran_binomial(rng, share, answers))});
  }
  return clusters;
}

std::array<double, 6> pooled_p_values(const std::vector<Cluster>& clusters, int resamples,
                                      gsl_rng* rng) {
  Counts counts;
  for (const Cluster& cluster : clusters) {
    counts.pinch += cluster.pinch;
    counts.cable += cluster.answers - cluster.pinch;
  }
  const auto value = [](const Estimate& p) { return p ? p.value : 1.0; };
  const RaoScott corrected = rao_scott(clusters);
  const SignFlip flip = sign_flip_test(preference_scores(clusters), RandomUse::sign_flip, 0);
  const ClusterBootstrap bootstrap = cluster_bootstrap(clusters, 0.05, resamples, rng);
  return {chi_square_p(chi_square_half(counts), 1.0),
          exact_binomial_p(counts),
          value(corrected.p),
          value(corrected.p_f),
          value(flip.p),
          value(bootstrap.p)};
}

std::array<double, 6> false_positive_rates(const SizeCondition& condition, int studies,
                                           double alpha, int resamples, std::uint64_t seed) {
  std::array<double, 6> rates{};
  for (int k = 0; k < studies; ++k) {
    const Rng rng = make_rng(RandomUse::study, seed, static_cast<std::uint64_t>(k));
    const auto p = pooled_p_values(simulate_study(condition, rng.get()), resamples, rng.get());
    for (size_t test = 0; test < p.size(); ++test) rates[test] += p[test] <= alpha ? 1.0 : 0.0;
  }
  for (double& rate : rates) rate /= studies;
  return rates;
}

}  // namespace pinchlab::analysis
