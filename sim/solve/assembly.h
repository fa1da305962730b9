// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The linear complementarity problem of a part (complementary.h), from its rows and runs to their
// solution and back. All sums are of extended numbers; what goes into them are doubles.

#include "base/at.h"
#include "sim/solve/capstan.h"
#include "sim/solve/lemke.h"
#include "sim/solve/part_system.h"
#include "sim/solve/solve_scratch.h"

namespace pinchlab {

/// On the way to a solution what nearly contradicts itself yields, as if every bound gave by this
/// share of what its own impulse or sliding does to it: so every problem has one, and no pivot is
/// so small that little is left of 32 digits. Cable that bends by less than the root of this (rad)
/// is straight there.
constexpr double yielding = 1e-12;

/// Assembles the problem in units in which its diagonals are about 1: with those of the rows u^2 g,
/// speeds in 1 / u and impulses in u g.
class Assembly {
 public:
  Assembly(PartSystem& s, SolveScratch& set)
      : s_(s), set_(set), scratch_(set.complementary), problem_(set.complementary.problem) {}

  void list();
  void number();
  void assemble();
  bool holds(double round_off, double share);
  bool gives_way(double round_off, double share) const;
  void clear_rounding(double round_off);
  void find_values();
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

  Extended value(int unknown) const { return unit(unknown) * at(problem_.z, unknown); }

  void append(Unknown kind, double unit) {
    scratch_.kinds.push_back(kind);
    scratch_.units.push_back(unit);
  }

  bool is_out_of_reach(const Row& row, bool beside_run) const;
  bool is_frozen(int rub) const;
  bool takes_part(int row, bool beside_run) const;
  void add(int equation, int unknown, const Extended& coefficient) {
    problem_.entry(equation, unknown) += scale(equation) * unit(unknown) * coefficient;
  }
  void add_speed_to(int row, int unknown, double coefficient) {
    for_shares(row, [&](const Share& e) { add(e.unknown, unknown, e.coefficient * coefficient); });
  }
  void add_run(const Run& run, int number, int column);
  void add_law(const Run& run, int way, int equation);
  void add_sleeve(const SleevePlace& one, int column);

  /// Calls `take` with the place of each body that a row sees, and what it sees of it.
  template <typename Take>
  void for_bodies(int row, Take take) const {
    const RowBodies& bodies = at(s_.bodies, row);
    take(bodies.a, bodies.ja);
    take(bodies.b, bodies.jb);
    if (const ThirdBody* third = third_of(s_, index(row))) take(third->place, third->j);
  }

  Extended coupling(int row, int other) const;
  void start();
  void push(int row, const Extended& impulse);
  Extended speed_of(int row) const;
  Extended sliding_beside(const Row& row) const;
  Extended impulse_of(int row) const { return row >= 0 ? at(scratch_.impulses, row) : Extended(); }
  double allowed(std::size_t unknown, double round_off) const;
  Extended friction_of(const SleevePlace& one, Slip way);
  Extended tension_after(const Run& run, int way) const;
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
  double greatest_ = 0.0;  // of the impulses that were found
};

}  // namespace pinchlab
