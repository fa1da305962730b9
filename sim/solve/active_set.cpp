// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/active_set.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/at.h"
#include "sim/solve/complementary.h"
#include "sim/solve/dual_active_set.h"
#include "sim/solve/friction.h"
#include "sim/solve/ordering.h"
#include "sim/solve/rubbing.h"
#include "sim/solve/solve_scratch.h"
#include "sim/solve/sweeps.h"
#include "sim/solve/system.h"

namespace pinchlab {

namespace {

/// Friction rows bear force only where their contact does. A pinch without slip may push its bodies
/// apart while it holds and let them together while it does not: infinite friction times no force.
/// Then it holds.
void bound_friction(PartSystem& s, const SolveScratch& set) {
  for (Friction& friction : s.frictions) {
    if (friction.repeats >= 0) continue;
    Row& row = at(s.rows, friction.row);
    if (friction.normal >= 0) {
      const Row& normal = at(s.rows, friction.normal);
      row.on = normal.on || (normal.returned && friction.coefficient == infinity);
    }
    bool slack = false;
    if (friction.run >= 0) {
      const Run& run = at(set.capstan.runs, friction.run);
      slack = run.lets_go || (!at(s.rows, run.row_in).on && !at(s.rows, run.row_out).on);
    }
    friction.bound = bound_in_force(friction, slack);
    if (friction.bound == 0.0 || friction.dropped) row.on = false;
    if (friction.bound == infinity) row.slip = Slip::stick;
  }
}

/// Cable between two surfaces that press it, and over which it cannot slide, moves as both do: it
/// is pushed as well as pulled.
void clamp_pinches(PartSystem& s) {
  for (const int r : s.pressed) {
    Row& row = at(s.rows, r);
    if (row.presser < 0) continue;
    const Row& presser = at(s.rows, row.presser);
    row.clamped = presser.on || presser.returned;
    row.on = row.on || row.clamped;
  }
}

struct Tolerances {
  double speed;    // m/s
  double impulse;  // N s
};

/// Round-off of the quantities that the checks compare: of speeds, and of positions and lengths,
/// which the rows' biases divide by the step. The errors of a cable's segments add up along it.
Tolerances tolerances(const PartSystem& s, const SolveScratch& scratch) {
  double speed = 0.0, impulse = 0.0, stiffest = 0.0;
  for (std::size_t b = 0; b < s.velocity.size(); ++b) {
    const Eigen::Vector3d &v = s.velocity[b], &f = s.free_velocity[b];
    speed = std::max({speed, std::abs(v.x()), std::abs(v.y()), std::abs(f.x()), std::abs(f.y())});
  }
  for (const Row& row : s.rows) {
    impulse = std::max(impulse, std::abs(row.impulse));
    stiffest = std::max(stiffest, row.diagonal);
    if (row.on) speed = std::max(speed, std::abs(row.bias));
  }
  // What takes many solves is round-off more likely than not: it is given more room with each.
  // A thousandfold is still far below what shows.
  constexpr int patience = 4, most_doublings = 10;
  const int doublings = std::clamp(scratch.solves - patience, 0, most_doublings);
  // Of speeds some thousand units in their last place, as a long cable adds them up, and some units
  // of its extent; of impulses a hundred times that, since they come by way of a matrix.
  const double tolerance =
      std::ldexp(1e-12 * speed + 1e-15 * s.extent / scratch.step_length, doublings);
  return {tolerance, 1e-10 * impulse + (stiffest > 0.0 ? tolerance / stiffest : 0.0)};
}

void check_friction(const PartSystem& s, const Row& row, int number, double sliding,
                    const Tolerances& tolerance, SolveScratch& set) {
  const Friction& friction = at(s.frictions, row.friction);
  if (!row.on || friction.frozen || friction.bound == infinity) return;
  const double bound = friction.bound * at(s.rows, friction.normal).impulse;
  if (row.slip == Slip::stick) {
    // Where the contact would pull, friction that bears nothing has no direction to slide in.
    if (std::abs(row.impulse) <= bound + tolerance.impulse || row.impulse == 0.0) return;
    constexpr int patience = 4;  // solves, in which what presses may find its state
    const Slip pushed = slip_of(row.impulse, bound);
    const Slip slip = set.solves < patience ? pushed : way_to_try(pushed, friction.slid);
    set.flips.push_back({number, false, true, slip});
  } else if (sliding * static_cast<int>(row.slip) < -tolerance.speed && bound > tolerance.impulse) {
    set.flips.push_back({number, false, true, Slip::stick});
  }
}

/// Which states the solution contradicts.
void check(const PartSystem& s, SolveScratch& set) {
  set.flips.clear();
  set.suspicious = set.suspicious || !s.sleeves.empty();
  if (!set.suspicious) return;
  const Tolerances tolerance = tolerances(s, set);
  const bool slides = !set.capstan.runs.empty();
  if (slides) check_runs(s, set, tolerance.speed, tolerance.impulse);
  if (!s.sleeves.empty()) check_rubbing(s, set, tolerance.speed, tolerance.impulse);
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    const Row& row = s.rows[r];
    const int number = static_cast<int>(r);
    if (is_friction(row)) {
      // A middle body's is what it missed while it stuck; a contact's is part of how it slides.
      const double made_up = row.kind == RowKind::tangent ? 0.0 : row.bias;
      const double sliding = row.speed - made_up + sliding_of_run(s, set.capstan, row);
      check_friction(s, row, number, sliding, tolerance, set);
    } else if (gives(row) && !row.clamped && (!slides || set.capstan.group_of_row[r] < 0)) {
      if (row.on && row.impulse < -tolerance.impulse) {
        set.flips.push_back({number, false, false, Slip::stick});
      } else if (!row.on && !row.idle && row.speed < -tolerance.speed) {
        set.flips.push_back({number, false, true, Slip::stick});
      }
    }
  }
}

/// Whether the solution's negative impulses are round-off: whether, with zero in their place, every
/// row still holds to within the tolerance. (Of a cable that hardly bears tension the impulses are
/// uncertain by the tolerance times the matrix' condition, which grows with the square of its
/// segments.) Leaves zeros in their place if so.
bool clear_rounding(PartSystem& s, SolveScratch& set) {
  if (!set.symmetric) return false;
  for (const Flip& flip : set.flips) {
    if (flip.is_run || flip.on) return false;
  }
  const double tolerance = tolerances(s, set).speed;
  for (Row& row : s.rows) {
    if (is_unilateral(row)) row.impulse = std::max(row.impulse, 0.0);
  }
  apply_impulses(s);
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    Row& row = s.rows[r];
    row.speed = row_speed(s, r) + row.compliance * row.impulse;
    if (!gives(row) || row.idle || (!row.on && !is_unilateral(row))) continue;
    if (row.speed < -tolerance || (row.on && row.speed > tolerance)) return false;
  }
  set.direct = false;
  return true;
}

