// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/repeated_rows.h"

#include <algorithm>

#include "base/at.h"
#include "sim/solve/part_system.h"
#include "sim/solve/solve_scratch.h"
#include "sim/solve/symmetric.h"

namespace pinchlab {

namespace {

// So many rows come last at most, each of which may fill all of its own of the matrix.
constexpr int most_last = 32;

/// What a row may be off by (1/kg), squared as its diagonal, that bears force both ways between two
/// bodies which turn and no more: all of it is levers, known to no more than what lengths may miss.
/// 0: of any other, and where that is next to nothing of its levers.
double unsure_of(const PartSystem& s, int r) {
  constexpr double next_to_nothing = 1e-12;
  if (!at(s.rows, r).clamped) return 0.0;
  const RowBodies& bodies = at(s.bodies, r);
  const Mobility &a = at(s.mobility, bodies.a), &b = at(s.mobility, bodies.b);
  if (a.xx != 0.0 || a.yy != 0.0 || b.xx != 0.0 || b.yy != 0.0) return 0.0;
  const double unsure = s.reach * s.reach * (a.angular + b.angular);
  return unsure > next_to_nothing * at(s.rows, r).diagonal ? unsure : 0.0;
}

/// Numbers the unknowns in the order in which their rows are listed.
void number_in_order(PartSystem& s, SolveScratch& set) {
  for (std::size_t u = 0; u < set.row_of_unknown.size(); ++u) {
    const int r = set.row_of_unknown[u];
    at(set.unknown_of_row, r) = static_cast<int>(u);
    if (!s.unsure.empty()) s.unsure[u] = unsure_of(s, r);
  }
}

}  // namespace

void put_levers_last(PartSystem& s, SolveScratch& set) {
  std::vector<int>& rows = set.row_of_unknown;
  s.unsure.resize(rows.size());
  int count = 0;
  for (std::size_t u = 0; u < rows.size(); ++u) {
    s.unsure[u] = unsure_of(s, rows[u]);
    count += s.unsure[u] > 0.0 ? 1 : 0;
  }
  if (count == 0 || count > most_last) return s.unsure.clear();
  const auto comes_before = [&](int p, int q) {
    const int u = at(set.unknown_of_row, p), v = at(set.unknown_of_row, q);
    const bool p_turns = at(s.unsure, u) > 0.0, q_turns = at(s.unsure, v) > 0.0;
    if (p_turns != q_turns) return q_turns;
    const double longer = p_turns ? at(s.rows, p).diagonal - at(s.rows, q).diagonal : 0.0;
    return longer > 0.0 || (longer == 0.0 && u < v);
  };
  std::sort(rows.begin(), rows.end(), comes_before);
  number_in_order(s, set);
}

int factor_repeated_last(PartSystem& s, SolveScratch& set, int repeated) {
  constexpr double hardly = 1e-3;  // of a row's own
  constexpr int most_times = 3;    // what comes last may leave others more than they had
  std::vector<int>& rows = set.row_of_unknown;
  for (int k = 0; k < most_times && repeated > 0; ++k) {
    set.right_side.resize(rows.size());
    bool in_order = true;
    int told = 0;
    double least = infinity;
    for (std::size_t u = 0; u < rows.size(); ++u) {
      const double pivot = s.ldl.pivot(static_cast<int>(u), s.scale[u]);
      set.right_side[u] = std::min(pivot, hardly);
      in_order = in_order && set.right_side[u] <= least;
      told += pivot < hardly ? 1 : 0;
      least = set.right_side[u];
    }
    if (in_order || told > most_last) break;
    std::sort(rows.begin(), rows.end(), [&set](int p, int q) {
      const int u = at(set.unknown_of_row, p), v = at(set.unknown_of_row, q);
      const double more = at(set.right_side, u) - at(set.right_side, v);
      return more > 0.0 || (more == 0.0 && u < v);
    });
    number_in_order(s, set);
    repeated = factor_symmetric(s, set);
  }
  return repeated;
}

}  // namespace pinchlab
