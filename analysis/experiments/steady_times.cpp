// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/steady_times.h"

#include <algorithm>
#include <cmath>

#include "analysis/experiments/experiment.h"

namespace pinchlab::experiments {

namespace {

// Standard error of a median, from the deciles of normal samples: these are 2.563 standard
// deviations apart, and a median scatters by sqrt(pi / 2 / n) of one.
bool is_steady(const std::vector<double>& times) {
  constexpr std::size_t fewest = 15;
  constexpr double doubt = 0.02;
  if (times.size() < fewest) return false;
  const Spread of = spread(times);
  const double deviation = (of.high - of.low) / 2.563;
  return deviation * std::sqrt(1.5708 / static_cast<double>(times.size())) <= doubt * of.median;
}

}  // namespace

std::vector<double> steady_times(const std::vector<std::function<double()>>& samplers,
                                 double most_s) {
  std::vector<std::vector<double>> times(samplers.size());
  for (double used = 0.0; used < most_s && !std::ranges::all_of(times, is_steady);) {
    for (std::size_t i = 0; i < samplers.size(); ++i) {
      times[i].push_back(samplers[i]());
      used += times[i].back();
    }
  }
  std::vector<double> medians;
  medians.reserve(times.size());
  for (const std::vector<double>& of_one : times) medians.push_back(spread(of_one).median);
  return medians;
}

}  // namespace pinchlab::experiments
