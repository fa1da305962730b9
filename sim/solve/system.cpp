// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/system.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/solve/capstan.h"
#include "sim/solve/repeated_rows.h"
#include "sim/solve/rubbing.h"
#include "sim/solve/solve_scratch.h"
#include "sim/solve/symmetric.h"

namespace pinchlab {

namespace {

/// Whether a row's friction may be part of a group's equation: it presses what may slide.
bool is_in_pinch(const PartSystem& s, const Row& row) {
  return row.kind == RowKind::pinch_middle ||
         (row.kind == RowKind::tangent && at(s.frictions, row.friction).run >= 0);
}

/// Whether friction holds cable that slides over the other body: then it moves what is beyond, even
/// if neither of the two bodies gives way.
bool holds_sliding(const PartSystem& s, const Row& row, const CapstanScratch& capstan) {
  if (!is_in_pinch(s, row)) return false;
  const int run = at(s.frictions, row.friction).run;
  return run >= 0 && at(capstan.runs, run).joins;
}

/// A row has an unknown of its own unless it bears nothing, slips, or follows from its group's.
bool has_unknown(const PartSystem& s, std::size_t r, bool slides, const CapstanScratch& capstan) {
  const Row& row = s.rows[r];
  if (!row.on) return false;
  if (slides && row.kind == RowKind::segment && capstan.group_of_row[r] >= 0) {
    const Group& group = at(capstan.groups, capstan.group_of_row[r]);
    return group.slack < 0 && at(capstan.members, group.begin) == static_cast<int>(r);
  }
  if (row.slip != Slip::stick) return false;
  return gives(row) || (slides && holds_sliding(s, row, capstan));
}

/// Numbers the unknowns, and tells whether each is one row's impulse: then the matrix is symmetric.
void number_unknowns(PartSystem& s, SolveScratch& set) {
  set.unknown_of_row.resize(s.rows.size());
  set.row_of_unknown.resize(s.rows.size());
  const bool slides = !set.capstan.runs.empty();
  set.symmetric = !slides;
  int count = 0;
  bool clamped = false;
  for (const int r : s.order) {
    const Row& row = at(s.rows, r);
    if (row.on && row.slip != Slip::stick) set.symmetric = false;
    const bool unknown = has_unknown(s, index(r), slides, set.capstan);
    at(set.unknown_of_row, r) = unknown ? count : -1;
    if (unknown) at(set.row_of_unknown, count++) = r;
    clamped = clamped || row.clamped;
  }
  set.row_of_unknown.resize(index(count));
  s.unsure.clear();
  if (clamped && set.symmetric) put_levers_last(s, set);
}

/// p = F z and the equations G, row by row; groups of sliding cables add theirs.
void express(PartSystem& s, SolveScratch& set) {
  const bool slides = !set.capstan.runs.empty();
  set.impulse_begin.assign(s.rows.size(), 0);
  set.impulse_end.assign(s.rows.size(), 0);
  set.impulse_terms.clear();
  set.equation_terms.clear();
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    const Row& row = s.rows[r];
    const int unknown = set.unknown_of_row[r];
    const bool grouped = slides && set.capstan.group_of_row[r] >= 0;
    set.impulse_begin[r] = static_cast<int>(set.impulse_terms.size());
    if (unknown >= 0 && !grouped) {
      set.impulse_terms.push_back({unknown, 1.0});
      const bool later = slides && is_in_pinch(s, row);
      if (!later) set.equation_terms.push_back({unknown, static_cast<int>(r), 1.0});
    } else if (row.on && row.slip != Slip::stick && row.friction >= 0) {
      // Sliding friction opposes the sliding: p = -slip * bound * normal.
      const Friction& friction = at(s.frictions, row.friction);
      const int normal = friction.normal >= 0 ? at(set.unknown_of_row, friction.normal) : -1;
      if (normal >= 0)
        set.impulse_terms.push_back({normal, -static_cast<int>(row.slip) * friction.bound});
    }
    set.impulse_end[r] = static_cast<int>(set.impulse_terms.size());
  }
  if (!slides) return;
  for (Friction& friction : s.frictions) friction.in_group_equation = false;
  express_impulses(set);
  add_group_equations(s, set);
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    if (is_in_pinch(s, s.rows[r]) && set.unknown_of_row[r] >= 0 &&
        !at(s.frictions, s.rows[r].friction).in_group_equation) {
      set.equation_terms.push_back({set.unknown_of_row[r], static_cast<int>(r), 1.0});
    }
  }
}

/// Adds coefficient * j to what the equation of `unknown` sees of a body. The terms of one equation
/// follow one another, from `begin` on: the place of the body's last term tells whether it has one.
void add_to_equation(SolveScratch& set, std::size_t begin, int unknown, int body,
                     const Eigen::Vector3d& j, double coefficient) {
  int& place = at(set.last_equation, body);
  if (place >= static_cast<int>(begin)) {
    at(set.equations, place).vector += coefficient * j;
    return;
  }
  place = static_cast<int>(set.equations.size());
  set.equations.push_back({unknown, body, coefficient * j});
}

