// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What gives way along some length.

namespace pinchlab {

/// 1 at s = 0, falling smoothly to 0 at s = reach, and its derivative (1/m).
struct Fade {
  double value = 0.0, slope = 0.0;
};
inline Fade fade(double s, double reach) {
  if (s >= reach) return {};
  if (s <= 0.0) return {1.0, 0.0};
  const double x = s / reach;
  return {1.0 - x * x * (3.0 - 2.0 * x), -6.0 * x * (1.0 - x) / reach};
}

}  // namespace pinchlab
