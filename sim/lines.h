// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Points and straight lines between two points (m).

#include <algorithm>

#include "sim/scene.h"
#include "sim/tangent.h"

namespace pinchlab {

/// The point of the line from a to b that is nearest to x; a where the line has no length.
inline Vec2 nearest_on_line(const Vec2& a, const Vec2& b, const Vec2& x) {
  const Vec2 d = b - a;
  const double length = d.squaredNorm();
  const double share = length > 0.0 ? (x - a).dot(d) / length : 0.0;
  return a + std::clamp(share, 0.0, 1.0) * d;
}

inline double distance_from_line(const Vec2& a, const Vec2& b, const Vec2& x) {
  return (nearest_on_line(a, b, x) - x).norm();
}

inline bool lines_cross(const Vec2& a, const Vec2& b, const Vec2& p, const Vec2& q) {
  return cross(q - p, a - p) * cross(q - p, b - p) < 0.0 &&
         cross(b - a, p - a) * cross(b - a, q - a) < 0.0;
}

/// Of two lines; 0 where they cross.
inline double distance_between_lines(const Vec2& a, const Vec2& b, const Vec2& p, const Vec2& q) {
  if (lines_cross(a, b, p, q)) return 0.0;
  return std::min({distance_from_line(a, b, p), distance_from_line(a, b, q),
                   distance_from_line(p, q, a), distance_from_line(p, q, b)});
}

}  // namespace pinchlab
