// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "render/picture/picture.h"
#include "sim/outline.h"
#include "sim/scene.h"
#include "sim/tangent.h"

namespace pinchlab {

/// The outline of a polygon where it is now, moved inwards.
class PolygonOutline {
 public:
  /// `position` in m, `angle` in rad; the body outlives it.
  PolygonOutline(const BodyProperties& body, const Vec2& position, double angle)
      : body_(body), position_(position), angle_(angle) {}

  /// Where corner k of its core is, with all sides moved inwards by `inset` (m).
  Vec2 corner(std::size_t k, double inset) const;

  /// Visits the points of the outline moved inwards by `depth` (m), as visit(point, direction,
  /// whether it is another point than the last): once for each corner where it has no rounding
  /// left.
  template <class Visit>
  void trace(double depth, Visit visit) const {
    const double rounding = body_.corner_radius;
    const double inset = std::max(0.0, depth - rounding), radius = std::max(0.0, rounding - depth);
    const std::size_t count = body_.corners.size();
    for (std::size_t k = 0; k < count; ++k) {
      const Vec2 centre = corner(k, inset);
      const Vec2 before = (centre - corner(k + count - 1, inset)).normalized();
      const Vec2 after = (corner(k + 1, inset) - centre).normalized();
      const double bend = std::atan2(cross(before, after), before.dot(after));
      const int pieces = static_cast<int>(std::ceil(bend / most_turn));
      for (int piece = 0; piece <= pieces; ++piece) {
        const Vec2 e = turned(before, bend * piece / pieces);
        visit(Vec2(centre - radius * left(e)), e, piece == 0 || radius > 0.0);
      }
    }
  }

 private:
  const BodyProperties& body_;
  Vec2 position_;
  double angle_;
};

}  // namespace pinchlab
