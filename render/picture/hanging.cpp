// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture/hanging.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// sinh(x) / x - 1, without cancellation.
double excess(double x) {
  const double q = x * x;
  if (x < 0.3) return q / 6.0 * (1.0 + q / 20.0 * (1.0 + q / 42.0 * (1.0 + q / 72.0)));
  return std::sinh(x) / x - 1.0;
}

/// d/dx of it.
double excess_slope(double x) {
  const double q = x * x;
  if (x < 0.3) return x / 3.0 * (1.0 + q / 10.0 * (1.0 + q / 28.0 * (1.0 + q / 54.0)));
  return (std::cosh(x) - std::sinh(x) / x) / x;
}

/// The x > 0 with sinh(x) / x - 1 = e. Newton's method from above on a convex function cannot
/// overshoot; x + x^3/6 < sinh x bounds the root for small e, sinh(2 ln 2c) > 2 c ln 2c (c = 1 + e)
/// for large e.
double inverse_excess(double e) {
  double x = std::min(std::sqrt(6.0 * e), 2.0 * std::log(2.0 + 2.0 * e));
  for (int i = 0; i < 100; ++i) {
    const double change = (excess(x) - e) / excess_slope(x);
    x -= change;
    if (std::abs(change) <= 1e-14 * x) break;
  }
  return x;
}

