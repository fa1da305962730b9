// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/hanging.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

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
  hanging.tensions = std::move(tensions);
  return hanging;
}

namespace {

/// Rods in a row, all of which pull but, where `sign` is -1, rod k.
struct Rods {
  const std::vector<double>& lengths;  // m
  Vec2 reach;                          // m
  std::size_t k = 0;
  double sign = 1.0;
  std::vector<Vec2> shifts;  // N, t_j - t_k

  Rods(const std::vector<Vec2>& weights, const std::vector<double>& given, const Vec2& d,
       std::size_t rod, double its_sign)
      : lengths(given), reach(d), k(rod), sign(its_sign), shifts(given.size(), Vec2::Zero()) {
    for (std::size_t j = k; j > 0; --j) shifts[j - 1] = shifts[j] + weights[j - 1];
    for (std::size_t j = k; j + 1 < given.size(); ++j) shifts[j + 1] = shifts[j] - weights[j];
  }
};

/// F for a tension of rod k, and J.
Vec2 missed(const Rods& rods, const Vec2& tension, Eigen::Matrix2d& jacobian) {
  Vec2 missed = -rods.reach;
  jacobian.setZero();
  for (std::size_t j = 0; j < rods.lengths.size(); ++j) {
    const Vec2 t = tension + rods.shifts[j];
    const double l = (j == rods.k ? rods.sign : 1.0) * rods.lengths[j], norm = t.norm();
    const Vec2 u = t / norm;
    missed += l * u;
    jacobian += l / norm * (Eigen::Matrix2d::Identity() - u * u.transpose());
  }
  return missed;
}

/// The chain at rest that is next to one with that tension of rod k.
std::optional<Hanging> come_to_rest(const Rods& rods, Vec2 tension) {
  constexpr int most_rounds = 100;
  constexpr double round_off = 1e-15, exact = 1e-13, least_step = 1e-12;
  // Of rods that all but stand upright the tension along them is what it likes, within a weight.
  constexpr double flat = 1e-13;
  const double length = std::accumulate(rods.lengths.begin(), rods.lengths.end(), 0.0);
  Eigen::Matrix2d jacobian, next_jacobian;
  Vec2 f = missed(rods, tension, jacobian);
  for (int round = 0; round < most_rounds && f.norm() > round_off * length; ++round) {
    const Vec2 step = -Eigen::FullPivLU<Eigen::Matrix2d>(jacobian).setThreshold(flat).solve(f);
    double taken = 1.0;
    Vec2 next = missed(rods, tension + step, next_jacobian);
    while (taken > least_step && !(next.norm() < f.norm()))
      next = missed(rods, tension + (taken *= 0.5) * step, next_jacobian);
    if (taken <= least_step) break;
    tension += taken * step;
    f = next;
    jacobian = next_jacobian;
  }
  if (!(f.norm() <= exact * length)) return {};
  Hanging hanging;
  hanging.lengths = rods.lengths;
  for (std::size_t j = 0; j < rods.lengths.size(); ++j) {
    hanging.tensions.push_back(tension + rods.shifts[j]);
    const double norm = hanging.tensions[j].norm();
    hanging.directions.push_back((j == rods.k ? rods.sign : 1.0) / norm * hanging.tensions[j]);
    hanging.tension = std::max(hanging.tension, norm);
  }
  return hanging;
}

}  // namespace

std::optional<Hanging> hang_rods(const std::vector<Vec2>& weights,
                                 const std::vector<double>& lengths, const Vec2& reach) {
  const Vec2 total = std::accumulate(weights.begin(), weights.end(), Vec2(Vec2::Zero()));
  const Vec2 down = total.normalized(), across = left(down);
  const double length = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  double before = 0.0, l = 0.0;  // m, of rods before k, and of rod k
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    before += l;
    l = lengths[k];
    const Vec2 r = reach - (before - (length - before - l)) * down;
    if (!(r.norm() < l)) continue;
    const Rods rods(weights, lengths, reach, k, -1.0);
    double gives = 0.0;  // c
    for (std::size_t j = 0; j < lengths.size(); ++j) {
      if (j != k) gives += lengths[j] / rods.shifts[j].norm();
    }
    const double rx = r.dot(across), vy = r.dot(down) / l;
    const double vx = std::copysign(std::sqrt(1.0 - vy * vy), rx);
    // Of so small a push only the direction is to be seen.
    const double push = std::max((l - rx / vx) / gives, 1e-16 * total.norm());
    if (auto found = come_to_rest(rods, -push * (vx * across + vy * down))) return found;
    break;  // by round-off it was less than the rod
  }
  Hanging hanging = hang(weights, lengths, {}, {reach});
  // What it has left to the piece that bears least it may have left a little short.
  const auto weaker = [](const Vec2& p, const Vec2& q) { return p.norm() < q.norm(); };
  const auto k = static_cast<std::size_t>(
      std::min_element(hanging.tensions.begin(), hanging.tensions.end(), weaker) -
      hanging.tensions.begin());
  constexpr double round_off = 1e-13;
  const double short_by = std::abs(hanging.lengths[k] - lengths[k]);
  hanging.lengths = lengths;
  if (short_by <= round_off * length) return hanging;
  std::vector<Vec2> starts{hanging.tensions[k]};
  // Of one that all but stands upright, its lowest node may hang from either side, by any share.
  if (k < weights.size()) starts.emplace_back(0.5 * weights[k]);
  if (k > 0) starts.emplace_back(-0.5 * weights[k - 1]);
  const Rods rods(weights, lengths, reach, k, 1.0);
  for (const Vec2& start : starts) {
    if (auto found = come_to_rest(rods, start)) return found;
  }
  return {};
}

}  // namespace pinchlab