void apply(PartSystem& s, SolveScratch& set, const Flip& flip) {
  if (flip.is_run) {
    Run& run = at(set.capstan.runs, flip.row);
    run.slip = flip.slip;
    if (flip.slip != Slip::stick) run.slid = flip.slip;
    run.flipped = set.solves;
    return;
  }
  Row& row = at(s.rows, flip.row);
  if (row.kind == RowKind::normal && flip.on && row.flipped > 0) row.returned = true;
  row.flipped = set.solves;
  if (row.kind == RowKind::sleeve_rub) {
    row.on = flip.on;
    row.slip = flip.slip;
  } else if (is_friction(row)) {
    row.slip = flip.slip;
    if (flip.slip != Slip::stick) at(s.frictions, row.friction).slid = flip.slip;
  } else {
    row.on = flip.on;
  }
}

/// One flip, where flipping everything makes no progress. With friction every fixed rule of choice
/// has its cycles, so the choice hops about: by a fixed multiplicative sequence, the same in every
/// run.
const Flip& choose_flip(const SolveScratch& set, int solve) {
  const auto hop = static_cast<std::uint32_t>(solve) * 2654435761u;
  return set.flips[(hop >> 8) % set.flips.size()];
}

/// Whether all that the solution asks for is that more rows bear a force.
bool only_grows(const SolveScratch& set) {
  return std::all_of(set.flips.begin(), set.flips.end(),
                     [](const Flip& flip) { return !flip.is_run && flip.on; });
}

