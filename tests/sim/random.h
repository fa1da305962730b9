// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace pinchlab::testing {

/// Random numbers that are the same everywhere: std::mt19937's are fixed by the standard, but what
/// its distributions make of them is not.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  /// In [low, high).
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  /// Likewise, its logarithm uniform.
  double spread(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  /// 0 to count - 1, each as often.
  int below(int count) {
    const auto n = static_cast<std::uint_fast32_t>(count);
    const std::uint_fast32_t share = 0xFFFFFFFFU / n;
    while (true) {
      const std::uint_fast32_t value = engine_() / share;
      if (value < n) return static_cast<int>(value);
    }
  }

 private:
  std::mt19937 engine_;
};

/// How many of `count` random scenes a test runs: all; but a quarter, rounded up, under the
/// sanitizers, where they take ten times as long. Those look for what no scene may do at all.
template <class Count>
constexpr Count seeds_of(Count count) {
#ifdef __SANITIZE_ADDRESS__
  return (count + 3) / 4;
#else
  return count;
#endif
}

}  // namespace pinchlab::testing
