// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/dual_active_set.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/at.h"
#include "sim/solve/part_system.h"

namespace pinchlab {

namespace {

/// What is left of a normal across others, as a share of it, that is round-off: they repeat it.
constexpr double dependent = 1e-12;

bool holds_both_ways(const Row& row) {
  return row.clamped || (row.kind != RowKind::segment && row.kind != RowKind::normal);
}

/// Whether the row is in this solve at all.
bool takes_part(const Row& row) {
  if (row.diagonal + row.compliance <= 0.0 || row.idle) return false;
  return row.on || !holds_both_ways(row);
}

double product(int n, const double* a, const double* b) {
  double sum = 0.0;
  for (int i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

/// A mobility as S R' diag(root)^2 R S, S = diag(scale), its axes in rows of R. What cannot move
/// has roots of exactly zero: those of round-off would be 1e-8 of the others, by which anything
/// might give. Where moving and turning are coupled either is measured by its own mobility: axes of
/// both together would depend on units.
struct Root {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d root = Eigen::Vector3d::Zero();
  Eigen::Array3d scale = Eigen::Array3d::Ones();
};

Root root_of(const Mobility& m) {
  constexpr double rounding = 1e-14;
  Root result;
  const auto take = [&result](const auto& matrix) {
    using Matrix = std::decay_t<decltype(matrix)>;
    constexpr int n = Matrix::RowsAtCompileTime;
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(matrix);
    const double least = rounding * eigen.eigenvalues().cwiseAbs().maxCoeff();
    for (int k = 0; k < n; ++k) {
      const double value = eigen.eigenvalues()[k];
      result.root[k] = value > least ? std::sqrt(value) : 0.0;
    }
    result.axes.template topLeftCorner<n, n>() = eigen.eigenvectors().transpose();
  };
  if (m.xz == 0.0 && m.yz == 0.0) {
    take(Eigen::Matrix2d{{m.xx, m.xy}, {m.xy, m.yy}});
    result.root.z() = std::sqrt(m.angular);
  } else {
    const double moving = std::sqrt(m.xx + m.yy), turning = std::sqrt(m.angular);
    const double both = moving * turning;
    result.scale = {moving, moving, turning};
    Eigen::Matrix3d coupled{{m.xx, m.xy, 0.0}, {m.xy, m.yy, 0.0}, {0.0, 0.0, 1.0}};
    coupled.topLeftCorner<2, 2>() /= moving * moving;
    coupled(0, 2) = coupled(2, 0) = m.xz / both;
    coupled(1, 2) = coupled(2, 1) = m.yz / both;
    take(coupled);
  }
  return result;
}

void find_roots(const PartSystem& s, DualScratch& d) {
  d.roots.resize(9 * s.mobility.size());
  for (std::size_t b = 0; b < s.mobility.size(); ++b) {
    const Root r = root_of(s.mobility[b]);
    Eigen::Map<Eigen::Matrix3d>(&d.roots[9 * b]) =
        r.root.asDiagonal() * r.axes * r.scale.matrix().asDiagonal();
  }
}

void find_normals(const PartSystem& s, DualScratch& d) {
  find_roots(s, d);
  const int bodies = static_cast<int>(s.mobility.size());
  const int rows = static_cast<int>(s.rows.size());
  int compliant = 0;
  for (const Row& row : s.rows) compliant += row.compliance > 0.0;
  d.dimension = 3 * bodies + compliant;
  d.normals.assign(index(rows) * index(d.dimension), 0.0);
  d.norms.assign(s.rows.size(), 0.0);
  int own = 3 * bodies;
  for (int r = 0; r < rows; ++r) {
    double* normal = &at(d.normals, r * d.dimension);
    const auto add = [&](int body, const Eigen::Vector3d& j) {
      const Eigen::Map<const Eigen::Matrix3d> root(&at(d.roots, 9 * body));
      Eigen::Map<Eigen::Vector3d>(normal + 3 * std::ptrdiff_t{body}) += root * j;
    };
    const RowBodies& row = at(s.bodies, r);
    add(row.a, row.ja);
    add(row.b, row.jb);
    if (const ThirdBody* third = third_of(s, index(r))) add(third->place, third->j);
    if (at(s.rows, r).compliance > 0.0) normal[own++] = std::sqrt(at(s.rows, r).compliance);
    at(d.norms, r) = std::sqrt(product(d.dimension, normal, normal));
  }
}

/// Splits a row's normal into coordinates in the basis, `part`, and what is across it, `rest`.
/// Returns the length of the rest; 0: nothing but round-off.
double split(DualScratch& d, int row) {
  const int n = d.dimension, count = static_cast<int>(d.active.size());
  const double* normal = &at(d.normals, row * n);
  d.rest.assign(normal, normal + n);
  d.part.assign(index(count), 0.0);
  for (int twice = 0; twice < 2; ++twice) {  // orthogonal to round-off then
    for (int k = 0; k < count; ++k) {
      const double* q = &at(d.basis, k * n);
      const double along = product(n, q, d.rest.data());
      at(d.part, k) += along;
      for (int i = 0; i < n; ++i) at(d.rest, i) -= along * q[i];
    }
  }
  const double length = std::sqrt(product(n, d.rest.data(), d.rest.data()));
  return length > dependent * at(d.norms, row) ? length : 0.0;
}

/// Appends a row, just split with such a rest, to the active ones.
void append(DualScratch& d, int row, double length) {
  const int n = d.dimension, count = static_cast<int>(d.active.size());
  const int stride = static_cast<int>(d.norms.size());
  for (int i = 0; i < n; ++i) at(d.basis, count * n + i) = at(d.rest, i) / length;
  for (int k = 0; k < count; ++k) at(d.triangle, k * stride + count) = at(d.part, k);
  at(d.triangle, count * stride + count) = length;
  d.active.push_back(row);
}

/// Makes the basis of rows from place `from` on anew; `gone`: without the first of them.
void rebuild(DualScratch& d, int from, bool gone) {
  const auto begin = d.active.begin() + from;
  d.active_before.assign(begin + (gone ? 1 : 0), d.active.end());
  d.active.resize(index(from));
  for (const int row : d.active_before) append(d, row, split(d, row));
}

/// Solves the triangle for what a unit of a row, just split, takes off the active rows' impulses;
/// leaves it in `part`.
void find_shares(DualScratch& d) {
  const int count = static_cast<int>(d.active.size());
  const int stride = static_cast<int>(d.norms.size());
  for (int k = count - 1; k >= 0; --k) {
    double sum = at(d.part, k);
    for (int j = k + 1; j < count; ++j) sum -= at(d.triangle, k * stride + j) * at(d.part, j);
    at(d.part, k) = sum / at(d.triangle, k * stride + k);
  }
}

enum class Entry { done, contradicts, endless };

/// Brings a row in that is violated by `speed` (m/s): below zero, or either way of one that holds
/// both ways.
Entry bring_in(const PartSystem& s, DualScratch& d, int row, double speed, int& left) {
  const double sign = speed > 0.0 ? -1.0 : 1.0;
  double violation = std::abs(speed), own = 0.0;
  while (left-- > 0) {
    const double length = split(d, row);
    find_shares(d);
    double most = infinity;  // until an impulse turns negative
    int first = -1;
    for (std::size_t k = 0; k < d.active.size(); ++k) {
      if (holds_both_ways(at(s.rows, d.active[k]))) continue;
      const double share = sign * d.part[k];
      const double until = std::max(at(d.multipliers, d.active[k]), 0.0) / share;
      if (share > 0.0 && until < most) {
        most = until;
        first = static_cast<int>(k);
      }
    }
    const double full = length > 0.0 ? violation / (length * length) : infinity;
    const double step = std::min(full, most);
    if (step == infinity) return Entry::contradicts;
    for (std::size_t k = 0; k < d.active.size(); ++k) {
      at(d.multipliers, d.active[k]) -= sign * step * d.part[k];
    }
    own += step;
    if (length > 0.0) {
      for (int i = 0; i < d.dimension; ++i) at(d.way, i) += sign * step * at(d.rest, i);
      violation -= step * length * length;
    }
    if (step == full) {
      split(d, row);  // find_shares has used up its coordinates
      append(d, row, length);
      at(d.multipliers, row) = sign * own;
      return Entry::done;
    }
    at(d.multipliers, at(d.active, first)) = 0.0;
    rebuild(d, first, true);
  }
  return Entry::endless;
}

/// What violates its condition most, as a share of its normal, and its speed.
int most_violated(const PartSystem& s, const DualScratch& d, double tolerance, double& speed) {
  int found = -1;
  double most = 0.0;
  for (int r = 0; index(r) < s.rows.size(); ++r) {
    const Row& row = at(s.rows, r);
    if (!takes_part(row) || at(d.skipped, r)) continue;
    if (std::find(d.active.begin(), d.active.end(), r) != d.active.end()) continue;
    const double bias = at(d.unbiased, r) ? 0.0 : row.bias;
    const double free = bias + dot(at(s.bodies, r).ja, at(s.free_velocity, at(s.bodies, r).a)) +
                        dot(at(s.bodies, r).jb, at(s.free_velocity, at(s.bodies, r).b)) +
                        speed_of_third(s, index(r), s.free_velocity);
    const double now = free + product(d.dimension, &at(d.normals, r * d.dimension), d.way.data());
    const double by = holds_both_ways(row) ? std::abs(now) : -now;
    if (by <= tolerance || by <= most * at(d.norms, r)) continue;
    most = by / at(d.norms, r);
    speed = now;
    found = r;
  }
  return found;
}

/// Solves with the biases that are not left out; whether it has ended. Raises `missed` to what
/// contradicts other rows (m/s).
bool solve(const PartSystem& s, DualScratch& d, double tolerance, double& missed) {
  d.way.assign(index(d.dimension), 0.0);
  d.multipliers.assign(s.rows.size(), 0.0);
  d.skipped.assign(s.rows.size(), false);
  d.active.clear();
  int left = 20 * static_cast<int>(s.rows.size()) + 100;
  double speed = 0.0;
  for (int row = 0; (row = most_violated(s, d, tolerance, speed)) >= 0;) {
    d.way_at_entry = d.way;
    d.multipliers_at_entry = d.multipliers;
    d.active_at_entry = d.active;
    const Entry entry = bring_in(s, d, row, speed, left);
    if (entry == Entry::endless) return false;
    if (entry == Entry::done) continue;
    at(d.skipped, row) = true;
    missed = std::max(missed, std::abs(speed));
    d.way = d.way_at_entry;
    d.multipliers = d.multipliers_at_entry;
    d.active = d.active_at_entry;
    rebuild(d, 0, false);
  }
  return true;
}

/// Kinetic energy that the rows have given (J), from the way itself: of impulses that all but
/// cancel each other, whose products with speeds are mostly round-off, nothing is left.
double energy_given(const PartSystem& s, const DualScratch& d) {
  double energy = 0.0;
  for (std::size_t b = 0; b < s.mobility.size(); ++b) {
    const Root r = root_of(s.mobility[b]);
    const Eigen::Vector3d free = r.axes * (s.free_velocity[b].array() / r.scale).matrix();
    for (int k = 0; k < 3; ++k) {
      if (r.root[k] == 0.0) continue;
      const double given = d.way[3 * b + index(k)];
      energy += given * (0.5 * given + free[k] / r.root[k]);
    }
  }
  return energy;
}

/// How much further (m) biases have moved any body in the step than it would go without, its
/// turning on the levers of its rows.
double moved_by_biases(const PartSystem& s, DualScratch& d) {
  d.levers.assign(s.mobility.size(), 0.0);
  for (const RowBodies& row : s.bodies) {
    at(d.levers, row.a) = std::max(at(d.levers, row.a), std::abs(row.ja.z()));
    at(d.levers, row.b) = std::max(at(d.levers, row.b), std::abs(row.jb.z()));
  }
  for (const ThirdBody& third : s.thirds) {
    at(d.levers, third.place) = std::max(at(d.levers, third.place), std::abs(third.j.z()));
  }
  double most = 0.0;
  for (std::size_t b = 0; b < s.mobility.size(); ++b) {
    const Eigen::Map<const Eigen::Matrix3d> root(&d.roots[9 * b]);
    const Eigen::Map<const Eigen::Vector3d> way(&d.way[3 * b]), before(&d.way_unbiased[3 * b]);
    const Eigen::Vector3d change = root.transpose() * (way - before);
    most = std::max({most, change.head<2>().norm(), d.levers[b] * std::abs(change.z())});
  }
  return most * d.step_length;
}

void store(PartSystem& s, const DualScratch& d) {
  for (std::size_t b = 0; b < s.mobility.size(); ++b) {
    const Eigen::Map<const Eigen::Matrix3d> root(&d.roots[9 * b]);
    const Eigen::Map<const Eigen::Vector3d> way(&d.way[3 * b]);
    s.velocity[b] = s.free_velocity[b] + root.transpose() * way;
  }
  for (Row& row : s.rows) {
    if (!holds_both_ways(row)) row.on = false;
    row.impulse = 0.0;
  }
  for (const int r : d.active) {
    Row& row = at(s.rows, r);
    row.on = true;
    row.impulse = at(d.multipliers, r);
  }
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    Row& row = s.rows[r];
    row.speed = row.on && takes_part(row) && !d.skipped[r] ? 0.0 : row_speed(s, r);
  }
}

}  // namespace

bool solve_dual(PartSystem& s, DualScratch& d, const DualTerms& terms, double& missed) {
  find_normals(s, d);
  d.step_length = terms.step_length;
  d.basis.assign(d.normals.size(), 0.0);
  d.triangle.assign(s.rows.size() * s.rows.size(), 0.0);
  missed = 0.0;
  const auto leave_out = [&s, &d](double most) {
    d.unbiased.assign(s.rows.size(), false);
    double left_out = 0.0;
    for (std::size_t r = 0; r < s.rows.size(); ++r) {
      const Row& row = s.rows[r];
      if (!takes_part(row) || row.compliance > 0.0 || std::abs(row.bias) > most) continue;
      // What is still apart may come together, but no nearer.
      if (!holds_both_ways(row) && row.bias > 0.0) continue;
      d.unbiased[r] = true;
      left_out = std::max(left_out, std::abs(row.bias));
    }
    return left_out;
  };
  const double all = leave_out(infinity);
  if (!solve(s, d, terms.tolerance, missed)) return false;
  const double little = s.tolerance() / d.step_length;
  if (!terms.repairs || all <= little) {
    missed = std::max(missed, all);
  } else {
    d.way_unbiased = d.way;
    leave_out(little);
    double missed_then = 0.0;
    const bool ended = solve(s, d, terms.tolerance, missed_then);
    const double moved = moved_by_biases(s, d);
    if (ended && moved * moved <= s.extent * all * d.step_length) {
      missed = missed_then;
    } else {
      leave_out(infinity);
      if (!solve(s, d, terms.tolerance, missed)) return false;
      missed = std::max(missed, all);
    }
  }
  d.energy = energy_given(s, d);
  store(s, d);
  return true;
}

}  // namespace pinchlab
