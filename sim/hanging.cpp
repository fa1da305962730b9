// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/hanging.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// The point at which a piece of direction u is at its end, and by how much of it less lies on the
/// circle after that point (m): the more of it is before.
struct Touchdown {
  Vec2 point;
  double taken_off;
};

Touchdown touch_down(const HangingEnd& end, const Vec2& u) {
  if (end.p == 0.0) return {end.centre, 0.0};
  const double turned = std::atan2(cross(end.direction, u), end.direction.dot(u));
  return {end.centre - end.p * left(u), end.p * turned};
}

}  // namespace

Hanging hang(const std::vector<Vec2>& weights, const std::vector<double>& lengths,
             const HangingEnd& tail, const HangingEnd& head) {
  // Of the weight: from a rounding of tensions that any start is good for, to one that nobody sees.
  constexpr double roundest = 1.0, sharpest = 1e-13, sharper = 0.1;
  // Newton's method doubles its digits with each at the end. This ends what would never get there.
  constexpr int most_rounds = 50;
  const std::size_t pieces = weights.size() + 1;
  const double length = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  const Vec2 total = std::accumulate(weights.begin(), weights.end(), Vec2(Vec2::Zero()));
  Hanging hanging;
  hanging.directions.resize(pieces);
  std::vector<Vec2> tensions(pieces);
  double rounding = 0.0;  // N
  const auto rounded = [&rounding](const Vec2& tension) {
    return std::hypot(tension.x(), tension.y(), rounding);
  };
  // Directions and lengths for a tension of the first piece; returns what is to be least.
  Vec2 head_point;
  const auto lay = [&](const Vec2& start) {
    tensions[0] = start;
    for (std::size_t k = 0; k < pieces; ++k) {
      if (k > 0) tensions[k] = tensions[k - 1] - weights[k - 1];
      if (tensions[k] != Vec2::Zero()) hanging.directions[k] = tensions[k].normalized();
    }
    const Touchdown from = touch_down(tail, hanging.directions.front());
    const Touchdown to = touch_down(head, hanging.directions.back());
    hanging.lengths = lengths;
    hanging.lengths.front() -= from.taken_off;
    hanging.lengths.back() += to.taken_off;
    hanging.tail = from.point;
    head_point = to.point;
    double value = from.point.dot(tensions.front()) - to.point.dot(tensions.back());
    for (std::size_t k = 0; k < pieces; ++k) value += hanging.lengths[k] * rounded(tensions[k]);
    return value;
  };
  // As if all its weight hung from the middle; a thousandth of the length where the ends meet, in
  // which no tension is needed across.
  const Vec2 d = touch_down(head, head.direction).point - touch_down(tail, tail.direction).point;
  std::fill(hanging.directions.begin(), hanging.directions.end(), head.direction);
  Vec2 start = 0.5 * total + total.norm() * d / std::max(d.norm(), 1e-3 * length);
  double share = roundest;
  while (share >= sharpest) {
    rounding = share * total.norm();
    double value = lay(start);
    for (int round = 0; round < most_rounds; ++round) {
      Vec2 gradient = hanging.tail - head_point;
      Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
      for (std::size_t k = 0; k < pieces; ++k) {
        const double norm = rounded(tensions[k]), l = hanging.lengths[k];
        const Vec2 u = tensions[k] / norm;
        gradient += l * u;
        hessian += l / norm * (Eigen::Matrix2d::Identity() - u * u.transpose());
      }
      // Round-off of a sum of that many pieces; then of the value, which no halved step lowers.
      if (gradient.norm() <= 1e-15 * length) break;
      const Vec2 step = -hessian.inverse() * gradient;
      if (!step.allFinite()) break;
      double taken = 1.0;
      constexpr double least = 1e-12;  // of a step, after 40 halvings: it changes nothing
      double next = lay(start + step);
      while (taken > least && !(next <= value)) next = lay(start + (taken *= 0.5) * step);
      if (taken <= least) {
        lay(start);
        break;
      }
      start += taken * step;
      value = next;
    }
    share *= sharper;
  }
  // What a slack piece has next to no tension for is better known from all the others.
  const auto slackest = static_cast<std::size_t>(
      std::min_element(tensions.begin(), tensions.end(),
                       [](const Vec2& p, const Vec2& q) { return p.norm() < q.norm(); }) -
      tensions.begin());
  Vec2 left_over = head_point - hanging.tail;
  for (std::size_t k = 0; k < pieces; ++k) {
    hanging.tension = std::max(hanging.tension, tensions[k].norm());
    if (k != slackest) left_over -= hanging.lengths[k] * hanging.directions[k];
  }
  hanging.lengths[slackest] = left_over.norm();
  if (left_over != Vec2::Zero()) hanging.directions[slackest] = left_over.normalized();
  return hanging;
}

}  // namespace pinchlab
