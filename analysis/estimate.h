// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <string>

namespace pinchlab::analysis {

/// A number, or the reason why there is none. Never a NaN, never an infinity.
struct Estimate {
  double value = 0.0;
  std::string why_not = "not computed";  ///< empty: `value` holds

  Estimate() = default;
  Estimate(double number)  // NOLINT(google-explicit-constructor): a number is an estimate
      : value(number), why_not(std::isfinite(number) ? "" : "the value is not finite") {}
  static Estimate none(std::string reason) {
    Estimate estimate;
    estimate.why_not = std::move(reason);
    return estimate;
  }
  explicit operator bool() const { return why_not.empty(); }
};

}  // namespace pinchlab::analysis
