// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/profile_ldl.h"

#include <algorithm>

namespace pinchlab {

// Each row waits for the one before it, whose value is therefore carried in a register.
//
// For each u, with sums over the k that both profiles hold and y(v) = L(u,v) d(v):
//     y(v) = A(u,v) - sum y(k) L(v,k),   d(u) = A(u,u) - sum L(u,v) y(v).
int ProfileLdl::factor(const std::vector<double>& scale, double ridge) {
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
    if (pivot < dependence * scale[u] && pivot > -dependence * scale[u]) {
      before = 0.0;
      ++dependent;
    } else {
      before = 1.0 / pivot;
    }
    reciprocal_[u] = before;
  }
  return dependent;
}

void ProfileLdl::solve(std::vector<double>& x) const {
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

}  // namespace pinchlab
