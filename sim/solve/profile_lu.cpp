// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/profile_lu.h"

#include <algorithm>

#include "base/at.h"

namespace pinchlab {

void ProfileLu::reset(const std::vector<int>& first) {
  first_ = first;
  offset_.resize(first.size());
  int used = 0;
  for (std::size_t u = 0; u < first.size(); ++u) {
    offset_[u] = used - first[u];
    used += static_cast<int>(u) - first[u] + 1;
  }
  lower_.assign(index(used), 0.0);
  upper_.assign(index(used), 0.0);
}

// For each u, with sums over the k that both profiles hold, and v < u:
//     U(v,u) = A(v,u) - sum L(v,k) U(k,u),   L(u,v) = (A(u,v) - sum L(u,k) U(k,v)) / U(v,v),
//     U(u,u) = A(u,u) - sum L(u,k) U(k,u).
int ProfileLu::factor(const std::vector<double>& scale, double ridge) {
  int dependent = 0;
  for (int u = 0; u < size(); ++u) {
    const int begin = at(first_, u);
    double* row = lower_.data() + at(offset_, u);
    double* column = upper_.data() + at(offset_, u);
    for (int v = begin; v < u; ++v) {
      const int from = std::max(begin, at(first_, v));
      const double* row_v = lower_.data() + at(offset_, v);
      const double* column_v = upper_.data() + at(offset_, v);
      double up = column[v], low = row[v];
      for (int k = from; k < v; ++k) {
        up -= row_v[k] * column[k];
        low -= row[k] * column_v[k];
      }
      column[v] = up;
      row[v] = column_v[v] != 0.0 ? low / column_v[v] : 0.0;
    }
    const double size_u = at(scale, u);
    double pivot = column[u] + ridge * size_u;
    for (int k = begin; k < u; ++k) pivot -= row[k] * column[k];
    if (pivot < dependence * size_u && pivot > -dependence * size_u) {
      pivot = 0.0;
      ++dependent;
    }
    column[u] = pivot;
  }
  return dependent;
}

void ProfileLu::solve(std::vector<double>& x) const {
  for (int u = 0; u < size(); ++u) {
    const double* row = lower_.data() + at(offset_, u);
    double sum = at(x, u);
    for (int k = at(first_, u); k < u; ++k) {
      sum -= row[k] * at(x, k);
    }
    at(x, u) = sum;
  }
  for (int u = size() - 1; u >= 0; --u) {
    const double* column = upper_.data() + at(offset_, u);
    double& value = at(x, u);
    value = column[u] != 0.0 ? value / column[u] : 0.0;
    for (int k = at(first_, u); k < u; ++k) {
      at(x, k) -= column[k] * value;
    }
  }
}

}  // namespace pinchlab
