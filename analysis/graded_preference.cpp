// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/graded_preference.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/tests_2afc.h"

namespace pinchlab::analysis {
namespace {

constexpr std::size_t most_exact = 300;  // scores

// Twice the ranks, so that shared ones are whole numbers too.
std::vector<std::size_t> doubled_ranks(const std::vector<double>& sizes) {
  std::vector<double> sorted = sizes;
  std::ranges::sort(sorted);
  std::vector<std::size_t> ranks;
  ranks.reserve(sizes.size());
  for (const double size : sizes) {
    const auto [begin, end] = std::equal_range(sorted.begin(), sorted.end(), size);
    ranks.push_back(static_cast<std::size_t>((begin - sorted.begin()) + (end - sorted.begin())) +
                    1);
  }
  return ranks;
}

// P(the sum is at most `sum`) where each rank counts or not, as a fair coin falls.
double share_at_most(const std::vector<std::size_t>& ranks, std::size_t sum) {
  std::size_t reached = 0;
  for (const std::size_t rank : ranks) reached += rank;
  std::vector<double> share(reached + 1, 0.0);
  share[0] = 1.0;
  reached = 0;
  for (const std::size_t rank : ranks) {
    reached += rank;
    for (std::size_t s = reached + 1; s-- > 0;) {
      share[s] = 0.5 * (share[s] + (s >= rank ? share[s - rank] : 0.0));
    }
  }
  double total = 0.0;
  for (std::size_t s = 0; s <= sum; ++s) total += share[s];
  return total;
}

double normal_p(const std::vector<std::size_t>& ranks, double doubled_sum) {
  double mean = 0.0, variance = 0.0;
  for (const std::size_t rank : ranks) {
    const auto half = static_cast<double>(rank) / 2.0;
    mean += half;
    variance += half * half;
  }
  const double distance = std::abs(doubled_sum - mean);
  return std::min(1.0, 2.0 * gsl_cdf_ugaussian_Q(distance / std::sqrt(variance)));
}

GradedPreference summary(const std::string& name, const std::vector<const GradedAnswer*>& answers) {
  GradedPreference result;
  result.name = name;
  std::map<std::string, std::pair<double, double>> sums;  // participant -> sum, answers
  for (const GradedAnswer* answer : answers) {
    ++result.answers;
    result.ties += answer->grade == 0 ? 1 : 0;
    auto& [sum, count] = sums[answer->participant];
    sum += answer->grade;
    ++count;
  }
  std::vector<double> means;
  means.reserve(sums.size());
  for (const auto& [participant, sum] : sums) means.push_back(sum.first / sum.second);
  result.participants = means.size();
  for (const double mean : means) result.mean += mean / static_cast<double>(means.size());
  result.test = signed_rank_test(means);
  return result;
}

}  // namespace

SignedRank signed_rank_test(const std::vector<double>& scores) {
  SignedRank result;
  std::vector<double> sizes;
  for (const double score : scores) {
    if (score != 0.0) sizes.push_back(std::abs(score));
    ++(score > 0.0 ? result.positive : score < 0.0 ? result.negative : result.zeros);
  }
  if (sizes.empty()) {
    result.p = result.p_sign = Estimate::none("every participant's mean is 0");
    return result;
  }
  const std::vector<std::size_t> ranks = doubled_ranks(sizes);
  std::size_t plus = 0, all = 0;
  std::size_t i = 0;
  for (const double score : scores) {
    if (score == 0.0) continue;
    all += ranks[i];
    plus += score > 0.0 ? ranks[i] : 0;
    ++i;
  }
  result.w_plus = static_cast<double>(plus) / 2.0;
  result.is_exact = ranks.size() <= most_exact;
  result.p = result.is_exact ? std::min(1.0, 2.0 * share_at_most(ranks, std::min(plus, all - plus)))
                             : normal_p(ranks, static_cast<double>(plus));
  result.p_sign = exact_binomial_p(
      {static_cast<std::int64_t>(result.positive), static_cast<std::int64_t>(result.negative)});
  return result;
}

std::vector<GradedPreference> graded_preferences(const AnswersTable& table) {
  std::vector<GradedPreference> results;
  if (table.graded.empty()) return results;
  std::map<std::string, std::vector<const GradedAnswer*>> of;
  for (const GradedAnswer& answer : table.graded) of[answer.demonstration].push_back(&answer);
  std::vector<double> ps;
  for (const auto& [name, answers] : of) {
    results.push_back(summary(name, answers));
    const Estimate& p = results.back().test.p;
    ps.push_back(p ? p.value : 1.0);
  }
  const std::vector<double> adjusted = holm(ps);
  for (std::size_t i = 0; i < results.size(); ++i) {
    results[i].p_holm = results[i].test.p ? Estimate(adjusted[i]) : results[i].test.p;
  }
  for (const Group& group : table.groups) {
    std::vector<const GradedAnswer*> answers;
    for (const std::uint16_t index : group.demonstrations) {
      const auto& more = of[table.demonstrations[index]];
      answers.insert(answers.end(), more.begin(), more.end());
    }
    if (group.name == all_group) {  // with demonstrations of which all answers are ties
      answers.clear();
      for (const GradedAnswer& answer : table.graded) answers.push_back(&answer);
    }
    results.push_back(summary(group.name, answers));
    results.back().p_holm = Estimate::none("a group is not one of the demonstrations");
  }
  return results;
}

}  // namespace pinchlab::analysis
