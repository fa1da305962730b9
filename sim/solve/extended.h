// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Arithmetic of about 32 digits, for what doubles cannot tell from nothing: a cable that bends by
// an angle of a about a body gives it a row whose own part of J M^-1 J^T is a^2, which beside
// others' 1 is lost in round-off below 1e-8.

#include <cmath>

namespace pinchlab {

/// The sum of two doubles of which the second is at most half a unit in the last place of the
/// first: T. J. Dekker, A floating-point technique for extending the available precision,
/// Numerische Mathematik 18, 1971. Sums are right to 2^-104 of what is added, products and
/// quotients to some units of that. Not for what overflows: such results are NaN.
struct Extended {
  double high = 0.0, low = 0.0;

  constexpr Extended() = default;
  constexpr Extended(double value) : high(value) {}  // every double is one
  constexpr Extended(double greater, double rest) : high(greater), low(rest) {}

  constexpr explicit operator double() const { return high; }
};

/// Of a sum a + b with |a| >= |b|.
inline Extended sum_of_ordered(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

inline Extended operator-(const Extended& a) {
  return {-a.high, -a.low};
}

inline Extended operator+(const Extended& a, const Extended& b) {
  const double sum = a.high + b.high;  // and what it has lost, by Knuth's two-sum
  const double of_b = sum - a.high;
  const double lost = (a.high - (sum - of_b)) + (b.high - of_b);
  return sum_of_ordered(sum, lost + (a.low + b.low));
}

inline Extended operator-(const Extended& a, const Extended& b) {
  return a + -b;
}

inline Extended operator*(const Extended& a, const Extended& b) {
  const double product = a.high * b.high;
  const double lost = std::fma(a.high, b.high, -product);
  return sum_of_ordered(product, lost + (a.high * b.low + a.low * b.high));
}

inline Extended operator/(const Extended& a, const Extended& b) {
  const double quotient = a.high / b.high;
  const Extended left = a - b * quotient;
  const double next = left.high / b.high;
  const Extended rest = left - b * next;
  return sum_of_ordered(quotient, next) + rest.high / b.high;
}

inline Extended& operator+=(Extended& a, const Extended& b) {
  return a = a + b;
}

inline Extended& operator-=(Extended& a, const Extended& b) {
  return a = a - b;
}

inline Extended& operator*=(Extended& a, const Extended& b) {
  return a = a * b;
}

inline bool operator==(const Extended& a, const Extended& b) {
  return a.high == b.high && a.low == b.low;
}

inline bool operator<(const Extended& a, const Extended& b) {
  return a.high < b.high || (a.high == b.high && a.low < b.low);
}

inline bool operator>(const Extended& a, const Extended& b) {
  return b < a;
}

inline bool operator<=(const Extended& a, const Extended& b) {
  return a.high < b.high || (a.high == b.high && a.low <= b.low);
}

inline bool operator>=(const Extended& a, const Extended& b) {
  return b <= a;
}

inline Extended abs(const Extended& a) {
  return a.high < 0.0 ? -a : a;
}

}  // namespace pinchlab