/// Makes the segments taut that lie up to `reach` before or after one that is to be made taut. A
/// slack cable that is pulled tight grows taut by one segment a solve from where it is pulled; with
/// a reach that doubles it takes the logarithm of that, and those that are too many slacken again.
void spread_tautness(PartSystem& s, const SolveScratch& set, int reach) {
  for (const Flip& flip : set.flips) {
    const Row& pulled = at(s.rows, flip.row);
    if (pulled.kind != RowKind::segment) continue;
    const int last = std::min(flip.row + reach, static_cast<int>(s.rows.size()) - 1);
    for (int r = std::max(flip.row - reach, 0); r <= last; ++r) {
      Row& row = at(s.rows, r);
      if (row.kind != RowKind::segment || row.index != pulled.index || row.on) continue;
      row.on = gives(row) && !row.idle;
      row.flipped = set.solves;
    }
  }
}

/// Lets contacts bear force to which a blow runs on from one that is to do so; whether there are
/// any. Bodies in touch that are struck at one end of them come to bear force by one contact a
/// solve; blows that rebound run through them from contact to contact, there and back, as through
/// Newton's cradle. Contacts that are too many let go again.
bool spread_blow(PartSystem& s, const SolveScratch& set) {
  constexpr double rebound = 2.0;  // of the impulse that stops an approach: without loss
  const double least = tolerances(s, set).speed;
  bool any = false;
  const auto strike = [&](int r) {
    Row& row = at(s.rows, r);
    if (row.kind != RowKind::normal || row.idle || row.diagonal == 0.0) return;
    const double speed = row_speed(s, index(r));
    if (speed >= -least) return;
    push(s, index(r), -rebound * speed / row.diagonal);
    any = any || !row.on;
    row.on = true;
  };
  const int rows = static_cast<int>(s.rows.size());
  for (int r = s.first_contact_row; r < rows; ++r) strike(r);
  for (int r = rows - 1; r >= s.first_contact_row; --r) strike(r);
  return any;
}

/// Friction of bare surfaces that has changed in this step is left out of it: sticking may
/// contradict what cables and contacts ask of the same bodies, but frictionless they can always be
/// met.
void drop_friction(PartSystem& s) {
  for (Friction& friction : s.frictions) {
    const bool bare = at(s.rows, friction.row).kind == RowKind::tangent;
    if (bare && friction.frozen) friction.dropped = true;
  }
}

/// Nothing slides, until it is contradicted: another guess to start from.
void stick_friction(PartSystem& s, CapstanScratch& capstan) {
  for (Row& row : s.rows) {
    if (is_friction(row)) row.slip = Slip::stick;
  }
  for (Run& run : capstan.runs) {
    if (!run.frictionless) run.slip = Slip::stick;
  }
  stick_rubbing(s);
}

/// On a smooth body cable that is slack on one side of what presses it can only be pulled by the
/// other: where that would push it, and gets slack and taut by turns, it is as slack as the first.
void let_go(const PartSystem& s, CapstanScratch& capstan) {
  for (Run& run : capstan.runs) {
    const bool turns = at(s.rows, run.row_in).flipped > 0 || at(s.rows, run.row_out).flipped > 0;
    run.lets_go = run.frictionless && turns;
  }
}

/// Everything that friction has changed in this step sticks for the rest of it. Sticking neither
/// makes energy nor moves material; only the bound on its force is exceeded, for one step.
void freeze_friction(PartSystem& s, CapstanScratch& capstan) {
  for (Friction& friction : s.frictions) {
    Row& row = at(s.rows, friction.row);
    if (row.flipped == 0) continue;
    row.slip = Slip::stick;
    friction.frozen = true;
  }
  for (Run& run : capstan.runs) {
    if (run.frictionless || run.flipped == 0) continue;
    run.slip = Slip::stick;
    run.frozen = true;
  }
  freeze_rubbing(s);
}

