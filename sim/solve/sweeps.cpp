// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/sweeps.h"

#include <algorithm>

#include "base/at.h"
#include "sim/solve/friction.h"
#include "sim/solve/rubbing.h"
#include "sim/solve/solve_scratch.h"
#include "sim/solve/system.h"

namespace pinchlab {

void clear_negative(PartSystem& s) {
  for (Row& row : s.rows) {
    if (is_unilateral(row)) row.impulse = std::max(row.impulse, 0.0);
  }
}

void sweep_rows(PartSystem& s, SolveScratch& set) {
  set.direct = set.by_dual = false;
  set.swept = true;
  clear_negative(s);
  for (Run& run : set.capstan.runs) run.speed = 0.0;
  apply_impulses(s);
  // A fallback, which is told: it is to be finite and to make no energy, rather than right. With
  // each sweep a row's impulse reaches the next one at least.
  constexpr int sweeps = 200;
  for (int k = 0; k < sweeps; ++k) {
    for (std::size_t r = 0; r < s.rows.size(); ++r) {
      Row& row = s.rows[r];
      if (!gives(row) || row.idle) continue;
      double least = row.clamped ? -infinity : 0.0, most = infinity;
      if (is_friction(row)) {
        const Friction& friction = at(s.frictions, row.friction);
        const double force = friction.normal >= 0 ? at(s.rows, friction.normal).impulse : infinity;
        most = friction.dropped ? 0.0 : most_friction(friction.bound, force);
        least = -most;
      } else if (row.kind == RowKind::sleeve_rub) {
        const Bounds bounds = bounds_of_rubbing(s, row);
        least = bounds.least;
        most = bounds.most;
      }
      const double before = row.impulse;
      const double w = row_speed(s, r) + row.compliance * before;
      row.impulse = std::clamp(before - w / (row.diagonal + row.compliance), least, most);
      push(s, r, row.impulse - before);
    }
  }
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    Row& row = s.rows[r];
    row.speed = row_speed(s, r);
    if (!is_friction(row)) row.on = row.clamped || row.impulse > 0.0;
    if (row.kind != RowKind::sleeve_rub) continue;
    row.slip = row.speed > 0.0 ? Slip::forward : row.speed < 0.0 ? Slip::backward : Slip::stick;
  }
}

}  // namespace pinchlab