Vec2 unit(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

// With h and v the horizontal and vertical distance and x = h / 2a, a chain of length l satisfies
//     sinh(x) / x = sqrt(l^2 - v^2) / h,
// and its lowest point lies a artanh(v / l) before the middle of h.
Catenary::Catenary(const Vec2& from, const Vec2& to, double length, const Vec2& up)
    : from_(from), up_(up), length_(length) {
  const Vec2 d = to - from;
  const double distance = d.norm();
  constexpr double smallest_slack = 1e-12;  // of the length: a sag of 1e-6 of it
  straight_ = length <= distance + smallest_slack * distance;
  if (straight_) {
    length_ = distance;
    if (distance > 0.0) across_ = d / distance;
    return;
  }
  across_ = Vec2(up.y(), -up.x());
  if (across_.dot(d) < 0.0) across_ = -across_;
  constexpr double narrowest = 1e-6;  // of the length: both halves of the chain hang side by side
  const double h = std::max(across_.dot(d), narrowest * length), v = up.dot(d);
  const double root = std::sqrt((length - v) * (length + v));
  const double slack = std::max((length - distance) * (length + distance), 1e-24 * length * length);
  const double x = inverse_excess(slack / (h * (root + h)));
  parameter_ = 0.5 * h / x;
  start_ = -parameter_ * std::sinh(x - std::atanh(v / length));
}

Vec2 Catenary::point(double s) const {
  if (straight_) return from_ + s * across_;
  const double a = parameter_, end = start_ + s;
  const double horizontal = a * (std::asinh(end / a) - std::asinh(start_ / a));
  const double vertical = s * (start_ + end) / (std::hypot(a, start_) + std::hypot(a, end));
  return from_ + horizontal * across_ + vertical * up_;
}

Vec2 Catenary::tangent(double s) const {
  if (straight_) return across_;
  return (parameter_ * across_ + (start_ + s) * up_) / std::hypot(parameter_, start_ + s);
}

double Catenary::turn() const {
  if (straight_) return 0.0;
  return std::atan((start_ + length_) / parameter_) - std::atan(start_ / parameter_);
}

double Catenary::arc_at_turn(double share) const {
  if (straight_) return share * length_;
  const double from = std::atan(start_ / parameter_), angle = from + share * turn();
  const double s = parameter_ * std::tan(angle) - start_;
  // Exact at the ends, where the difference would lose digits of a nearly straight chain.
  return share <= 0.0 ? 0.0 : share >= 1.0 ? length_ : std::clamp(s, 0.0, length_);
}

HangingSpan hang(const SpanEnd& tail, const SpanEnd& head, double rest_length, const Vec2& up) {
  // The angles at which the cable leaves and arrives must be those of the curve between the points
  // where it does. Moving such a point along its circle leaves the slack unchanged to first order,
  // so plain substitution converges quickly; where the slack is large it swings, and smaller steps
  // are taken as soon as it does.
  HangingSpan span{tail.alpha, head.alpha, false, false, {}};
  // The angle of the curve's end, as far as the circle lets it, and whether it lets it unwrap.
  const auto limited = [](const SpanEnd& end, const Vec2& tangent, double wrap_sense, bool& bare) {
    const Vec2 e = unit(end.alpha);
    const double turned = std::atan2(cross(e, tangent), e.dot(tangent));
    if (end.signed_radius == 0.0) return end.alpha + turned;
    const double sense = wrap_sense * std::copysign(1.0, end.signed_radius), grow = sense * turned;
    bare = grow < -end.most_unwrap;
    return end.alpha + sense * std::clamp(grow, -end.most_unwrap, std::numbers::pi);
  };
  // By how much the wrap grows, rad, and where the cable runs in a direction then.
  const auto grown = [](const SpanEnd& end, double angle, double wrap_sense) {
    return wrap_sense * std::copysign(1.0, end.signed_radius) * (angle - end.alpha);
  };
  const auto place = [](const SpanEnd& end, double turned, const Vec2& e) {
    const double more = std::copysign(end.growth, end.signed_radius) * turned;
    return tangent_point(end.centre, end.signed_radius + more, e);
  };
  constexpr int most_rounds = 200;
  constexpr double close_enough = 1e-9;
  double damping = 0.7, last_change = 2.0 * std::numbers::pi;
  for (int round = 0;; ++round) {
    const double at_tail = grown(tail, span.tail_angle, 1.0);
    const double at_head = grown(head, span.head_angle, -1.0);
    const Vec2 from = place(tail, at_tail, unit(span.tail_angle));
    const Vec2 to = place(head, at_head, unit(span.head_angle));
    const double length = rest_length - taken_up(tail, at_tail) - taken_up(head, at_head);
    span.curve = Catenary(from, to, length, up);
    const double tail_angle = limited(tail, span.curve.tangent(0.0), 1.0, span.tail_bare);
    const double head_angle =
        limited(head, span.curve.tangent(span.curve.length()), -1.0, span.head_bare);
    const double tail_change = tail.signed_radius != 0.0 ? tail_angle - span.tail_angle : 0.0;
    const double head_change = head.signed_radius != 0.0 ? head_angle - span.head_angle : 0.0;
    const double change = std::max(std::abs(tail_change), std::abs(head_change));
    if (round == most_rounds || change < close_enough) return span;
    if (change > 0.9 * last_change) damping = std::max(0.5 * damping, 0.02);
    last_change = change;
    span.tail_angle += damping * tail_change;
    span.head_angle += damping * head_change;
  }
}

namespace {

/// rad, by how much the wrap at an end has grown; `sense`: 1 at the tail, -1 at the head.
double growth_of_wrap(const SpanEnd& end, double angle, double sense) {
  return sense * std::copysign(1.0, end.signed_radius) * (angle - end.alpha);
}

/// m, by which a curve that has come off an end runs through the turns left there; 0: nothing has.
double depth_in(const SpanEnd& end, const Catenary& curve, double angle, double sense) {
  const double grown = growth_of_wrap(end, angle, sense);
  if (end.signed_radius == 0.0 || grown > -1e-6) return 0.0;
  const double turn = 2.0 * std::numbers::pi, radius = std::abs(end.signed_radius);
  const double way = sense * std::copysign(1.0, end.signed_radius);
  const Vec2 leaves = -std::copysign(1.0, end.signed_radius) * left(unit(angle));
  double deepest = 0.0;
  constexpr int places = 32;
  for (int k = 1; k < places; ++k) {
    const Vec2 out = curve.point(curve.length() * k / places) - end.centre;
    const double ahead = std::atan2(way * cross(leaves, out), leaves.dot(out));
    // On layers it lies outside of the turn that is left.
    const double below = radius + end.growth * (grown + (ahead > 0.0 ? ahead : turn + ahead));
    deepest = std::max(deepest, below - out.norm());
  }
  return deepest;
}

}  // namespace

HangingSpan hang_clear(HangingSpan hung, SpanEnd tail, SpanEnd head, double rest_length,
                       const Vec2& up, double most_depth) {
  for (SpanEnd* end : {&tail, &head}) {
    const double sense = end == &tail ? 1.0 : -1.0;
    const auto is_clear = [&](const HangingSpan& span) {
      const double angle = end == &tail ? span.tail_angle : span.head_angle;
      return depth_in(*end, span.curve, angle, sense) <= most_depth;
    };
    if (is_clear(hung)) continue;
    double least = 0.0;
    double most = -growth_of_wrap(*end, end == &tail ? hung.tail_angle : hung.head_angle, sense);
    for (int round = 0; round < 20; ++round) {
      end->most_unwrap = 0.5 * (least + most);
      (is_clear(hang(tail, head, rest_length, up)) ? least : most) = end->most_unwrap;
    }
    end->most_unwrap = least;
    hung = hang(tail, head, rest_length, up);
  }
  return hung;
}

}  // namespace pinchlab
