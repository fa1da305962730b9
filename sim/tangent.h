// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The common tangent of two circles in closed form.

#include <cmath>
#include <numbers>

#include "sim/scene.h"

namespace pinchlab {

inline Vec2 left(const Vec2& a) {
  return {-a.y(), a.x()};
}
inline double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Angle (rad) of the direction e, counter-clockwise from the y axis: of the mirror image in x = 0
/// it is the negative to the last bit, as one from the x axis would not be.
inline double heading(const Vec2& e) {
  return std::atan2(-e.x(), e.y());
}

/// The same of a cable's first span, where the cable goes round a body by that orientation.
/// Straight down is half a turn from the y axis either way, and in a mirror the other.
inline double first_heading(const Vec2& e, int orientation) {
  return e.x() == 0.0 ? std::copysign(heading(e), orientation) : heading(e);
}

/// The direction of a heading (rad).
inline Vec2 direction_at(double heading) {
  return {-std::sin(heading), std::cos(heading)};
}

/// `angle` plus the whole turns that bring it nearest to `reference`, rad.
inline double unwrapped(double angle, double reference) {
  constexpr double turn = 2.0 * std::numbers::pi;
  if (std::abs(reference - angle) < 0.5 * turn) return angle;  // mostly
  return angle + turn * std::round((reference - angle) / turn);
}

/// m, L below, of circles that do not overlap.
inline double tangent_root(double distance, double delta) {
  return std::sqrt((distance - std::abs(delta)) * (distance + std::abs(delta)));
}

struct Tangent {
  Vec2 direction;   // unit, from tail to head
  double length;    // m, 0 where the circles overlap
  double distance;  // m, between the centres
  bool pinched;     // the circles touch or overlap and the cable crosses between them
};

/// The tangent that leaves the circle of signed radius p_a at `a` and arrives at that of p_b at
/// `b`.
///
/// With d = b - a, D = |d|, u = d/D and Delta = p_b - p_a:
///     L = sqrt(max(0, D^2 - Delta^2)),   e = (L u - Delta left(u)) / D.
/// For opposite orientations |Delta| is the sum of the radii, so the root vanishes exactly where
/// the cable is pinched; e then is perpendicular to the centre line, the limit of the ordinary
/// tangent.
///
/// `parting` is the share of |Delta| by which circles that were pinched may part before they are
/// not: round-off of their distance must not turn the tangent by its square root.
inline Tangent common_tangent(const Vec2& a, double p_a, const Vec2& b, double p_b,
                              double parting = 0.0) {
  const Vec2 d = b - a;
  const double distance = d.norm();
  const Vec2 u = distance > 0.0 ? Vec2(d / distance) : Vec2(1.0, 0.0);
  const double delta = p_b - p_a;
  if (distance - std::abs(delta) <= parting * std::abs(delta)) {
    const Vec2 e = delta == 0.0 ? u : Vec2(-std::copysign(1.0, delta) * left(u));
    return {e, 0.0, distance, delta != 0.0};
  }
  const double length = tangent_root(distance, delta);
  return {(length * u - delta * left(u)) / distance, length, distance, false};
}

/// Where a tangent of direction e touches the circle of signed radius p at `centre`.
inline Vec2 tangent_point(const Vec2& centre, double p, const Vec2& e) {
  return centre - p * left(e);
}

}  // namespace pinchlab