/// Effects of unknowns on bodies, listed by body, and what each equation sees of the bodies.
void gather_body_terms(const PartSystem& s, SolveScratch& set) {
  const std::size_t bodies = s.mobility.size();
  set.columns.clear();
  set.equations.clear();
  set.last_equation.assign(bodies, -1);
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    const RowBodies& row = s.bodies[r];
    for (int k = set.impulse_begin[r]; k < set.impulse_end[r]; ++k) {
      const Term& term = at(set.impulse_terms, k);
      for (const auto& [body, j] : {std::pair(row.a, row.ja), std::pair(row.b, row.jb)}) {
        if (at(s.mobile, body)) set.columns.push_back({term.index, body, term.coefficient * j});
      }
      if (const ThirdBody* third = third_of(s, r); third && at(s.mobile, third->place)) {
        set.columns.push_back({term.index, third->place, term.coefficient * third->j});
      }
    }
  }
  std::size_t begin = 0;
  int unknown = -1;
  for (const EquationTerm& term : set.equation_terms) {
    const RowBodies& row = at(s.bodies, term.row);
    if (term.unknown != unknown) {
      unknown = term.unknown;
      begin = set.equations.size();
    }
    for (const auto& [body, j] : {std::pair(row.a, row.ja), std::pair(row.b, row.jb)}) {
      if (at(s.mobile, body)) add_to_equation(set, begin, unknown, body, j, term.coefficient);
    }
    if (const ThirdBody* third = third_of(s, index(term.row));
        third && at(s.mobile, third->place)) {
      add_to_equation(set, begin, unknown, third->place, third->j, term.coefficient);
    }
  }

  Lists<BodyTerm>& lists = set.columns_of_body;
  lists.begin.assign(bodies + 1, 0);
  for (const BodyTerm& term : set.columns) ++at(lists.begin, term.body + 1);
  for (std::size_t b = 0; b < bodies; ++b) lists.begin[b + 1] += lists.begin[b];
  lists.items.resize(set.columns.size());
  set.fill = lists.begin;
  for (const BodyTerm& term : set.columns) {
    at(lists.items, at(set.fill, term.body)++) = term;
  }
}

/// The profile: unknown u reaches back to the least one that shares a body with it.
void find_profile(const PartSystem& s, SolveScratch& set) {
  const std::size_t bodies = s.mobility.size();
  const int count = static_cast<int>(set.row_of_unknown.size());
  set.least_column.assign(bodies, count);
  set.least_equation.assign(bodies, count);
  for (const BodyTerm& t : set.columns) {
    at(set.least_column, t.body) = std::min(at(set.least_column, t.body), t.unknown);
  }
  for (const BodyTerm& t : set.equations) {
    at(set.least_equation, t.body) = std::min(at(set.least_equation, t.body), t.unknown);
  }
  set.first.resize(index(count));
  for (int u = 0; u < count; ++u) set.first[index(u)] = u;
  for (const BodyTerm& t : set.columns) {
    set.first[index(t.unknown)] =
        std::min(set.first[index(t.unknown)], at(set.least_equation, t.body));
  }
  for (const BodyTerm& t : set.equations) {
    set.first[index(t.unknown)] =
        std::min(set.first[index(t.unknown)], at(set.least_column, t.body));
  }
}

void assemble_coupled(PartSystem& s, SolveScratch& set) {
  find_profile(s, set);
  for (const EquationTerm& term : set.equation_terms) {
    for (int k = set.impulse_begin[index(term.row)]; k < set.impulse_end[index(term.row)]; ++k) {
      const int other = set.impulse_terms[index(k)].index;  // through compliance, without a body
      const auto [low, high] = std::minmax(other, term.unknown);
      set.first[index(high)] = std::min(set.first[index(high)], low);
    }
  }
  set.lu.reset(set.first);
  for (const BodyTerm& t : set.equations) {
    const Eigen::Vector3d seen = at(s.mobility, t.body) * t.vector;
    const auto& lists = set.columns_of_body;
    const std::size_t b = index(t.body);
    for (int k = lists.begin[b]; k < lists.begin[b + 1]; ++k) {
      const BodyTerm& column = lists.items[index(k)];
      set.lu.add(t.unknown, column.unknown, seen.dot(column.vector));
    }
  }
  s.scale.assign(set.row_of_unknown.size(), 0.0);
  for (const EquationTerm& term : set.equation_terms) {
    const Row& row = s.rows[index(term.row)];
    for (int k = set.impulse_begin[index(term.row)]; k < set.impulse_end[index(term.row)]; ++k) {
      const Term& impulse = set.impulse_terms[index(k)];
      const double both = term.coefficient * impulse.coefficient;
      if (row.compliance > 0.0) set.lu.add(term.unknown, impulse.index, both * row.compliance);
      if (impulse.index == term.unknown) {
        at(s.scale, term.unknown) += std::abs(both) * (row.diagonal + row.compliance);
      }
    }
  }
  for (double& scale : s.scale) {
    if (scale == 0.0) scale = 1.0;
  }
}

