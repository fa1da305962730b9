// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/adaptive.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pinchlab::study {
namespace {

// The grid: thresholds a quarter of the levels' range beyond them, so that one that lies outside is
// not taken for the last level; widths from a twentieth of the range to twice the range, evenly in
// their logarithm. Kontsevich and Tyler take 4 % of lapses for granted, so that one slip does not
// mislead the rest.
constexpr int thresholds = 61, widths = 21;
constexpr double beyond = 0.25, narrowest = 0.05, widest = 2.0, lapse = 0.04;

struct Grid {
  std::vector<double> threshold, width;  // of each cell

  explicit Grid(const std::vector<double>& levels) {
    const auto [low, high] = std::ranges::minmax(levels);
    const double range = high - low;
    for (int i = 0; i < thresholds; ++i) {
      const double share = -beyond + (1 + 2 * beyond) * i / (thresholds - 1);
      for (int j = 0; j < widths; ++j) {
        threshold.push_back(low + share * range);
        width.push_back(range * narrowest * std::pow(widest / narrowest, j / (widths - 1.0)));
      }
    }
  }
  [[nodiscard]] std::size_t size() const { return threshold.size(); }

  // P(hit at this level) in each cell.
  [[nodiscard]] std::vector<double> psi(double level) const {
    const double steepness = 2 * std::log(19.0);
    std::vector<double> hit(size());
    for (std::size_t i = 0; i < size(); ++i) {
      const double g = 1 / (1 + std::exp(-steepness * (level - threshold[i]) / width[i]));
      hit[i] = 0.5 + (0.5 - lapse) * g;
    }
    return hit;
  }
};

std::vector<double> posterior_of(const Grid& grid, const std::vector<GradedAnswer>& answers) {
  std::vector<double> log_weight(grid.size());
  for (const GradedAnswer& answer : answers) {
    const std::vector<double> hit = grid.psi(answer.level);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      log_weight[i] += std::log(answer.is_hit ? hit[i] : 1 - hit[i]);
    }
  }
  const double most = std::ranges::max(log_weight);
  double sum = 0;
  for (double& weight : log_weight) sum += weight = std::exp(weight - most);
  for (double& weight : log_weight) weight /= sum;
  return log_weight;
}

// The expected entropy after an answer at a level with these shares of hits. With joint weights
// w_i of a hit (or a miss), whose sum is p, p times the entropy is p ln p - sum w_i ln w_i.
double expected_entropy(const std::vector<double>& posterior, const std::vector<double>& hit) {
  const auto x_ln_x = [](double x) { return x > 0 ? x * std::log(x) : 0.0; };
  double hits = 0, misses = 0, sum = 0;
  for (std::size_t i = 0; i < posterior.size(); ++i) {
    const double of_hit = posterior[i] * hit[i], of_miss = posterior[i] - of_hit;
    hits += of_hit;
    misses += of_miss;
    sum += x_ln_x(of_hit) + x_ln_x(of_miss);
  }
  return x_ln_x(hits) + x_ln_x(misses) - sum;
}

}  // namespace

double next_level(const std::vector<double>& levels, const std::vector<GradedAnswer>& answers) {
  const Grid grid(levels);
  const std::vector<double> posterior = posterior_of(grid, answers);
  std::vector<double> sorted = levels;
  std::ranges::sort(sorted);
  double best = sorted.front(), least = std::numeric_limits<double>::infinity();
  for (const double level : sorted) {
    const double entropy = expected_entropy(posterior, grid.psi(level));
    if (entropy < least - 1e-12) {
      best = level;
      least = entropy;
    }
  }
  return best;
}

ThresholdEstimate estimate_threshold(const std::vector<double>& levels,
                                     const std::vector<GradedAnswer>& answers) {
  const Grid grid(levels);
  const std::vector<double> posterior = posterior_of(grid, answers);
  double mean = 0, variance = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) mean += posterior[i] * grid.threshold[i];
  for (std::size_t i = 0; i < grid.size(); ++i) {
    variance += posterior[i] * (grid.threshold[i] - mean) * (grid.threshold[i] - mean);
  }
  return {mean, std::sqrt(variance)};
}

std::vector<double> levels_of(const Config& config, const std::string& series) {
  std::vector<double> levels;
  for (const GradedStimulus& stimulus : config.graded) {
    if (stimulus.clip.series == series) levels.push_back(stimulus.clip.level);
  }
  std::ranges::sort(levels);
  return levels;
}

bool is_open(const PlannedTrial& trial) {
  return trial.kind == TrialKind::main && trial.first == "reference" && !trial.level;
}

void choose_level(Session& session, const Config& config) {
  const std::size_t next = session.answers.size();
  if (next >= session.plan.size() || !is_open(session.plan[next])) return;
  const std::string& series = session.plan[next].demonstration;
  std::vector<GradedAnswer> answers;
  for (std::size_t i = 0; i < next; ++i) {
    const PlannedTrial& trial = session.plan[i];
    if (trial.kind != TrialKind::main || trial.demonstration != series) continue;
    const bool chose_reference = session.answers[i].answer.choice == trial.pinch;
    answers.push_back({trial.level.value(), chose_reference == (config.graded_hit == "reference")});
  }
  session.plan[next].level = next_level(levels_of(config, series), answers);
}

}  // namespace pinchlab::study
