// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/profile_ldl.h"

#include <algorithm>
#include <cmath>

namespace pinchlab {

namespace {

inline bool is_round_off(double pivot, double scale, double noise) {
  return std::abs(pivot) < std::max(ProfileLdl::dependence * scale, noise);
}

}  // namespace

// Each row waits for the one before it, whose value is therefore carried in a register.
//
// For each u, with sums over the k that both profiles hold and y(v) = L(u,v) d(v):
//     y(v) = A(u,v) - sum y(k) L(v,k),   d(u) = A(u,u) - sum L(u,v) y(v).
// Of a dependent row all L are zero from there on, and those of its own row meet its zero only: it
// is left out, and u, v and k count the others.
int ProfileLdl::factor(const std::vector<double>& scale, double ridge,
                       const std::vector<double>& unsure) {
  if (narrow_) return factor_narrow(scale, ridge, unsure);
  const std::size_t count = first_.size();
  reciprocal_.resize(count);
  factors_.resize(entries_.size());
  factor_first_.resize(count);
  factor_offset_.resize(count);
  independent_.resize(count);
  independent_before_.resize(count);
  noise_.resize(count);
  int n = 0;            // rows so far that repeat none
  int used = 0;         // of factors_
  double before = 0.0;  // reciprocal of the pivot before
  for (std::size_t u = 0; u < count; ++u) {
    independent_before_[u] = n;
    const int first = at(independent_before_, first_[u]);
    const int offset = used - first;
    double* row = factors_.data() + offset;
    const double* entries = entries_.data() + offset_[u];
    if (index(n) == u) {
      std::copy(entries + first, entries + n, row + first);
    } else {
      for (int v = first; v < n; ++v) row[v] = entries[at(independent_, v)];
    }
    for (int v = first + 1; v < n; ++v) {
      const int first_v = at(factor_first_, v);
      const double* row_v = factors_.data() + at(factor_offset_, v);
      double y = row[v];
      for (int k = std::max(first, first_v); k < v; ++k) y -= row[k] * row_v[k];
      row[v] = y;
    }
    double pivot = entries[u] + scale[u] * (1.0 + ridge);
    const auto eliminate = [row, &pivot](int v, double reciprocal) {
      const double y = row[v];
      row[v] = y * reciprocal;
      pivot -= row[v] * y;
    };
    for (int v = first; v < n - 1; ++v) eliminate(v, at(reciprocal_, v));
    if (first < n) eliminate(n - 1, before);
    double noise = round_off * scale[u] + (unsure.empty() ? 0.0 : unsure[u]);
    for (int v = first; v < n; ++v) noise += row[v] * row[v] * at(noise_, v);
    if (is_round_off(pivot, scale[u], noise)) continue;
    at(noise_, n) = noise;
    at(reciprocal_, n) = before = 1.0 / pivot;
    at(factor_first_, n) = first;
    at(factor_offset_, n) = offset;
    used = offset + n;
    at(independent_, n++) = static_cast<int>(u);
  }
  independent_.resize(index(n));
  return static_cast<int>(count) - n;
}

int ProfileLdl::factor_narrow(const std::vector<double>& scale, double ridge,
                              const std::vector<double>& unsure) {
  const std::size_t count = first_.size();
  reciprocal_.resize(count);
  factors_.resize(count);
  int dependent = 0;
  const bool is_unsure = !unsure.empty();
  double before = 0.0, noise = 0.0;
  for (std::size_t u = 0; u < count; ++u) {
    const int n = static_cast<int>(u);
    const double* row = entries_.data() + offset_[u];
    const double y = first_[u] < n ? row[n - 1] : 0.0, factor = y * before;
    factors_[u] = factor;
    const double pivot = row[n] + scale[u] * (1.0 + ridge) - factor * y;
    noise = round_off * scale[u] + factor * factor * noise;
    if (is_unsure) noise += unsure[u];
    const bool repeats = is_round_off(pivot, scale[u], noise);
    if (repeats) ++dependent;
    reciprocal_[u] = before = repeats ? 0.0 : 1.0 / pivot;
  }
  return dependent;
}

double ProfileLdl::pivot(int u, double scale) const {
  if (narrow_) return at(reciprocal_, u) == 0.0 ? 0.0 : 1.0 / (at(reciprocal_, u) * scale);
  const int n = at(independent_before_, u);
  const bool repeats = index(n) >= independent_.size() || at(independent_, n) != u;
  return repeats ? 0.0 : 1.0 / (at(reciprocal_, n) * scale);
}

void ProfileLdl::solve(std::vector<double>& x) const {
  if (narrow_) return solve_narrow(x);
  const std::size_t count = independent_.size();
  const bool all = count == first_.size();
  if (!all) {
    for (std::size_t u = 0; u < count; ++u) x[u] = at(x, independent_[u]);
  }
  solve_independent(x);
  if (all) return;
  std::size_t end = first_.size();
  for (std::size_t u = count; u-- > 0;) {
    const std::size_t place = index(independent_[u]);
    const double value = x[u];
    std::fill(x.data() + place + 1, x.data() + end, 0.0);
    x[place] = value;
    end = place;
  }
  std::fill(x.data(), x.data() + end, 0.0);
}

void ProfileLdl::solve_independent(std::vector<double>& x) const {
  const std::size_t count = independent_.size();
  if (count == 0) return;
  double last = 0.0;  // x[u - 1]
  for (std::size_t u = 0; u < count; ++u) {
    const int first = factor_first_[u], n = static_cast<int>(u);
    const double* row = factors_.data() + factor_offset_[u];
    double sum = x[u];
    for (int k = first; k < n - 1; ++k) sum -= row[k] * at(x, k);
    if (first < n) sum -= row[n - 1] * last;
    x[u] = last = sum;
  }
  for (std::size_t u = 0; u < count; ++u) x[u] *= reciprocal_[u];
  last = x[count - 1];  // x[u]
  for (std::size_t u = count - 1; u > 0; --u) {
    const int first = factor_first_[u], n = static_cast<int>(u);
    const double* row = factors_.data() + factor_offset_[u];
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
