// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/profile_ldl.h"

#include <algorithm>

namespace pinchlab {

namespace {

/// 1 / pivot, or 0 of one that is nothing but round-off.
inline double reciprocal_of(double pivot, double scale, int& dependent) {
  if (pivot < ProfileLdl::dependence * scale && pivot > -ProfileLdl::dependence * scale) {
    ++dependent;
    return 0.0;
  }
  return 1.0 / pivot;
}

}  // namespace

// Each row waits for the one before it, whose value is therefore carried in a register.
//
// For each u, with sums over the k that both profiles hold and y(v) = L(u,v) d(v):
//     y(v) = A(u,v) - sum y(k) L(v,k),   d(u) = A(u,u) - sum L(u,v) y(v).
int ProfileLdl::factor(const std::vector<double>& scale, double ridge) {
  if (narrow_) return factor_narrow(scale, ridge);
  const std::size_t count = first_.size();
  reciprocal_.resize(count);
  factors_.resize(entries_.size());
  std::copy_n(entries_.begin(), used_, factors_.begin());
  int dependent = 0;
  double before = 0.0;  // reciprocal of the pivot before
  for (std::size_t u = 0; u < count; ++u) {
    const int first = first_[u], n = static_cast<int>(u);
    double* row = factors_.data() + offset_[u];
    for (int v = first + 1; v < n; ++v) {
      const double* row_v = factors_.data() + at(offset_, v);
      double y = row[v];
      for (int k = std::max(first, at(first_, v)); k < v; ++k) y -= row[k] * row_v[k];
      row[v] = y;
    }
    double pivot = row[n] + scale[u] * (1.0 + ridge);
    const auto eliminate = [row, &pivot](int v, double reciprocal) {
      const double y = row[v];
      row[v] = y * reciprocal;
      pivot -= row[v] * y;
    };
    for (int v = first; v < n - 1; ++v) eliminate(v, at(reciprocal_, v));
    if (first < n) eliminate(n - 1, before);
    reciprocal_[u] = before = reciprocal_of(pivot, scale[u], dependent);
  }
  return dependent;
}

int ProfileLdl::factor_narrow(const std::vector<double>& scale, double ridge) {
  const std::size_t count = first_.size();
  reciprocal_.resize(count);
  factors_.resize(count);
  int dependent = 0;
  double before = 0.0;
  for (std::size_t u = 0; u < count; ++u) {
    const int n = static_cast<int>(u);
    const double* row = entries_.data() + offset_[u];
    const double y = first_[u] < n ? row[n - 1] : 0.0, factor = y * before;
    factors_[u] = factor;
    const double pivot = row[n] + scale[u] * (1.0 + ridge) - factor * y;
    reciprocal_[u] = before = reciprocal_of(pivot, scale[u], dependent);
  }
  return dependent;
}

void ProfileLdl::solve(std::vector<double>& x) const {
  if (narrow_) return solve_narrow(x);
  const std::size_t count = first_.size();
  if (count == 0) return;
  double last = 0.0;  // x[u - 1]
  for (std::size_t u = 0; u < count; ++u) {
    const int first = first_[u], n = static_cast<int>(u);
    const double* row = factors_.data() + offset_[u];
    double sum = x[u];
    for (int k = first; k < n - 1; ++k) sum -= row[k] * at(x, k);
    if (first < n) sum -= row[n - 1] * last;
    x[u] = last = sum;
  }
  for (std::size_t u = 0; u < count; ++u) x[u] *= reciprocal_[u];
  last = x[count - 1];  // x[u]
  for (std::size_t u = count - 1; u > 0; --u) {
    const int first = first_[u], n = static_cast<int>(u);
    const double* row = factors_.data() + offset_[u];
    for (int k = first; k < n - 1; ++k) at(x, k) -= row[k] * last;
    double next = x[u - 1];
    if (first < n) next -= row[n - 1] * last;
    x[u - 1] = last = next;
  }
}

void ProfileLdl::solve_narrow(std::vector<double>& x) const {
  const std::size_t count = first_.size();
  double last = 0.0;
  for (std::size_t u = 0; u < count; ++u) x[u] = last = x[u] - factors_[u] * last;
  last = 0.0;
  double coupling = 0.0;  // L(u + 1, u)
  for (std::size_t u = count; u-- > 0;) {
    x[u] = last = x[u] * reciprocal_[u] - coupling * last;
    coupling = factors_[u];
  }
}

}  // namespace pinchlab
