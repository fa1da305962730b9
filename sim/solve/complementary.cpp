// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/complementary.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/at.h"
#include "sim/solve/capstan.h"
#include "sim/solve/lemke.h"
#include "sim/solve/part_system.h"
#include "sim/solve/rubbing.h"
#include "sim/solve/solve_scratch.h"
#include "sim/solve/system.h"

namespace pinchlab {

namespace {

/// A run of which it is asked whether it slides.
bool may_slide(const Run& run) {
  return run.passages_begin != run.passages_end && !run.frozen;
}

/// Whether friction bears by a bound, which is not nothing.
bool is_bounded(const Friction& friction) {
  return friction.bound > 0.0 && friction.bound < infinity && !friction.dropped &&
         !friction.frozen && friction.repeats < 0;
}

/// m/s that row r gains a N s on row q.
double coupling(const PartSystem& s, std::size_t r, std::size_t q) {
  const RowBodies& row = s.bodies[r];
  const RowResponse& other = s.responses[q];
  const ThirdBody *third = third_of(s, r), *other_third = third_of(s, q);
  double gained = 0.0;
  const auto meet = [&gained](int place, const Eigen::Vector3d& j, int other_place,
                              const Eigen::Vector3d& response) {
    if (place == other_place) gained += dot(j, response);
  };
  const auto see = [&](int place, const Eigen::Vector3d& j) {
    meet(place, j, other.a, other.ra);
    meet(place, j, other.b, other.rb);
    if (other_third) meet(place, j, other_third->place, other_third->response);
  };
  see(row.a, row.ja);
  see(row.b, row.jb);
  if (third) see(third->place, third->j);
  return gained;
}

/// A power of two near 1 / sqrt(ratio), so that units of length and mass change no digit.
double unit_of(double ratio) {
  int exponent = 0;
  std::frexp(ratio, &exponent);
  return std::ldexp(1.0, -static_cast<int>(std::floor(0.5 * exponent)));
}

/// Assembles the problem in units in which its diagonals are about 1: with those of the rows u^2 g,
/// speeds in 1 / u and impulses in u g.
class Assembly {
 public:
  Assembly(PartSystem& s, SolveScratch& set)
      : s_(s), set_(set), scratch_(set.complementary), problem_(set.complementary.problem) {}

  void list();
  void number();
  void assemble();
  void allow(double round_off);
  bool refine(double round_off);
  void clear_rounding(double round_off);
  void set_values();
  void set_states();

 private:
  /// An impulse as a sum of unknowns, or what of the rows an equation sees.
  struct Share {
    int unknown;
    double coefficient;
  };

  int column_of(int row) const { return row >= 0 ? at(scratch_.column_of_row, row) : -1; }

  /// Calls `take` with the unknowns of a row's impulse.
  template <typename Take>
  void for_shares(int row, Take take) const {
    const int column = column_of(row);
    if (column < 0) return;
    const bool bounded = at(scratch_.kinds, column) == Unknown::friction;
    const double way = bounded ? at(scratch_.ways, row) : 1.0;
    take(Share{column, way});
    if (bounded) take(Share{column + 1, -way});
  }

  bool is_impulse(int unknown) const { return at(scratch_.kinds, unknown) < Unknown::sliding; }

  /// What an unknown's own unit is, in m/s or N s.
  double unit(int unknown) const {
    const double u = at(scratch_.units, unknown);
    return is_impulse(unknown) ? u * scratch_.impulse_unit : 1.0 / u;
  }

  /// What a m/s, or a N s, is in the unit of an unknown's condition.
  double scale(int equation) const {
    const double u = at(scratch_.units, equation);
    return is_impulse(equation) ? u : 1.0 / (u * scratch_.impulse_unit);
  }

  double value(int unknown) const { return unit(unknown) * at(problem_.z, unknown); }

  void append(Unknown kind, double unit) {
    scratch_.kinds.push_back(kind);
    scratch_.units.push_back(unit);
  }

  bool is_out_of_reach(const Row& row, bool beside_run) const;
  bool is_frozen(int rub) const;
  bool takes_part(int row, bool beside_run) const;
  void add(int equation, int unknown, double coefficient) {
    problem_.entry(equation, unknown) += scale(equation) * coefficient * unit(unknown);
  }
  void add_speed_to(int row, int unknown, double coefficient) {
    for_shares(row, [&](const Share& e) { add(e.unknown, unknown, e.coefficient * coefficient); });
  }
  void add_run(const Run& run, int number, int column);
  void add_law(const Run& run, int way, int equation);
  void add_sleeve(const SleevePlace& one, int column);
  void find_speeds();