/// Factors the matrix, with a ridge of that share of its diagonal; returns how many rows repeat
/// others.
int factor(PartSystem& s, SolveScratch& set, double ridge) {
  if (set.symmetric && ridge == 0.0) return factor_symmetric(s, set);
  s.factored = false;
  if (set.symmetric) return s.ldl.factor(s.scale, ridge);
  s.assembled.clear();
  assemble_coupled(s, set);
  return set.lu.factor(s.scale, ridge);
}

/// Impulses of the rows for the unknowns' values, and the velocities.
void set_impulses(PartSystem& s, const SolveScratch& set) {
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    double p = 0.0;
    if (set.symmetric) {
      const int unknown = set.unknown_of_row[r];
      if (unknown >= 0) p = at(set.solution, unknown);
    } else {
      for (int k = set.impulse_begin[r]; k < set.impulse_end[r]; ++k) {
        const Term& term = at(set.impulse_terms, k);
        p += term.coefficient * at(set.solution, term.index);
      }
    }
    s.rows[r].impulse = p;
  }
  if (!set.symmetric) add_known_rubbing(s);
  apply_impulses(s);
}

double largest_of(const std::vector<double>& residuals) {
  double largest = 0.0;
  for (const double r : residuals) largest = std::max(largest, std::abs(r));
  return largest;
}

/// The rows' speeds, and what each equation misses at them; returns the largest.
double find_residuals(PartSystem& s, SolveScratch& set) {
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    Row& row = s.rows[r];
    row.speed = row_speed(s, r) + row.compliance * row.impulse;
  }
  set.residual.assign(set.row_of_unknown.size(), 0.0);
  if (set.symmetric) {
    for (std::size_t u = 0; u < set.residual.size(); ++u) {
      set.residual[u] = at(s.rows, set.row_of_unknown[u]).speed;
    }
  } else {
    for (const EquationTerm& term : set.equation_terms) {
      at(set.residual, term.unknown) += term.coefficient * at(s.rows, term.row).speed;
    }
  }
  return largest_of(set.residual);
}

/// One step of iterative refinement, and what it leaves. The residual is measured at the
/// velocities, where heavy and light bodies do not mix, so that it restores what elimination loses
/// at large mass ratios.
double refine(PartSystem& s, SolveScratch& set) {
  if (set.symmetric) {
    s.ldl.solve(set.residual);
  } else {
    set.lu.solve(set.residual);
  }
  for (std::size_t u = 0; u < set.solution.size(); ++u) set.solution[u] -= set.residual[u];
  set_impulses(s, set);
  return find_residuals(s, set);
}

/// Starts from no impulses at all; returns the largest residual.
double start(PartSystem& s, SolveScratch& set) {
  set.solution.assign(set.row_of_unknown.size(), 0.0);
  s.velocity = s.free_velocity;
  if (set.symmetric) {
    set.residual.resize(set.row_of_unknown.size());
    for (std::size_t u = 0; u < set.residual.size(); ++u) {
      set.residual[u] = row_speed(s, index(set.row_of_unknown[u]));
    }
    return largest_of(set.residual);
  }
  for (Row& row : s.rows) row.impulse = 0.0;
  if (!s.sleeves.empty()) set_impulses(s, set);
  return find_residuals(s, set);
}

/// Of all solutions of a system with repeated rows, (nearly) the one of least norm: that of the
/// system with a small ridge on its diagonal, whose right side is first made consistent by a basic
/// solution.
void spread_over_repeated_rows(PartSystem& s, SolveScratch& set, double rounding) {
  constexpr double ridge = 1e-8;  // of the diagonal: half of a double's digits are left for either
  set.right_side = set.residual;  // what a basic solution leaves of contradictory constraints
  set.contradicts = largest_of(set.right_side) * set.step_length > s.reach;
  const auto subtract_contradictions = [&set] {
    for (std::size_t u = 0; u < set.residual.size(); ++u) set.residual[u] -= set.right_side[u];
    return largest_of(set.residual);
  };
  factor(s, set, ridge);
  start(s, set);
  for (int k = 0; k < 3; ++k) {
    subtract_contradictions();
    refine(s, set);
  }
  // Beside masses that differ by more than the ridge it has not found all of the solution: the rest
  // is added without it.
  if (subtract_contradictions() <= rounding) return;
  factor(s, set, 0.0);
  refine(s, set);
  for (int k = 0; k < 2 && subtract_contradictions() > rounding; ++k) refine(s, set);
}

}  // namespace

