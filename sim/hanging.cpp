// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/hanging.h"

#include <Eigen/LU>
#include <algorithm>

namespace pinchlab {

Hanging hang(const std::vector<Vec2>& weights, double length, const Vec2& d) {
  // Near its end Newton's method doubles its digits with each; before that, where a piece has next
  // to no tension, it may go by halved steps for long. This ends what would never get there.
  constexpr int most_rounds = 200;
  const std::size_t pieces = weights.size() + 1;
  Vec2 total = Vec2::Zero();
  for (const Vec2& weight : weights) total += weight;
  Hanging hanging;
  hanging.directions.resize(pieces);
  const auto value = [&](const Vec2& start) {
    Vec2 tension = start;
    double sum = tension.norm();
    for (const Vec2& weight : weights) sum += (tension -= weight).norm();
    return length * sum - start.dot(d);
  };
  // As if all its weight hung from the middle; a thousandth of the length where the ends meet, in
  // which no tension is needed across.
  Vec2 start = 0.5 * total +
               total.norm() * d / std::max(d.norm(), 1e-3 * length * static_cast<double>(pieces));
  for (int round = 0; round < most_rounds; ++round) {
    Vec2 gradient = -d, tension = start;
    hanging.tension = 0.0;
    Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
    for (std::size_t k = 0; k < pieces; ++k) {
      const double norm = std::max(tension.norm(), 1e-300);  // N: nothing divides by zero
      const Vec2 u = hanging.directions[k] = tension / norm;
      hanging.tension = std::max(hanging.tension, norm);
      gradient += length * u;
      hessian += length / norm * (Eigen::Matrix2d::Identity() - u * u.transpose());
      if (k < weights.size()) tension -= weights[k];
    }
    // Round-off of a sum of that many pieces; then of the value, which a halved step cannot lower.
    if (gradient.norm() <= 1e-15 * length * static_cast<double>(pieces)) break;
    const Vec2 step = -hessian.inverse() * gradient;
    if (!step.allFinite()) break;
    const double before = value(start);
    double share = 1.0;
    constexpr double least = 1e-12;  // of a step, after 40 halvings: it changes nothing
    while (share > least && !(value(start + share * step) <= before)) share *= 0.5;
    if (share <= least) break;
    start += share * step;
  }
  return hanging;
}

}  // namespace pinchlab