/// Whether all that bears a force, for these states, holds both ways or pulls or pushes, by an
/// impulse of its own, no friction has changed its state in this step, which has remedies of its
/// own, and there is no more than a fallback should take on.
bool suits_dual(const PartSystem& s, const CapstanScratch& capstan) {
  // Its work is that of a full basis, the cube of their number, where a guess costs about their
  // number: of 300, 3e7 operations, some hundredths of a second.
  constexpr std::size_t most_rows = 300;
  if (s.rows.size() > most_rows) return false;
  // A motor that winds in what hardly can give is to stall (motors.h): held exactly it throws that.
  if (!s.motors.empty()) return false;
  const auto slides = [](const Run& run) {
    return run.frictionless || run.flipped > 0 || run.slip != Slip::stick;
  };
  const auto rubs = [&s](int number) {
    const Row& row = at(s.rows, number);
    return row.flipped > 0 || (row.on && row.slip != Slip::stick);
  };
  return std::ranges::none_of(capstan.runs, slides) &&
         std::ranges::none_of(
             s.sleeves,
             [&rubs](const SleevePlace& one) { return one.rub >= 0 && rubs(one.rub); }) &&
         std::ranges::none_of(s.frictions, [&rubs](const Friction& friction) {
           return friction.repeats >= 0 || rubs(friction.row);
         });
}

/// Solves for which unilateral rows bear a force too; whether it has. What then contradicts others
/// is no state to flip, but no solution either.
bool solve_for_rows(PartSystem& s, SolveScratch& set) {
  // Where events are not located, constraints bear force early, whatever they then contradict.
  if (set.reach == infinity || !suits_dual(s, set.capstan)) return false;
  double missed = 0.0;
  const DualTerms terms{set.step_length, tolerances(s, set).speed, set.repairs};
  if (!solve_dual(s, set.dual, terms, missed)) return false;
  set.direct = set.contradicts = false;
  set.by_dual = true;
  set.suspicious = true;
  set.left_out = missed * set.step_length > s.reach;
  check(s, set);
  std::erase_if(set.flips, [&set](const Flip& flip) {
    const DualScratch& dual = set.dual;
    return !flip.is_run && (at(dual.skipped, flip.row) || at(dual.unbiased, flip.row));
  });
  return true;
}

/// Bounds friction anew for the states that there are, no higher than now with `lowers`; whether
/// all of it stays as it was.
bool bounds_stand(PartSystem& s, SolveScratch& set, bool lowers) {
  std::vector<double>& before = set.bounds;
  const auto list = [&s](auto take) {
    for (const Friction& friction : s.frictions) {
      take(at(s.rows, friction.row).on ? friction.bound : -1.0);
    }
    for (const int r : s.pressed) take(at(s.rows, r).clamped ? 1.0 : 0.0);
  };
  before.clear();
  list([&before](double bound) { before.push_back(bound); });
  bound_friction(s, set);
  clamp_pinches(s);
  std::size_t k = 0;
  for (Friction& friction : s.frictions) {
    const double bound = before[k++];
    if (lowers && bound >= 0.0) friction.bound = std::min(friction.bound, bound);
  }
  k = 0;
  bool same = true;
  list([&](double bound) { same = same && bound == before[k++]; });
  return same;
}

/// Lets sleeves bear friction that did not, where the solution presses them; whether there are any.
bool presses_others(PartSystem& s, SolveScratch& set) {
  set.flips.clear();
  if (s.sleeves.empty()) return false;
  const Tolerances least = tolerances(s, set);
  check_rubbing(s, set, std::max(least.speed, s.reach / set.step_length), least.impulse);
  std::erase_if(set.flips, [&s](const Flip& flip) { return at(s.rows, flip.row).on; });
  for (const Flip& flip : set.flips) apply(s, set, flip);
  return !set.flips.empty();
}

