// SPDX-License-Identifier: GPL-3.0-or-later
// The problem of what there is: its unknowns, its matrix and its right side.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "sim/solve/assembly.h"
#include "sim/solve/rubbing.h"

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

/// What an impulse of 1 N s on what a row sees of a body does to its velocity.
ExtendedVelocity response(const Mobility& m, const Eigen::Vector3d& j) {
  const Extended x = j.x(), y = j.y(), turning = j.z();
  return {m.xx * x + m.xy * y + m.xz * turning, m.xy * x + m.yy * y + m.yz * turning,
          m.xz * x + m.yz * y + m.angular * turning};
}

Extended dot(const Eigen::Vector3d& j, const ExtendedVelocity& v) {
  return j.x() * v.x + j.y() * v.y + j.z() * v.turning;
}

/// A power of two near 1 / sqrt(ratio), so that units of length and mass change no digit.
double unit_of(double ratio) {
  int exponent = 0;
  std::frexp(ratio, &exponent);
  return std::ldexp(1.0, -static_cast<int>(std::floor(0.5 * exponent)));
}

}  // namespace

/// m/s that a row gains by a N s on the other.
Extended Assembly::coupling(int row, int other) const {
  Extended gained;
  for_bodies(other, [&](int place, const Eigen::Vector3d& pushed) {
    for_bodies(row, [&](int seen_place, const Eigen::Vector3d& seen) {
      if (seen_place == place) gained += dot(seen, response(at(s_.mobility, place), pushed));
    });
  });
  return gained;
}

/// Velocities before impulses.
void Assembly::start() {
  scratch_.velocities.clear();
  for (const Eigen::Vector3d& v : s_.free_velocity) {
    scratch_.velocities.push_back({v.x(), v.y(), v.z()});
  }
}

void Assembly::push(int row, const Extended& impulse) {
  for_bodies(row, [&](int place, const Eigen::Vector3d& j) {
    const ExtendedVelocity gained = response(at(s_.mobility, place), j);
    ExtendedVelocity& v = at(scratch_.velocities, place);
    v.x += impulse * gained.x;
    v.y += impulse * gained.y;
    v.turning += impulse * gained.turning;
  });
}

/// J v + bias (m/s).
Extended Assembly::speed_of(int row) const {
  Extended speed = at(s_.rows, row).bias;
  for_bodies(row, [&](int place, const Eigen::Vector3d& j) {
    speed += dot(j, at(scratch_.velocities, place));
  });
  return speed;
}

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
  bool counts = gives(row);
  if (is_friction(row)) {
    const Friction& friction = at(s_.frictions, row.friction);
    // A pinch moves cable that slides beneath it by what the cable leads to (system.cpp).
    counts = counts || (friction.run >= 0 && may_slide(at(set_.capstan.runs, friction.run)));
    if (is_bounded(friction)) return counts && column_of(friction.normal) >= 0;
    return counts && row.on && friction.repeats < 0;
  }
  return is_unilateral(row) ? counts || beside_run : counts && row.on;
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
  start();
  const auto speed = [this](int r) { return (speed_of(r) - at(s_.rows, r).bias).high; };
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
      at(scratch_.ways, r) = speed_of(r) < 0.0 ? -1.0 : 1.0;
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
      at(problem_.q, e.unknown) += scale(e.unknown) * e.coefficient * speed_of(r);
    });
    for (const int q : scratch_.rows) {
      Extended gained = coupling(r, q);
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

}  // namespace pinchlab
