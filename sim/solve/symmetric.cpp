// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/symmetric.h"

#include <algorithm>
#include <array>

#include "base/at.h"
#include "sim/solve/part_system.h"
#include "sim/solve/solve_scratch.h"

namespace pinchlab {

namespace {

/// Appends an end of unknown u to the chain of its body.
void append_end(RowEnd* ends, int* last_end, int end, int body, int u) {
  int& last = last_end[body];
  ends[end].previous = last;
  ends[end].least = last >= 0 ? ends[last].least : u;
  last = end;
}

/// What unknown u's row feels of one that moves `body` by `response`, summed over its ends there.
double felt(const RowBodies& row, int body, const Eigen::Vector3d& response, double sum) {
  if (row.b == body) sum += dot(response, row.jb);
  if (row.a == body) sum += dot(response, row.ja);
  return sum;
}

/// The matrix J M^-1 J^T + compliance where each unknown is one row's impulse. Every body keeps the
/// chain of the unknowns that move it, so that a row finds those that it is coupled with.
void assemble_symmetric(PartSystem& s, SolveScratch& set) {
  const int count = static_cast<int>(set.row_of_unknown.size());
  set.last_end.assign(s.mobility.size(), -1);
  set.ends.resize(2 * index(count));
  s.ldl.clear();
  RowEnd* ends = set.ends.data();
  int* last_end = set.last_end.data();
  for (int u = 0; u < count; ++u) {
    const RowBodies& row = at(s.bodies, set.row_of_unknown[index(u)]);
    const int a = at(s.mobile, row.a) ? row.a : -1, b = at(s.mobile, row.b) ? row.b : -1;
    const int last_a = a >= 0 ? last_end[a] : -1, last_b = b >= 0 ? last_end[b] : -1;
    int first = u;
    if (last_a >= 0) first = std::min(first, ends[last_a].least);
    if (last_b >= 0) first = std::min(first, ends[last_b].least);
    double* entries = s.ldl.append(first);
    const auto add = [&](int last, const Eigen::Vector3d& response) {
      for (int e = last; e >= 0; e = ends[e].previous) {
        const RowBodies& other = at(s.bodies, set.row_of_unknown[index(e / 2)]);
        entries[e / 2] += dot(response, e % 2 == 0 ? other.ja : other.jb);
      }
    };
    const RowResponse& response = at(s.responses, set.row_of_unknown[index(u)]);
    add(last_a, response.ra);
    add(last_b, response.rb);
    if (a >= 0 && a == b) entries[u] = 2.0 * dot(response.ra, row.jb);
    if (a >= 0) append_end(ends, last_end, 2 * u, a, u);
    if (b >= 0) append_end(ends, last_end, 2 * u + 1, b, u);
  }
  s.assembled = set.row_of_unknown;
}

/// The ends of a row that are on bodies which can move.
struct Ends {
  std::array<int, 3> place{-1, -1, -1};
  std::array<const Eigen::Vector3d*, 3> j{}, response{};

  Ends(const PartSystem& s, int row) {
    const RowBodies& bodies = at(s.bodies, row);
    const RowResponse& responses = at(s.responses, row);
    set(s, 0, bodies.a, bodies.ja, responses.ra);
    set(s, 1, bodies.b, bodies.jb, responses.rb);
    const ThirdBody* third = third_of(s, index(row));
    if (third) set(s, 2, third->place, third->j, third->response);
  }

