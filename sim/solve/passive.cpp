// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/passive.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/parts.h"
#include "sim/solve/active_set.h"
#include "sim/solve/solve_scratch.h"

namespace pinchlab {

bool makes_energy(const PartSystem& s, const SolveScratch& set) {
  double made = 0.0, impulse = 0.0, made_up = 0.0, fastest = 0.0;  // J, J s/m, J, m/s; twice
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    const Row& row = s.rows[r];
    if (row.impulse == 0.0) continue;
    if (row.compliance > 0.0) return false;
    const RowBodies& bodies = s.bodies[r];
    const auto a = index(bodies.a), b = index(bodies.b);
    const double of_a = bodies.ja.dot(s.free_velocity[a] + s.velocity[a]);
    const double of_b = bodies.jb.dot(s.free_velocity[b] + s.velocity[b]);
    made += row.impulse * (of_a + of_b);
    impulse += std::abs(row.impulse);
    made_up += std::abs(row.impulse) * std::min(std::abs(row.bias), s.reach / set.step_length);
    fastest = std::max({fastest, std::abs(of_a), std::abs(of_b)});
  }
  const double rounding = 1e-11 * fastest + 1e-14 * s.extent / set.step_length;
  return !(made <= impulse * rounding + 2.0 * made_up);
}

bool solve_passively(const World& world, const Parts& parts, const Part& part, PartSystem& s,
                     SolveScratch& set) {
  const bool settled = solve_direct(world, parts, part, s, set);
  if (!makes_energy(s, set)) return settled;
  forget_flips(s);
  for (Friction& friction : s.frictions) friction.dropped = true;
  Part held = part;
  held.may_slide = false;
  const bool held_settled = solve_direct(world, parts, held, s, set);
  if (!makes_energy(s, set)) return held_settled;
  for (Row& row : s.rows) row.impulse = 0.0;
  sweep_rows(s, set.capstan);
  return false;
}

}  // namespace pinchlab
