// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/profile_ldl.h"

#include <algorithm>

namespace pinchlab {

// For each u, with sums over the k that both profiles hold and y(v) = L(u,v) d(v):
//     y(v) = A(u,v) - sum y(k) L(v,k),   d(u) = A(u,u) - sum L(u,v) y(v).
int ProfileLdl::factor(const std::vector<double>& scale, double ridge) {
  const std::size_t count = first_.size();
  reciprocal_.resize(count);
  factors_.resize(entries_.size());
  std::copy_n(entries_.begin(), used_, factors_.begin());
  int dependent = 0;
  for (std::size_t u = 0; u < count; ++u) {
    const int first = first_[u], n = static_cast<int>(u);
    double* row = factors_.data() + begin_[u] - first;
    for (int v = first + 1; v < n; ++v) {
      const int first_v = first_[static_cast<std::size_t>(v)];
      const double* row_v = factors_.data() + begin_[static_cast<std::size_t>(v)] - first_v;
      double y = row[v];
      for (int k = std::max(first, first_v); k < v; ++k) y -= row[k] * row_v[k];
      row[v] = y;
    }
    double pivot = row[n] + scale[u] * (1.0 + ridge);
    for (int v = first; v < n; ++v) {
      const double y = row[v];
      row[v] = y * reciprocal_[static_cast<std::size_t>(v)];
      pivot -= row[v] * y;
    }
    if (pivot < dependence * scale[u] && pivot > -dependence * scale[u]) {
      reciprocal_[u] = 0.0;
      ++dependent;
    } else {
      reciprocal_[u] = 1.0 / pivot;
    }
  }
  return dependent;
}

void ProfileLdl::solve(std::vector<double>& x) const {
  const std::size_t count = first_.size();
  for (std::size_t u = 0; u < count; ++u) {
    const double* row = factors_.data() + begin_[u] - first_[u];
    double sum = x[u];
    for (int k = first_[u]; k < static_cast<int>(u); ++k) {
      sum -= row[k] * x[static_cast<std::size_t>(k)];
    }
    x[u] = sum;
  }
  for (std::size_t u = 0; u < count; ++u) x[u] *= reciprocal_[u];
  for (std::size_t u = count; u-- > 0;) {
    const double* row = factors_.data() + begin_[u] - first_[u];
    const double value = x[u];
    for (int k = first_[u]; k < static_cast<int>(u); ++k) {
      x[static_cast<std::size_t>(k)] -= row[k] * value;
    }
  }
}

}  // namespace pinchlab
