// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/complementary.h"

#include <algorithm>
#include <cmath>

#include "sim/solve/assembly.h"
#include "sim/solve/rubbing.h"
#include "sim/solve/system.h"

namespace pinchlab {

/// Impulses, velocities and speeds of the unknowns' values.
void Assembly::find_values() {
  std::vector<Extended>&impulses = scratch_.impulses, &speeds = scratch_.speeds;
  greatest_ = 0.0;
  for (int i = 0; i < problem_.size; ++i) {
    if (is_impulse(i)) greatest_ = std::max(greatest_, std::abs(at(problem_.z, i).high));
  }
  impulses.clear();
  start();
  for (int r = 0; index(r) < s_.rows.size(); ++r) {
    Extended impulse;
    for_shares(r, [&](const Share& p) { impulse += p.coefficient * value(p.unknown); });
    impulses.push_back(impulse);
    push(r, impulse);
  }
  speeds.clear();
  for (int r = 0; index(r) < s_.rows.size(); ++r) {
    speeds.push_back(speed_of(r) + at(s_.rows, r).compliance * at(impulses, r));
  }
}

/// Gives the system those, and its runs the speeds at which they slide.
void Assembly::set_values() {
  find_values();
  for (std::size_t r = 0; r < s_.rows.size(); ++r) {
    s_.rows[r].impulse = static_cast<double>(scratch_.impulses[r]);
    s_.rows[r].speed = static_cast<double>(scratch_.speeds[r]);
  }
  for (std::size_t b = 0; b < s_.velocity.size(); ++b) {
    const ExtendedVelocity& v = scratch_.velocities[b];
    s_.velocity[b] = {static_cast<double>(v.x), static_cast<double>(v.y),
                      static_cast<double>(v.turning)};
  }
  for_runs([&](Run& run, int column) {
    run.speed = static_cast<double>(value(column) - value(column + 1));
  });
}

/// Sliding speed over the wrapped body at a middle link's pinch.
Extended Assembly::sliding_beside(const Row& row) const {
  const int run = is_friction(row) ? at(s_.frictions, row.friction).run : -1;
  const int column = run >= 0 ? at(scratch_.column_of_run, run) : -1;
  return column >= 0 ? value(column) - value(column + 1) : Extended();
}

/// What friction on a sleeve is at most, one way.
Extended Assembly::friction_of(const SleevePlace& one, Slip way) {
  Extended friction = list_friction(s_, one, way, set_.friction_terms);
  for (const Term& term : set_.friction_terms) {
    friction += term.coefficient * impulse_of(term.index);
  }
  return friction;
}

/// Tension after a run over which the material slides `way`.
Extended Assembly::tension_after(const Run& run, int way) const {
  Extended tension = impulse_of(run.row_in);
  for (int k = run.passages_begin; k < run.passages_end; ++k) {
    const Passage& passage = at(set_.capstan.passages, k);
    const SlidingTerms terms = sliding_terms(passage, way);
    tension = terms.before * tension + terms.pressed * impulse_of(passage.normal) -
              impulse_of(passage.middle);
  }
  return tension;
}

/// w of all unknowns for those values.
void Assembly::find_speeds() {
  std::vector<Extended>& w = scratch_.w;
  w.assign(scratch_.kinds.size(), Extended());
  const auto see = [&](int row, const Extended& speed) {
    for_shares(
        row, [&](const Share& e) { at(w, e.unknown) += scale(e.unknown) * e.coefficient * speed; });
  };
  for (const int r : scratch_.rows) {
    const Row& row = at(s_.rows, r);
    see(r, at(scratch_.speeds, r) + sliding_beside(row));
    const int column = column_of(r);
    if (at(scratch_.kinds, column) != Unknown::friction) continue;
    const Friction& friction = at(s_.frictions, row.friction);
    const int sliding = column + 2;
    for (const int k : {column, column + 1}) {
      at(w, k) += scale(k) * value(sliding);
      at(w, sliding) -= scale(sliding) * value(k);
    }
    at(w, sliding) += scale(sliding) * friction.bound * impulse_of(friction.normal);
  }
  for_sleeves([&](const SleevePlace& one, int column) {
    see(one.rub, value(column + 2) - value(column + 1));
    for (const Slip slip : {Slip::forward, Slip::backward}) {
      const int equation = slip == Slip::forward ? column + 1 : column + 2;
      at(w, equation) =
          scale(equation) * sign(slip) * (impulse_of(one.rub) + friction_of(one, slip));
    }
  });
  for_runs([&](const Run& run, int column) {
    const Extended speed = value(column) - value(column + 1);
    see(run.row_in, -speed);
    see(run.row_out, speed);
    for (const int way : {1, -1}) {
      const int equation = way > 0 ? column : column + 1;
      at(w, equation) = scale(equation) * way * (tension_after(run, way) - impulse_of(run.row_out));
    }
  });
}

/// What a condition may miss by round-off, where speeds are known to `round_off` (m/s); an impulse
/// counts by the speed that it gives its own row.
double Assembly::allowed(std::size_t unknown, double round_off) const {
  constexpr double rounding = 1e-10;  // of impulses, which doubles are to hold
  const double least = round_off * scratch_.units[unknown];
  return scratch_.kinds[unknown] < Unknown::sliding ? least : least + rounding * greatest_;
}

/// Whether those values are what was asked for, where all yields by that share: speeds by as much
/// as that comes to, the laws of friction by round-off at most.
bool Assembly::holds(double round_off, double share) {
  find_values();
  find_speeds();
  for (std::size_t i = 0; i < scratch_.w.size(); ++i) {
    const Extended& z = problem_.z[i];
    const double w = (scratch_.w[i] + share * z).high, most = allowed(i, round_off);
    if (problem_.bears[i] != 0 ? std::abs(w) > most : w < -most) return false;
    if (problem_.either[i] == 0 && z.high < -most) return false;
    if (scratch_.kinds[i] >= Unknown::sliding && share * z.high > most) return false;
  }
  return true;
}

/// Whether speeds yield by more than round-off then.
bool Assembly::gives_way(double round_off, double share) const {
  for (std::size_t i = 0; i < scratch_.w.size(); ++i) {
    if (share * std::abs(problem_.z[i].high) > allowed(i, round_off)) return true;
  }
  return false;
}

/// Leaves no pull or push by which its own row's speed changes by less than `round_off` (m/s).
void Assembly::clear_rounding(double round_off) {
  for (std::size_t i = 0; i < scratch_.kinds.size(); ++i) {
    if (scratch_.kinds[i] != Unknown::unilateral) continue;
    if (problem_.z[i].high <= round_off * scratch_.units[i]) problem_.z[i] = 0.0;
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
      if (row.kind == RowKind::normal && bears(column) && !row.on && row.flipped > 0) {
        row.returned = true;
      }
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

/// Whether there is nothing but what the conditions above are of.
bool suits(const SolveScratch& set) {
  return std::ranges::none_of(set.capstan.passages,
                              [](const Passage& passage) { return passage.middle_out >= 0; });
}

/// Leaves what rows have missed by no more than `round_off` (m/s): bodies on a straight span would
/// be thrown by making up for it.
void leave_round_off(PartSystem& s, double round_off) {
  for (Row& row : s.rows) {
    if (std::abs(row.bias - row.curved) <= round_off) row.bias = row.curved;
  }
}

/// Whether impulses come to far more than the speeds that they are to change, and all but cancel
/// one another: rows nearly repeat or contradict themselves.
bool cancels(const Complementarity& problem) {
  constexpr double most = 100.0;  // of what is in touch, taut and regular it is one to three
  double asked = 0.0, come_to = 0.0;
  for (const Extended& q : problem.q) asked = std::max(asked, std::abs(q.high));
  for (const Extended& z : problem.z) come_to = std::max(come_to, std::abs(z.high));
  return come_to > most * asked;
}

bool solve_once(PartSystem& s, SolveScratch& set, double round_off) {
  Assembly assembly(s, set);
  assembly.list();
  assembly.number();
  // Pivots are about as many as unknowns, and cost the square of their number: of 200 in extended
  // numbers about a tenth of a second.
  constexpr std::size_t most_unknowns = 200;
  if (set.complementary.kinds.size() > most_unknowns) return false;
  Complementarity& problem = set.complementary.problem;
  assembly.assemble();
  problem.yielding = yielding;
  constexpr int most_cheap = 60;  // unknowns: in extended numbers a millisecond
  for (const Numbers numbers : {Numbers::doubles, Numbers::extended}) {
    if (numbers == Numbers::doubles && problem.size <= most_cheap) continue;
    if (!find_bearing(problem, numbers)) continue;
    // What bears then does so without yielding as well, unless it contradicts itself.
    for (const double share : {0.0, yielding}) {
      solve_for_bearing(problem, share);
      if (!assembly.holds(round_off, share)) continue;
      const bool gives_way = assembly.gives_way(round_off, share);
      if (numbers == Numbers::doubles && (gives_way || cancels(problem))) break;
      set.left_out = gives_way;
      return true;
    }
  }
  return false;
}

/// The laws of elastic segments that may slide for as long as it lives: those of their tensions at
/// the interval's end, from which sliding speeds follow (elastic.h).
class EndLaws {
 public:
  explicit EndLaws(PartSystem& s) : s_(s) { exchange(); }
  ~EndLaws() { exchange(); }
  EndLaws(const EndLaws&) = delete;
  EndLaws& operator=(const EndLaws&) = delete;

 private:
  void exchange() {
    for (std::size_t r = 0; r < s_.elastic_ends.size(); ++r) {
      ElasticEnd& end = s_.elastic_ends[r];
      if (end.compliance == 0.0) continue;
      std::swap(s_.rows[r].bias, end.bias);
      std::swap(s_.rows[r].compliance, end.compliance);
    }
  }

  PartSystem& s_;
};

}  // namespace

void take_complementary(PartSystem& s, SolveScratch& set) {
  const EndLaws laws(s);
  Assembly assembly(s, set);
  assembly.clear_rounding(s.reach / set.step_length);
  assembly.set_values();
  assembly.set_states();
  express_states(s, set);
  set.direct = set.by_dual = set.contradicts = false;
  set.suspicious = true;
}

bool solve_complementary(PartSystem& s, SolveScratch& set) {
  set.left_out = false;
  if (!suits(set)) return false;
  const double round_off = s.reach / set.step_length;
  {
    const EndLaws laws(s);
    leave_round_off(s, round_off);
    if (!solve_once(s, set, round_off)) return false;
  }
  take_complementary(s, set);
  return true;
}

}  // namespace pinchlab
