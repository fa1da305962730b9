// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/complementary.h"

#include <algorithm>
#include <cmath>

#include "sim/solve/assembly.h"
#include "sim/solve/rubbing.h"
#include "sim/solve/system.h"

namespace pinchlab {

/// Nothing that is less than `round_off` (m/s) is missed.
void Assembly::allow(double round_off) {
  double least = infinity;
  for (const double unit : scratch_.units) least = std::min(least, unit);
  problem_.round_off = least < infinity ? least * round_off : 0.0;
}

/// Impulses, velocities and sliding speeds of the unknowns' values.
void Assembly::set_values() {
  for (int r = 0; index(r) < s_.rows.size(); ++r) {
    double impulse = 0.0;
    for_shares(r, [&](const Share& p) { impulse += p.coefficient * value(p.unknown); });
    at(s_.rows, r).impulse = impulse;
  }
  apply_impulses(s_);
  for (std::size_t r = 0; r < s_.rows.size(); ++r) {
    s_.rows[r].speed = row_speed(s_, r) + s_.rows[r].compliance * s_.rows[r].impulse;
  }
  for_runs([&](Run& run, int column) { run.speed = value(column) - value(column + 1); });
}

/// w of all unknowns for those values.
void Assembly::find_speeds() {
  std::vector<double>& w = scratch_.w;
  w.assign(scratch_.kinds.size(), 0.0);
  const auto see = [&](int row, double speed) {
    for_shares(
        row, [&](const Share& e) { at(w, e.unknown) += scale(e.unknown) * e.coefficient * speed; });
  };
  for (const int r : scratch_.rows) {
    const Row& row = at(s_.rows, r);
    see(r, row.speed + (is_friction(row) ? run_speed(s_, set_.capstan, row) : 0.0));
    const int column = column_of(r);
    if (at(scratch_.kinds, column) != Unknown::friction) continue;
    const Friction& friction = at(s_.frictions, row.friction);
    const int sliding = column + 2;
    for (const int k : {column, column + 1}) {
      at(w, k) += scale(k) * value(sliding);
      at(w, sliding) -= scale(sliding) * value(k);
    }
    at(w, sliding) += scale(sliding) * friction.bound * at(s_.rows, friction.normal).impulse;
  }
  for_sleeves([&](const SleevePlace& one, int column) {
    see(one.rub, value(column + 2) - value(column + 1));
    for (const Slip slip : {Slip::forward, Slip::backward}) {
      const int equation = slip == Slip::forward ? column + 1 : column + 2;
      at(w, equation) = scale(equation) * sign(slip) *
                        (at(s_.rows, one.rub).impulse + friction_of(s_, one, slip));
    }
  });
  for_runs([&](const Run& run, int column) {
    see(run.row_in, -run.speed);
    see(run.row_out, run.speed);
    for (const int way : {1, -1}) {
      double limit = at(s_.rows, run.row_in).impulse;
      for (int k = run.passages_begin; k < run.passages_end; ++k) {
        const Passage& passage = at(set_.capstan.passages, k);
        const auto impulse = [this](int r) { return r >= 0 ? at(s_.rows, r).impulse : 0.0; };
        limit =
            tension_after(passage, way, limit, impulse(passage.normal), impulse(passage.middle));
      }
      const int equation = way > 0 ? column : column + 1;
      at(w, equation) = scale(equation) * way * (limit - at(s_.rows, run.row_out).impulse);
    }
  });
}

/// Makes up for what elimination has lost, by the solution's velocities. Whether all conditions
/// hold within `round_off` (m/s) then.
bool Assembly::refine(double round_off) {
  constexpr int times = 2;
  for (int k = 0; k < times; ++k) {
    set_values();
    find_speeds();
    for (std::size_t i = 0; i < scratch_.w.size(); ++i) {
      if (problem_.bears[i] == 0) scratch_.w[i] = 0.0;
    }
    correct(scratch_.w, problem_);
  }
  set_values();
  find_speeds();
  constexpr double rounding = 1e-10;  // of impulses, which come by way of a matrix
  double greatest = 0.0;
  for (const double z : problem_.z) greatest = std::max(greatest, std::abs(z));
  bool holds = true;
  for (std::size_t i = 0; i < scratch_.w.size(); ++i) {
    const double w = scratch_.w[i], z = problem_.z[i];
    // An impulse counts by the speed that it gives its own row.
    const double least = round_off * scratch_.units[i], of_impulse = least + rounding * greatest;
    const double allowed = scratch_.kinds[i] < Unknown::sliding ? least : of_impulse;
    holds = holds && (problem_.bears[i] != 0 ? std::abs(w) <= allowed : w >= -allowed) &&
            (problem_.either[i] != 0 || z >= -of_impulse);
  }
  return holds;
}

/// Leaves no pull or push by which its own row's speed changes by less than `round_off` (m/s).
void Assembly::clear_rounding(double round_off) {
  for (std::size_t i = 0; i < scratch_.kinds.size(); ++i) {
    if (scratch_.kinds[i] != Unknown::unilateral) continue;
    if (problem_.z[i] <= round_off * scratch_.units[i]) problem_.z[i] = 0.0;
  }
}

void Assembly::set_states() {
  const auto bears = [this](int column) { return at(problem_.bears, column) != 0; };
  const auto change = [this](auto& state, auto to, int& flipped) {
    if (state != to) flipped = set_.solves;
    state = to;
  };
  for (std::size_t r = 0; r < s_.rows.size(); ++r) {  // what is beyond reach, by any guess
    Row& row = s_.rows[r];
    if (row.idle && scratch_.column_of_row[r] < 0 && is_unilateral(row)) row.on = false;
  }
  for (const int r : scratch_.rows) {
    Row& row = at(s_.rows, r);
    const int column = column_of(r);
    const Unknown kind = at(scratch_.kinds, column);
    if (kind == Unknown::unilateral) {
      change(row.on, bears(column), row.flipped);
      row.idle = row.idle && !row.on;
    } else if (kind == Unknown::rubbing) {
      const Slip slip = bears(column + 1)   ? Slip::forward
                        : bears(column + 2) ? Slip::backward
                                            : Slip::stick;
      change(row.slip, slip, row.flipped);
      row.on = true;
    } else if (kind == Unknown::friction) {
      const bool along = at(scratch_.ways, r) > 0.0, slides = bears(column + 2);
      const Slip slip = slides && bears(along ? column : column + 1)   ? Slip::backward
                        : slides && bears(along ? column + 1 : column) ? Slip::forward
                                                                       : Slip::stick;
      change(row.slip, slip, row.flipped);
    }
  }
  for_runs([&](Run& run, int column) {
    if (run.frictionless) return;
    const bool forward = bears(column) && run.speed >= 0.0;
    const bool backward = bears(column + 1) && run.speed <= 0.0;
    change(run.slip,
           forward    ? Slip::forward
           : backward ? Slip::backward
                      : Slip::stick,
           run.flipped);
  });
}

namespace {

/// Whether there is nothing but what the conditions above are of, and no motor: one that winds in
/// what hardly can give is to stall (motors.h), and would throw that if it were held exactly.
bool suits(const PartSystem& s, const SolveScratch& set) {
  return s.motors.empty() && (s.elastic_ends.empty() || set.capstan.runs.empty()) &&
         std::ranges::none_of(set.capstan.passages,
                              [](const Passage& passage) { return passage.middle_out >= 0; });
}

/// Leaves what rows have missed by no more than `round_off` (m/s): where it contradicts other rows
/// nothing can make up for it. Whether there is any.
bool leave_round_off(PartSystem& s, double round_off) {
  bool any = false;
  for (Row& row : s.rows) {
    const double made_up = row.bias - row.curved;
    if (made_up == 0.0 || std::abs(made_up) > round_off) continue;
    row.bias = row.curved;
    any = true;
  }
  return any;
}

bool solve_once(PartSystem& s, SolveScratch& set, double round_off) {
  Assembly assembly(s, set);
  assembly.list();
  assembly.number();
  // Pivots are about as many as unknowns, and cost the square of their number: of 200 some ten
  // milliseconds.
  constexpr std::size_t most_unknowns = 200;
  if (set.complementary.kinds.size() > most_unknowns) return false;
  assembly.assemble();
  assembly.allow(round_off);
  if (!solve_complementarity(set.complementary.problem)) return false;
  return assembly.refine(round_off);
}

}  // namespace

void take_complementary(PartSystem& s, SolveScratch& set) {
  Assembly assembly(s, set);
  assembly.clear_rounding(s.reach / set.step_length);
  assembly.set_values();
  assembly.set_states();
  express_states(s, set);
  set.direct = set.by_dual = set.contradicts = false;
  set.suspicious = true;
}

bool solve_complementary(PartSystem& s, SolveScratch& set) {
  if (!suits(s, set)) return false;
  const double round_off = s.reach / set.step_length;
  const bool solved = solve_once(s, set, round_off) ||
                      (leave_round_off(s, round_off) && solve_once(s, set, round_off));
  if (solved) take_complementary(s, set);
  return solved;
}

}  // namespace pinchlab