  /// Calls `take` with each sleeve that may slip and the first of its unknowns.
  template <typename Take>
  void for_sleeves(Take take) const {
    for (const SleevePlace& one : s_.sleeves) {
      const int column = column_of(one.rub);
      if (column >= 0 && at(scratch_.kinds, column) == Unknown::rubbing) take(one, column);
    }
  }

  /// Calls `take` with each run that may slide and the first of its unknowns.
  template <typename Take>
  void for_runs(Take take) {
    for (const int k : scratch_.runs) take(at(set_.capstan.runs, k), at(scratch_.column_of_run, k));
  }

  PartSystem& s_;
  SolveScratch& set_;
  ComplementaryScratch& scratch_;
  Complementarity& problem_;
};

/// Whether the sleeve sticks for this step, whose friction the row is.
bool Assembly::is_frozen(int rub) const {
  return std::ranges::any_of(
      s_.sleeves, [rub](const SleevePlace& one) { return one.rub == rub && one.frozen; });
}

/// What segments between sliding runs have left is their group's: one that is within reach may
/// have members that are a little beyond.
bool Assembly::is_out_of_reach(const Row& row, bool beside_run) const {
  constexpr double beyond = 100.0;
  if (!row.idle) return false;
  return !beside_run || row.clearance <= set_.reach || row.clearance > beyond * set_.reach;
}

bool Assembly::takes_part(int number, bool beside_run) const {
  const Row& row = at(s_.rows, number);
  if (is_out_of_reach(row, beside_run)) return false;
  const bool gives = row.diagonal + row.compliance > 0.0;
  if (is_friction(row)) {
    const Friction& friction = at(s_.frictions, row.friction);
    if (is_bounded(friction)) return gives && column_of(friction.normal) >= 0;
    return gives && row.on && friction.repeats < 0;
  }
  return is_unilateral(row) ? gives || beside_run : gives && row.on;
}

/// The rows and runs that take part, each in an order that does not depend on which comes first in
/// the scene: where ties leave a choice it falls alike.
void Assembly::list() {
  const std::size_t rows = s_.rows.size(), runs = set_.capstan.runs.size();
  scratch_.column_of_row.assign(rows, -1);
  scratch_.ways.assign(rows, 1.0);
  scratch_.column_of_run.assign(runs, -1);
  scratch_.beside_run.assign(rows, 0);
  std::vector<int>&listed = scratch_.rows, &listed_runs = scratch_.runs;
  listed.clear();
  listed_runs.clear();
  for (std::size_t k = 0; k < runs; ++k) {
    const Run& run = set_.capstan.runs[k];
    if (!may_slide(run)) continue;
    listed_runs.push_back(static_cast<int>(k));
    at(scratch_.beside_run, run.row_in) = at(scratch_.beside_run, run.row_out) = 1;
  }
  for (const bool friction : {false, true}) {  // which takes part where what presses does
    for (int r = 0; index(r) < rows; ++r) {
      if (is_friction(at(s_.rows, r)) != friction) continue;
      if (!takes_part(r, at(scratch_.beside_run, r) != 0)) continue;
      listed.push_back(r);
      at(scratch_.column_of_row, r) = 0;  // for now
    }
  }
  const auto gives = [this](int r) { return at(s_.rows, r).diagonal + at(s_.rows, r).compliance; };
  s_.velocity = s_.free_velocity;
  const auto speed = [this](int r) { return row_speed(s_, index(r)) - at(s_.rows, r).bias; };
  const auto row_key = [&](int r) { return std::tuple(gives(r), speed(r), r); };
  const auto run_key = [&](int k) {
    const int in = at(set_.capstan.runs, k).row_in, out = at(set_.capstan.runs, k).row_out;
    return std::tuple(gives(in), gives(out), speed(in), speed(out), k);
  };
  std::ranges::sort(listed, {}, row_key);
  std::ranges::sort(listed_runs, {}, run_key);
}

/// Unknowns of rows, then of runs.
void Assembly::number() {
  scratch_.kinds.clear();
  scratch_.units.clear();
  double most = 0.0;
  for (const Row& row : s_.rows) most = std::max(most, row.diagonal + row.compliance);
  if (most == 0.0) most = 1.0;
  int exponent = 0;
  std::frexp(most, &exponent);
  scratch_.impulse_unit = std::ldexp(1.0, -exponent);
  const auto unit_of_row = [&](int r) {
    const double diagonal = at(s_.rows, r).diagonal + at(s_.rows, r).compliance;
    return diagonal > 0.0 ? unit_of(diagonal / most) : 1.0;
  };
  for (const int r : scratch_.rows) {
    const Row& row = at(s_.rows, r);
    at(scratch_.column_of_row, r) = static_cast<int>(scratch_.kinds.size());
    const double unit = unit_of_row(r);
    if (is_friction(row) && is_bounded(at(s_.frictions, row.friction))) {
      at(scratch_.ways, r) = row_speed(s_, index(r)) < 0.0 ? -1.0 : 1.0;
      append(Unknown::friction, unit);
      append(Unknown::friction_against, unit);
      append(Unknown::sliding, unit);
    } else if (row.kind == RowKind::sleeve_rub && !is_frozen(r)) {
      append(Unknown::rubbing, unit);
      append(Unknown::forward, unit);
      append(Unknown::backward, unit);
    } else {
      append(is_unilateral(row) ? Unknown::unilateral : Unknown::either, unit);
    }
  }
  for (const int k : scratch_.runs) {
    const Run& run = at(set_.capstan.runs, k);
    at(scratch_.column_of_run, k) = static_cast<int>(scratch_.kinds.size());
    const double unit = std::max(unit_of_row(run.row_in), unit_of_row(run.row_out));
    append(Unknown::forward, unit);
    append(Unknown::backward, unit);
  }
}

/// That tension after the run is within its limit, where it slides `way`.
void Assembly::add_law(const Run& run, int way, int equation) {
  std::vector<Term>& limit = scratch_.limit;  // of rows' impulses
  limit.clear();
  limit.push_back({run.row_in, 1.0});
  for (int k = run.passages_begin; k < run.passages_end; ++k) {
    const Passage& passage = at(set_.capstan.passages, k);
    const SlidingTerms terms = sliding_terms(passage, way);
    for (Term& term : limit) term.coefficient *= terms.before;
    if (passage.normal >= 0) limit.push_back({passage.normal, terms.pressed});
    if (passage.middle >= 0) limit.push_back({passage.middle, -1.0});
  }
  limit.push_back({run.row_out, -1.0});
  for (const Term& term : limit) {
    for_shares(term.index, [&](const Share& p) {
      add(equation, p.unknown, way * term.coefficient * p.coefficient);
    });
  }
}

void Assembly::add_run(const Run& run, int number, int column) {
  for (const int way : {1, -1}) {
    const int unknown = way > 0 ? column : column + 1;
    add_speed_to(run.row_in, unknown, -way);
    add_speed_to(run.row_out, unknown, way);
    for (const Friction& friction : s_.frictions) {
      if (friction.run == number) add_speed_to(friction.row, unknown, way);
    }
    add_law(run, way, unknown);
  }
}

/// Friction p holds the sleeve as long as it is more than -f of slipping forward, and less than
/// that of slipping backward.
void Assembly::add_sleeve(const SleevePlace& one, int column) {
  for (const Slip slip : {Slip::forward, Slip::backward}) {
    const int way = sign(slip);
    const int sliding = way > 0 ? column + 1 : column + 2;
    add(column, sliding, -way);
    add(sliding, column, way);
    at(problem_.q, sliding) +=
        scale(sliding) * way * list_friction(s_, one, slip, set_.friction_terms);
    for (const Term& term : set_.friction_terms) {
      for_shares(term.index, [&](const Share& p) {
        add(sliding, p.unknown, way * term.coefficient * p.coefficient);
      });
    }
  }
}

void Assembly::assemble() {
  problem_.begin(static_cast<int>(scratch_.kinds.size()));
  for (const int r : scratch_.rows) {
    const int column = column_of(r);
    const Row& row = at(s_.rows, r);
    for_shares(r, [&](const Share& e) {
      at(problem_.q, e.unknown) += scale(e.unknown) * e.coefficient * row_speed(s_, index(r));
    });
    for (const int q : scratch_.rows) {
      double gained = coupling(s_, index(r), index(q));
      if (q == r) gained += row.compliance;
      if (gained == 0.0) continue;
      for_shares(r, [&](const Share& e) {
        for_shares(q, [&](const Share& p) {
          add(e.unknown, p.unknown, e.coefficient * p.coefficient * gained);
        });
      });
    }
    const Unknown kind = at(scratch_.kinds, column);
    at(problem_.either, column) = kind == Unknown::either || kind == Unknown::rubbing;
    if (kind != Unknown::friction) continue;
    const Friction& friction = at(s_.frictions, row.friction);
    const int sliding = column + 2;
    for (const int k : {column, column + 1}) {
      add(k, sliding, 1.0);
      add(sliding, k, -1.0);
    }
    for_shares(friction.normal,
               [&](const Share& p) { add(sliding, p.unknown, friction.bound * p.coefficient); });
  }
  for_sleeves([this](const SleevePlace& one, int column) { add_sleeve(one, column); });
  const Run* const first = set_.capstan.runs.data();
  for_runs(
      [&](const Run& run, int column) { add_run(run, static_cast<int>(&run - first), column); });
}

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
