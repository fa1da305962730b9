// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture/hanging.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/tangent.h"

namespace pinchlab {
namespace {

const Vec2 up(0.0, 1.0);

/// Length of a fine polygon through the curve, m.
double measured_length(const Catenary& curve) {
  double sum = 0.0;
  constexpr int pieces = 20000;
  Vec2 last = curve.point(0.0);
  for (int k = 1; k <= pieces; ++k) {
    const Vec2 next = curve.point(curve.length() * k / pieces);
    sum += (next - last).norm();
    last = next;
  }
  return sum;
}

TEST(Catenary, HasItsLengthAndEndsAndSatisfiesItsEquation) {
  for (const Vec2& to : {Vec2(2.0, 0.0), Vec2(1.5, 0.8), Vec2(-1.0, -0.7), Vec2(0.05, 1.0)}) {
    for (const double slack : {1e-6, 1e-3, 0.1, 1.0, 5.0}) {
      const Vec2 from(0.3, -0.2), end = from + to;
      const double length = to.norm() + slack;
      const Catenary curve(from, end, length, up);
      EXPECT_NEAR((curve.point(0.0) - from).norm(), 0.0, 1e-12);
      EXPECT_NEAR((curve.point(length) - end).norm(), 0.0, 1e-9 * length)
          << to.transpose() << " " << slack;
      // The polygon is shorter than the curve by about kappa^2 h^2 / 24 of its length.
      EXPECT_NEAR(measured_length(curve), length, 2e-5 * length);
      // Constant horizontal tension: the slope grows in proportion to the arc length (T_y' =
      // weight).
      const auto slope = [&](double s) {
        const Vec2 t = curve.tangent(s);
        return t.y() / std::abs(t.x());
      };
      const double a = slope(0.0), b = slope(0.5 * length), c = slope(length);
      EXPECT_NEAR(b - a, c - b, 1e-9 * (std::abs(a) + std::abs(c)));
      EXPECT_GE(c, a) << "hangs down";
    }
  }
}

TEST(Catenary, TangentIsTheDerivative) {
  const Catenary curve({0.0, 0.0}, {1.0, 0.4}, 1.7, up);
  const double h = 1e-6;
  for (const double s : {0.1, 0.8, 1.6}) {
    const Vec2 derivative = (curve.point(s + h) - curve.point(s - h)) / (2.0 * h);
    EXPECT_NEAR((derivative - curve.tangent(s)).norm(), 0.0, 1e-8);
  }
}

TEST(Catenary, BecomesTheLineAsTheSlackGoes) {
  // The sag of a chord l with slack d is sqrt(3 l d / 8).
  for (double slack = 1e-2; slack > 1e-11; slack *= 0.1) {
    const Catenary curve({0.0, 0.0}, {1.0, 0.0}, 1.0 + slack, up);
    EXPECT_NEAR(-curve.point(0.5 * curve.length()).y() / std::sqrt(3.0 * slack / 8.0), 1.0,
                slack + 1e-4);
  }
  EXPECT_TRUE(Catenary({0.0, 0.0}, {1.0, 0.0}, 0.9, up).straight());
  EXPECT_DOUBLE_EQ(Catenary({0.0, 0.0}, {1.0, 0.0}, 0.9, up).length(), 1.0);
}

TEST(Catenary, VerticalSpanHangsAsALoop) {
  const Catenary curve({0.0, 1.0}, {0.0, 0.0}, 2.0, up);
  double lowest = 1.0;
  for (int k = 0; k <= 100; ++k) {
    const Vec2 p = curve.point(0.02 * k);
    ASSERT_TRUE(p.allFinite());
    lowest = std::min(lowest, p.y());
  }
  EXPECT_NEAR(lowest, -0.5, 1e-3);  // 1.5 m down and 0.5 m up again
  EXPECT_NEAR((curve.point(2.0) - Vec2(0.0, 0.0)).norm(), 0.0, 1e-5);
}

TEST(Catenary, GravityMayPointAnywhere) {
  const Catenary curve({0.0, 0.0}, {0.0, 1.0}, 1.2, Vec2(-1.0, 0.0));  // "down" is to the right
  EXPECT_GT(curve.point(0.6).x(), 0.1);
}

TEST(HangingSpan, LeavesAndMeetsTheBodiesAlongTheirTangents) {
  const double R = 0.45;
  const Vec2 a(-1.2, 0.3), b(1.3, 0.0);
  // Over two pulleys, clockwise round both: the straight tangent lies on top.
  const Vec2 d = b - a;
  const double alpha = std::atan2(d.y(), d.x());
  for (const double slack : {1e-8, 1e-4, 0.02, 0.3, 1.0}) {
    const double rest = d.norm() + slack;
    const HangingSpan span = hang({a, -R, 1.0, alpha}, {b, -R, 1.0, alpha}, rest, up);
    const double length = span.curve.length();
    const Vec2 leaves = span.curve.tangent(0.0), meets = span.curve.tangent(length);
    EXPECT_NEAR(std::remainder(std::atan2(leaves.y(), leaves.x()) - span.tail_angle,
                               2.0 * std::numbers::pi),
                0.0, 1e-7);
    EXPECT_NEAR(
        std::remainder(std::atan2(meets.y(), meets.x()) - span.head_angle, 2.0 * std::numbers::pi),
        0.0, 1e-7);
    EXPECT_NEAR((span.curve.point(0.0) - a).norm(), R, 1e-9);
    EXPECT_NEAR((span.curve.point(length) - b).norm(), R, 1e-7);
    EXPECT_LT(span.tail_angle, alpha) << "a sagging cable stays longer on the pulley";
    EXPECT_GT(span.head_angle, alpha);
    // Material is neither made nor lost: free length and added wraps make the rest length.
    EXPECT_NEAR(length + R * (alpha - span.tail_angle) + R * (span.head_angle - alpha), rest, 1e-9);
  }
}

TEST(HangingSpan, MovesContinuouslyWithTheSlack) {
  const Vec2 a(-1.0, 0.0), b(1.0, 0.2);
  const Tangent taut = common_tangent(a, -0.4, b, 0.0);
  const double alpha = std::atan2(taut.direction.y(), taut.direction.x());
  Vec2 last(0.0, 0.0);
  for (int k = 0; k <= 2000; ++k) {
    const double slack = 0.5 * std::pow(k / 2000.0, 2.0);  // the sag grows as its root
    const HangingSpan span =
        hang({a, -0.4, 0.5, alpha}, {b, 0.0, 0.0, alpha}, taut.length + slack, up);
    const Vec2 middle = span.curve.point(0.5 * span.curve.length());
    if (k > 0) {
      EXPECT_LT((middle - last).norm(), 2e-3) << slack;
    }
    last = middle;
  }
}

TEST(HangingSpan, ConvergesWithMuchSlackBetweenBodiesThatMeet) {
  // Two pulleys of a stack that falls together: a third more rope than way between them.
  constexpr double R = 0.213835;
  const Vec2 below(0.0, 0.0), above(0.0, 0.517);
  const Tangent taut = common_tangent(below, R, above, -R);
  const double alpha = std::atan2(taut.direction.y(), taut.direction.x());
  const HangingSpan span =
      hang({below, R, 2.5, alpha}, {above, -R, 2.5, alpha}, 1.4 * taut.length, up);
  const double length = span.curve.length();
  const Vec2 leaves = span.curve.tangent(0.0), meets = span.curve.tangent(length);
  EXPECT_NEAR(cross(leaves, Vec2(std::cos(span.tail_angle), std::sin(span.tail_angle))), 0.0, 1e-7);
  EXPECT_NEAR(cross(meets, Vec2(std::cos(span.head_angle), std::sin(span.head_angle))), 0.0, 1e-7);
  EXPECT_GT(span.tail_angle, std::numbers::pi) << "the rope lies over the lower pulley's top";
}

TEST(HangingSpan, UnwrapsNoMoreThanThereIs) {
  // The cable runs under the body, so a sagging span pulls away from it: only as far as allowed.
  const HangingSpan span =
      hang({{0.0, 0.0}, 0.3, 0.05, 0.0}, {{2.0, -0.3}, 0.0, 0.0, 0.0}, 2.6, up);
  EXPECT_NEAR(span.tail_angle, -0.05, 1e-9);
  EXPECT_TRUE(span.tail_bare);
  EXPECT_FALSE(span.head_bare);
}

}  // namespace
}  // namespace pinchlab