void apply_impulses(PartSystem& s) {
  s.velocity = s.free_velocity;
  for (std::size_t r = 0; r < s.rows.size(); ++r) push(s, r, s.rows[r].impulse);
}

namespace {

/// J v + bias + compliance p of the unknowns' rows; returns the largest.
double find_missing(const PartSystem& s, SolveScratch& set) {
  double largest = 0.0;
  for (std::size_t u = 0; u < set.row_of_unknown.size(); ++u) {
    const auto r = index(set.row_of_unknown[u]);
    set.residual[u] = row_speed(s, r) + s.rows[r].compliance * set.solution[u];
    largest = std::max(largest, std::abs(set.residual[u]));
  }
  return largest;
}

/// What rows may miss by round-off (m/s) that `missed` so much at first: a row's speed is known to
/// two units in the last place of the greatest, 4e-16 of it; of what it began with a solve leaves
/// some hundred units, since elimination along a cable adds them up.
double rounding_of(const PartSystem& s, double missed) {
  return 1e-13 * missed + 4e-16 * greatest_speed(s.velocity);
}

/// Impulses and speeds of the rows by the unknowns' values, and what is asked of all of them.
void set_rows(PartSystem& s, SolveScratch& set) {
  bool suspicious = false;
  double fastest = 0.0;
  const int* unknown_of_row = set.unknown_of_row.data();
  const double* solution = set.solution.data();
  for (Row& row : s.rows) {
    const int unknown = *unknown_of_row++;
    row.impulse = row.speed = 0.0;
    if (unknown >= 0) {
      row.impulse = solution[unknown];
    } else {
      row.speed = row_speed(s, static_cast<std::size_t>(&row - s.rows.data()));
      if (row.compliance == 0.0) fastest = std::max(fastest, std::abs(row.speed));
    }
    suspicious = suspicious || is_suspicious(s, row);
  }
  set.suspicious = suspicious;
  set.fastest = fastest;
}

/// Makes up for what a solution of a regular symmetric system misses, as long as that helps: an
/// error that has fallen by some factor will do so again, so that the last one need not be
/// measured. Returns whether it has come down to round-off: next to singular matrices keep some.
bool refine_symmetric(PartSystem& s, SolveScratch& set, int most_times) {
  constexpr double little = 1e-10;  // of the first: far above round-off, no speed that shows
  double missing = find_missing(s, set);
  const double first = missing;
  double rounding = 0.0;
  for (int k = 0; k < most_times; ++k) {
    s.ldl.solve(set.residual);
    double* solution = set.solution.data();
    const double* residual = set.residual.data();
    for (const int r : set.row_of_unknown) {
      *solution++ -= *residual;
      push(s, index(r), -*residual++);
    }
    if (k + 1 == most_times) break;
    if (k == 0) rounding = rounding_of(s, first);
    if (k > 0 && missing * missing <= rounding * first) {
      missing = rounding;
      break;
    }
    missing = find_missing(s, set);
    if (missing <= rounding) break;
  }
  set_rows(s, set);
  set.missing = missing;
  return missing <= std::max(rounding, little * first);
}

}  // namespace

void correct_solution(PartSystem& s, SolveScratch& set) {
  refine_symmetric(s, set, 1);
}

void express_states(PartSystem& s, SolveScratch& set) {
  if (!set.capstan.runs.empty()) make_groups(s, set);
  number_unknowns(s, set);
  if (!set.symmetric) express(s, set);
}

void solve_for_states(PartSystem& s, SolveScratch& set) {
  set.direct = set.contradicts = false;
  set.suspicious = true;
  if (!set.capstan.runs.empty()) make_groups(s, set);
  number_unknowns(s, set);
  if (!set.symmetric) {
    express(s, set);
    if (!s.sleeves.empty()) express_rubbing(s, set);
    gather_body_terms(s, set);
  }
  int repeated = factor(s, set, 0.0);
  if (set.symmetric && repeated > 0) repeated = factor_repeated_last(s, set, repeated);
  if (set.symmetric && repeated == 0) {
    set.solution.assign(set.row_of_unknown.size(), 0.0);
    set.residual.resize(set.row_of_unknown.size());
    s.velocity = s.free_velocity;
    set.direct = refine_symmetric(s, set, 3);
    return;
  }
  const double before = start(s, set);
  double residual = refine(s, set);
  const double rounding = rounding_of(s, before);
  for (int k = 0; k < 2 && repeated == 0 && residual > rounding; ++k) residual = refine(s, set);
  if (repeated > 0) spread_over_repeated_rows(s, set, rounding);
}

}  // namespace pinchlab