  void set(const PartSystem& s, std::size_t end, int body, const Eigen::Vector3d& sees,
           const Eigen::Vector3d& moves) {
    place[end] = at(s.mobile, body) ? body : -1;
    j[end] = &sees;
    response[end] = &moves;
  }
};

/// The same matrix where rows have up to three bodies.
void assemble_of_three(PartSystem& s, SolveScratch& set) {
  const int count = static_cast<int>(set.row_of_unknown.size());
  set.last_end.assign(s.mobility.size(), -1);
  set.ends.resize(3 * index(count));
  s.ldl.clear();
  for (int u = 0; u < count; ++u) {
    const Ends own(s, at(set.row_of_unknown, u));
    std::array<int, 3> last{-1, -1, -1};
    int first = u;
    for (std::size_t i = 0; i < 3; ++i) {
      if (own.place[i] >= 0) last[i] = at(set.last_end, own.place[i]);
      if (last[i] >= 0) first = std::min(first, at(set.ends, last[i]).least);
    }
    double* entries = s.ldl.append(first);
    for (std::size_t i = 0; i < 3; ++i) {
      for (int e = last[i]; e >= 0; e = at(set.ends, e).previous) {
        const Ends other(s, at(set.row_of_unknown, e / 3));
        entries[e / 3] += dot(*own.response[i], *other.j[index(e % 3)]);
      }
    }
    if (own.place[0] >= 0 && own.place[0] == own.place[1]) {
      entries[u] = 2.0 * dot(*own.response[0], *own.j[1]);
    }
    for (int i = 0; i < 3; ++i) {
      const int body = own.place[index(i)];
      if (body >= 0) append_end(set.ends.data(), set.last_end.data(), 3 * u + i, body, u);
    }
  }
  s.assembled = set.row_of_unknown;
}

/// Brings the matrix up to date where rows have changed since it was assembled for the same ones.
void reassemble_changed(PartSystem& s) {
  int last_changed = -1;
  for (int u = 0; u < s.ldl.size(); ++u) {
    const int r = s.assembled[index(u)], first = s.ldl.first(u);
    if (at(s.changed, r)) last_changed = u;
    if (last_changed < first) continue;
    const RowBodies& row = at(s.bodies, r);
    const RowResponse& response = at(s.responses, r);
    double* entries = s.ldl.row(u);
    for (int v = first; v < u; ++v) {
      const int other = s.assembled[index(v)];
      if (!at(s.changed, r) && !at(s.changed, other)) continue;
      const RowBodies& others = at(s.bodies, other);
      double sum = 0.0;
      if (at(s.mobile, row.a)) sum = felt(others, row.a, response.ra, sum);
      if (at(s.mobile, row.b)) sum = felt(others, row.b, response.rb, sum);
      entries[v] = sum;
    }
    if (at(s.changed, r)) {
      entries[u] = row.a == row.b && at(s.mobile, row.a) ? 2.0 * dot(response.ra, row.jb) : 0.0;
    }
  }
}

/// What a row alone adds to its diagonal, by which pivots are judged as well. Returns whether that
/// has changed, be it by a bit.
bool rescale(PartSystem& s, const SolveScratch& set) {
  const std::size_t count = set.row_of_unknown.size();
  bool same = s.scale.size() == count;
  s.scale.resize(count);
  for (std::size_t u = 0; u < count; ++u) {
    const Row& row = at(s.rows, set.row_of_unknown[u]);
    const double scale = row.diagonal + row.compliance;
    same = same && scale == s.scale[u];
    s.scale[u] = scale;
  }
  return !same;
}

}  // namespace

int factor_symmetric(PartSystem& s, SolveScratch& set) {
  const bool same_rows = !s.assembled.empty() && s.assembled == set.row_of_unknown;
  const bool rescaled = rescale(s, set);
  const bool stands = same_rows && !rescaled && s.rows_stand;
  if (stands && s.factored) return 0;
  const auto changed = std::count(s.changed.begin(), s.changed.end(), true);
  if (!s.thirds.empty()) {
    assemble_of_three(s, set);
  } else if (!same_rows || 2 * index(static_cast<int>(changed)) > s.changed.size()) {
    assemble_symmetric(s, set);
  } else if (changed > 0) {
    reassemble_changed(s);
  }
  const int repeated = s.ldl.factor(s.scale, 0.0, s.unsure);
  s.factored = repeated == 0;
  // The matrix is up to date: another solve of the same rows needs no other.
  s.rows_stand = true;
  std::fill(s.changed.begin(), s.changed.end(), false);
  return repeated;
}

}  // namespace pinchlab
