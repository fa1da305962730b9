// SPDX-License-Identifier: GPL-3.0-or-later
// Sliding speeds: where nothing stretches, what the rows leave over; of elastic cables, what
// balances their tensions.
#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/solve/capstan.h"
#include "sim/solve/solve_scratch.h"

namespace pinchlab {

namespace {

/// The row of a middle body that sticks on a run, whose sliding speed is then the opposite of that
/// row's; or -1.
int sticking_middle(const SolveScratch& set, const Run& run) {
  for (int k = run.passages_begin; k < run.passages_end; ++k) {
    const int middle = at(set.capstan.passages, k).middle;
    if (middle >= 0 && at(set.unknown_of_row, middle) >= 0) return middle;
  }
  return -1;
}

/// A member's row speed: of an elastic one, for its tension at the interval's end.
double member_speed(const PartSystem& system, int number) {
  const Row& row = at(system.rows, number);
  if (system.elastic_ends.empty() || at(system.elastic_ends, number).compliance == 0.0) {
    return row.speed;
  }
  const ElasticEnd& end = at(system.elastic_ends, number);
  return row_speed(system, index(number)) - row.bias + end.bias + end.compliance * row.impulse;
}

/// Changes the tensions at the interval's end of members begin .. end - 1, each by its factor times
/// the same, so that what slides grows from `entering` to `leaving` (m/s) along them.
void balance(const PartSystem& system, CapstanScratch& s, int begin, int end, double entering,
             double leaving) {
  double speed = 0.0, compliance = 0.0;
  for (int m = begin; m < end; ++m) {
    speed += at(s.speeds, m);
    compliance += at(system.elastic_ends, at(s.members, m)).compliance * at(s.factors, m);
  }
  if (compliance == 0.0) return;
  const double change = (leaving - entering - speed) / compliance;
  for (int m = begin; m < end; ++m) {
    const int number = at(s.members, m);
    const double here = change * at(s.factors, m);
    at(s.speeds, m) += at(system.elastic_ends, number).compliance * here;
    double& impulse = at(s.end_impulse, number);
    impulse = std::max(0.0, impulse + here);
  }
}

/// The same for a group all of which bears tension, from one place to the next where it is known
/// what slides.
void balance(const PartSystem& system, SolveScratch& set, const Group& group) {
  CapstanScratch& s = set.capstan;
  s.factors.resize(s.members.size());
  int begin = group.begin;
  double factor = 1.0, entering = 0.0;
  for (int m = group.begin; m < group.end; ++m) {
    if (m > group.begin) {
      const Run& run = at(s.runs, at(s.member_runs, m));
      if (const int middle = sticking_middle(set, run); middle >= 0) {
        const double leaving = -at(system.rows, middle).speed;
        balance(system, s, begin, m, entering, leaving);
        begin = m;
        entering = leaving;
        factor = 1.0;
      } else {
        for (int k = run.passages_begin; k < run.passages_end; ++k) {
          factor *= sliding_terms(at(s.passages, k), sign(run.slip)).before;
        }
      }
    }
    at(s.factors, m) = factor;
  }
  balance(system, s, begin, group.end, entering, 0.0);
}

/// Whether a group stretches, in an interval too short to tell by how much: it slides in the next.
bool is_waiting(const PartSystem& system, const CapstanScratch& s, const Group& group) {
  const int first = at(s.members, group.begin);
  return system.stretch_waits && at(system.elastic_ends, first).compliance > 0.0;
}

/// Lets slack cable go with the middle body of a pinch that holds it more than the wrapped one.
void follow_middles(const PartSystem& system, CapstanScratch& s) {
  for (const Friction& friction : system.frictions) {
    if (friction.run < 0 || friction.coefficient <= friction.wrapped) continue;
    const Row& row = at(system.rows, friction.row);
    if (row.kind != RowKind::pinch_middle) continue;
    if (friction.normal >= 0 && !at(system.rows, friction.normal).on) continue;
    Run& run = at(s.runs, friction.run);
    if (at(system.rows, run.row_in).on || at(system.rows, run.row_out).on || run.follows) continue;
    run.follows = true;
    run.speed = row.bias - row.speed;
  }
}

}  // namespace

void slip_speeds(const PartSystem& system, SolveScratch& set) {
  CapstanScratch& s = set.capstan;
  for (Run& run : s.runs) {
    run.speed = 0.0;
    run.follows = false;
  }
  s.speeds.resize(s.members.size());
  s.end_impulse.clear();
  const bool elastic = !system.elastic_ends.empty();
  if (elastic) {
    for (const Row& row : system.rows) s.end_impulse.push_back(row.impulse);
  }
  for (const Group& group : s.groups) {
    double spare = 0.0, short_of = 0.0, total = 0.0;
    bool tension = false;
    for (int m = group.begin; m < group.end; ++m) {
      const int number = at(s.members, m);
      at(s.speeds, m) = member_speed(system, number);
      tension = tension || bears(at(system.rows, number), 0.0);
    }
    if (elastic && tension && is_waiting(system, s, group)) continue;
    if (elastic && group.slack < 0) balance(system, set, group);
    for (int m = group.begin; m < group.end; ++m) {
      const double w = at(s.speeds, m);
      total += w;
      (w > 0.0 ? spare : short_of) += std::abs(w);
    }
    // A group without tension moves material only to segments that would be taut, from those that
    // have some to spare, in proportion.
    const bool share = group.slack >= 0 && !tension;
    if (share && short_of == 0.0) continue;
    double sum = 0.0;
    for (int m = group.begin; m < group.end; ++m) {
      if (const int number = at(s.member_runs, m); number >= 0) {
        Run& run = at(s.runs, number);
        // Beside slack cable what slides goes as fast as a middle body that rolls with it.
        const int middle = elastic && tension ? sticking_middle(set, run) : -1;
        if (middle >= 0) sum = -at(system.rows, middle).speed;
        run.speed = sum;
      }
      const double w = at(s.speeds, m);
      double left_over = 0.0;
      if (share) {
        left_over = spare > 0.0 ? std::max(w, 0.0) * total / spare : 0.0;
      } else if (m == group.slack) {
        left_over = total;
      }
      sum += w - left_over;
    }
  }
  follow_middles(system, s);
}

}  // namespace pinchlab