/// Solves for all states at once; whether it has.
bool solve_for_all(PartSystem& s, SolveScratch& set) {
  // Of friction, which each solution may change. That of slack cable in a pinch has another bound
  // than that of taut cable, and where neither makes of the cable what it is for the lower holds.
  constexpr int most_bounds = 6, before_lowering = 2;
  for (int k = 0; k < most_bounds; ++k) {
    if (!solve_complementary(s, set)) return false;
    const bool stand = bounds_stand(s, set, k >= before_lowering);
    if (presses_others(s, set) || !stand) continue;
    if (set.left_out) return true;
    // What these states have for a solution is exact, but may be another where there are several.
    solve_for_states(s, set);
    check(s, set);
    if (!set.flips.empty()) take_complementary(s, set);
    return true;
  }
  return false;
}

/// Flips states until the solution contradicts none; whether it came to that.
bool settle(PartSystem& s, SolveScratch& set) {
  // All contradicted states flip while that makes progress, then one at a time. Remedies come in
  // the order of what they give up: time, what has slid so far, of several solutions the nearest,
  // sliding for the whole step, friction, the solution. After each some states may flip and settle.
  // Where cable comes to slide over many bodies each of them asks for the next, from either end on.
  constexpr int patience = 3, before_dual = 8, few_runs = 10;
  const int more = 2 * std::max(static_cast<int>(set.capstan.runs.size()) - few_runs, 0);
  const int before_sticking = 20 + more, before_freezing = 50 + more, before_dropping = 80 + more,
            most_solves = 150 + more;
  const std::size_t all = s.rows.size() + set.capstan.runs.size() + 1;
  std::size_t fewest = all;
  int left = patience;
  int growing = 0, reached = 0;  // solves in succession that ask for more force only, and before
  bool spread = false;
  for (int solves = 1; solves <= most_solves; ++solves) {
    if (solves == before_sticking) {
      stick_friction(s, set.capstan);
      let_go(s, set.capstan);
      fewest = all;
      left = patience;
    }
    if (solves == before_freezing) {
      if (solve_for_all(s, set)) return true;
      freeze_friction(s, set.capstan);
      set.froze = true;
    }
    if (solves == before_dropping) drop_friction(s);
    bound_friction(s, set);
    clamp_pinches(s);
    if (!s.sleeves.empty()) drop_rubbing(s);
    set.solves = solves;
    if (solves <= before_dual || !solve_for_rows(s, set)) {
      set.by_dual = false;
      solve_for_states(s, set);
      check(s, set);
    }
    if (set.flips.empty() || clear_rounding(s, set)) return true;
    growing = only_grows(set) ? growing + 1 : 0;
    if (growing > patience && !spread) {
      spread_tautness(s, set, 1 << std::min(growing - patience, 20));
      if (spread_blow(s, set)) {
        fewest = all;
        left = patience;
      }
    } else if (growing == 0 && reached > patience) {
      spread = true;
    }
    reached = growing;
    const bool progress = set.flips.size() < fewest;
    left = progress ? patience : left - 1;
    fewest = std::min(fewest, set.flips.size());
    if (left > 0) {
      for (const Flip& flip : set.flips) apply(s, set, flip);
    } else {
      apply(s, set, choose_flip(set, solves));
    }
  }
  return false;
}

}  // namespace

bool solve_direct(const World& world, const Parts& parts, const Part& part, PartSystem& s,
                  SolveScratch& set) {
  set.solves = 0;
  set.froze = set.left_out = set.contradicts = false;
  set.direct = set.by_dual = set.swept = false;
  set.capstan.runs.clear();
  if (s.rows.empty()) {
    s.velocity = s.free_velocity;
    return true;
  }
  order_rows(s, set.ordering);
  find_runs(world, parts, part, s, set);
  if (!settle(s, set)) sweep_rows(s, set);
  if (set.suspicious) clear_negative(s);
  return !set.froze && !set.left_out;
}

bool solve_again(const World& world, const Parts& parts, const Part& part, PartSystem& s,
                 SolveScratch& set) {
  if (set.direct && !set.froze) {
    correct_solution(s, set);
    check(s, set);
    if (set.flips.empty()) {
      if (set.suspicious) clear_negative(s);
      return true;
    }
  }
  forget_flips(s);
  return solve_direct(world, parts, part, s, set);
}

}  // namespace pinchlab
