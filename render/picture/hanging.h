// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How a slack span hangs: a catenary of its rest length, tangent to the bodies at its ends.

#include <cmath>

#include "sim/scene.h"

namespace pinchlab {

/// A uniform chain of given length between two points under gravity, by arc length. As the length
/// nears the distance it becomes the straight line, and so it is where the chain is too short.
class Catenary {
 public:
  Catenary() = default;
  /// `up`: unit vector against gravity. `length` in m.
  Catenary(const Vec2& from, const Vec2& to, double length, const Vec2& up);

  double length() const { return length_; }  // m, at least the distance
  bool straight() const { return straight_; }
  Vec2 point(double s) const;              // s in 0..length(), m
  double turn() const;                     // rad >= 0, by which the tangent turns on the way
  double arc_at_turn(double share) const;  // m, where it has turned by a share (0..1) of that
  Vec2 tangent(double s) const;            // unit, towards `to`

 private:
  Vec2 from_ = Vec2::Zero(), across_ = Vec2(1.0, 0.0), up_ = Vec2(0.0, 1.0);
  double length_ = 0.0;
  double parameter_ = 1.0;  // m, a of y = a cosh(x / a)
  double start_ = 0.0;      // m, arc length from the lowest point to `from`, signed
  bool straight_ = true;    // then `across_` is the direction
};

/// One end of a span: a circle that the cable runs round, or a point (signed radius 0). Of a drum
/// that fills it is the circle at `alpha`; its radius grows with the wrap.
struct SpanEnd {
  Vec2 centre = Vec2::Zero();  // m
  double signed_radius = 0.0;  // m, orientation * (body radius + half width)
  double most_unwrap = 0.0;    // rad >= 0, by how much the wrap may shrink
  double alpha = 0.0;          // rad, the direction of the straight tangent there
  double growth = 0.0;         // m/rad
};

/// m of cable that an end's circle takes up where its wrap grows by `turned` rad.
inline double taken_up(const SpanEnd& end, double turned) {
  return (std::abs(end.signed_radius) + 0.5 * end.growth * turned) * turned;
}

/// A span's shape between two ends. The cable leaves the first circle in direction `tail_angle` and
/// meets the second one in direction `head_angle` (rad); the wraps grow or shrink accordingly.
struct HangingSpan {
  double tail_angle = 0.0, head_angle = 0.0;
  bool tail_bare = false, head_bare = false;  // no wrap is left there, and the cable wants away
  Catenary curve;
};

/// The shape of a span whose material measures `rest_length` m between the points of both ends at
/// which the cable runs in the directions `alpha`. Material on the circles stays where it is.
HangingSpan hang(const SpanEnd& tail, const SpanEnd& head, double rest_length, const Vec2& up);

/// The same, `hung` so, where what comes off an end's wrap would run through the turns that stay,
/// by more than `most_depth` m: only so much comes off that it does not.
HangingSpan hang_clear(HangingSpan hung, SpanEnd tail, SpanEnd head, double rest_length,
                       const Vec2& up, double most_depth);

}  // namespace pinchlab
