// SPDX-License-Identifier: GPL-3.0-or-later
// Arithmetic of 32 digits: against integers that doubles do not hold, and by its own laws.

#include "sim/solve/extended.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/random.h"

namespace pinchlab::testing {
namespace {

constexpr double rounding = 1e-31;  // some units in the last place of 104 bits

/// A number of digits in both of its parts.
Extended random_number(Random& random) {
  const double size = std::exp(random.uniform(-20.0, 20.0));
  return Extended(size * random.uniform(-1.0, 1.0)) + size * 1e-17 * random.uniform(-1.0, 1.0);
}

double apart(const Extended& a, const Extended& b) {
  return std::abs(static_cast<double>(a - b));
}

double size_of(const Extended& a) {
  return std::abs(static_cast<double>(a));
}

TEST(Extended, KeepsWhatDoublesLose) {
  const double great = std::ldexp(1.0, 80);
  EXPECT_EQ(great + 1.0 - great, 0.0);
  EXPECT_EQ(static_cast<double>(Extended(great) + 1.0 - great), 1.0);
  // (2^52 + 1)^2 = 2^104 + 2^53 + 1, of 105 bits.
  const Extended odd = std::ldexp(1.0, 52) + 1.0;
  const Extended left = odd * odd - std::ldexp(1.0, 104) - std::ldexp(1.0, 53);
  EXPECT_EQ(static_cast<double>(left), 1.0);
  const Extended third = Extended(1.0) / 3.0;
  EXPECT_LE(apart(3.0 * third, 1.0), rounding);
  EXPECT_GT(std::abs(third.low), 1e-18);
}

TEST(Extended, ObeysTheLawsOfArithmetic) {
  Random random(1);
  for (int trial = 0; trial < 10000; ++trial) {
    const Extended a = random_number(random), b = random_number(random), c = random_number(random);
    EXPECT_LE(apart(a + b, b + a), 0.0);
    EXPECT_LE(apart(a * b, b * a), rounding * size_of(a * b));
    EXPECT_LE(apart((a + b) + c, a + (b + c)), rounding * (size_of(a) + size_of(b) + size_of(c)));
    EXPECT_LE(apart(a * (b + c), a * b + a * c), rounding * size_of(a) * (size_of(b) + size_of(c)));
    EXPECT_LE(apart(a / b * b, a), rounding * size_of(a));
    EXPECT_LE(std::abs(a.low), 0.5 * std::abs(std::nextafter(a.high, 1e300) - a.high));
    EXPECT_EQ(a<b, b> a);
    EXPECT_EQ(a <= b, !(b < a));
    EXPECT_TRUE(abs(a) >= 0.0);
  }
}

TEST(Extended, ComparesByItsSecondPart) {
  const Extended a = Extended(1.0) + 1e-20, b = Extended(1.0) - 1e-20;
  EXPECT_TRUE(b < 1.0 && a > 1.0 && b < a && a >= a && a <= a);
  EXPECT_FALSE(a < a);
  EXPECT_FALSE(a == b);
}

}  // namespace
}  // namespace pinchlab::testing
