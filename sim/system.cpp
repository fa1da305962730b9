// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/system.h"

#include <algorithm>
#include <cmath>

#include "sim/capstan.h"

namespace pinchlab {

namespace {

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

/// A row has an unknown of its own unless it bears nothing, slips, or follows from its group's.
bool has_unknown(const World& world, std::size_t r) {
  const Row& row = world.scratch.rows[r];
  const CapstanScratch& capstan = world.scratch.active_set.capstan;
  if (!row.on) return false;
  if (row.kind == RowKind::segment && !capstan.runs.empty() && capstan.group_of_row[r] >= 0) {
    const Group& group = capstan.groups[index(capstan.group_of_row[r])];
    return group.slack < 0 && capstan.members[index(group.begin)] == static_cast<int>(r);
  }
  const bool slips = (row.kind == RowKind::tangent || row.kind == RowKind::pinch_middle) &&
                     row.slip != Slip::stick;
  return !slips && row.diagonal > 0.0;
}

/// Numbers the unknowns, and tells whether each is one row's impulse: then the matrix is symmetric.
void number_unknowns(World& world) {
  Scratch& s = world.scratch;
  ActiveSet& set = s.active_set;
  set.unknown_of_row.assign(s.rows.size(), -1);
  set.row_of_unknown.clear();
  set.symmetric = set.capstan.runs.empty();
  for (const int r : s.order) {
    const Row& row = s.rows[index(r)];
    if (row.on && row.slip != Slip::stick) set.symmetric = false;
    if (!has_unknown(world, index(r))) continue;
    set.unknown_of_row[index(r)] = static_cast<int>(set.row_of_unknown.size());
    set.row_of_unknown.push_back(r);
  }
}

/// p = F z and the equations G, row by row; groups of sliding cables add theirs.
void express(World& world) {
  Scratch& s = world.scratch;
  ActiveSet& set = s.active_set;
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
      const bool later = slides && row.kind == RowKind::pinch_middle;
      if (!later) set.equation_terms.push_back({unknown, static_cast<int>(r), 1.0});
    } else if (row.on && row.slip != Slip::stick && row.normal >= 0) {
      // Sliding friction opposes the sliding: p = -slip * friction * normal.
      const int normal = set.unknown_of_row[index(row.normal)];
      if (normal >= 0)
        set.impulse_terms.push_back({normal, -static_cast<int>(row.slip) * row.bound});
    }
    set.impulse_end[r] = static_cast<int>(set.impulse_terms.size());
  }
  if (!slides) return;
  for (Row& row : s.rows) row.in_group_equation = false;
  express_impulses(world);
  add_group_equations(world);
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    if (s.rows[r].kind == RowKind::pinch_middle && set.unknown_of_row[r] >= 0 &&
        !s.rows[r].in_group_equation) {
      set.equation_terms.push_back({set.unknown_of_row[r], static_cast<int>(r), 1.0});
    }
  }
}

/// Adds vector * coefficient to the list's entry for (unknown, body), which if it exists is among
/// the entries from `begin` on.
void accumulate(std::vector<BodyTerm>& list, std::size_t begin, int unknown, int body,
                const Eigen::Vector3d& vector, double coefficient) {
  for (std::size_t k = begin; k < list.size(); ++k) {
    if (list[k].unknown == unknown && list[k].body == body) {
      list[k].vector += coefficient * vector;
      return;
    }
  }
  list.push_back({unknown, body, coefficient * vector});
}

bool moves(const Scratch& s, int body) {
  return body >= 0 && s.parts.mobile[index(body)] >= 0;
}

/// Effects of unknowns on bodies, listed by body, and what each equation sees of the bodies.
void gather_body_terms(World& world) {
  Scratch& s = world.scratch;
  ActiveSet& set = s.active_set;
  const std::size_t bodies = bodies_of(s.parts, part_being_solved(world)).size();
  const std::vector<int>& local = s.parts.local;
  set.columns.clear();
  set.equations.clear();
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    const Row& row = s.rows[r];
    for (int k = set.impulse_begin[r]; k < set.impulse_end[r]; ++k) {
      const Term& term = set.impulse_terms[index(k)];
      for (const auto& [body, j] : {std::pair(row.a, row.ja), std::pair(row.b, row.jb)}) {
        if (moves(s, body)) set.columns.push_back({term.index, body, term.coefficient * j});
      }
    }
  }
  std::size_t begin = 0;
  int unknown = -1;
  for (const EquationTerm& term : set.equation_terms) {
    const Row& row = s.rows[index(term.row)];
    if (term.unknown != unknown) {
      unknown = term.unknown;
      begin = set.equations.size();
    }
    if (moves(s, row.a)) accumulate(set.equations, begin, unknown, row.a, row.ja, term.coefficient);
    if (moves(s, row.b)) accumulate(set.equations, begin, unknown, row.b, row.jb, term.coefficient);
  }

  Lists<BodyTerm>& lists = set.columns_of_body;
  lists.begin.assign(bodies + 1, 0);
  for (const BodyTerm& term : set.columns) ++lists.begin[index(local[index(term.body)]) + 1];
  for (std::size_t b = 0; b < bodies; ++b) lists.begin[b + 1] += lists.begin[b];
  lists.items.resize(set.columns.size());
  set.fill = lists.begin;
  for (const BodyTerm& term : set.columns) {
    lists.items[index(set.fill[index(local[index(term.body)])]++)] = term;
  }
}

/// The profile: unknown u reaches back to the least one that shares a body with it.
void find_profile(World& world) {
  ActiveSet& set = world.scratch.active_set;
  const std::size_t bodies = bodies_of(world.scratch.parts, part_being_solved(world)).size();
  const auto local = [&world](int body) { return index(world.scratch.parts.local[index(body)]); };
  const int count = static_cast<int>(set.row_of_unknown.size());
  set.least_column.assign(bodies, count);
  set.least_equation.assign(bodies, count);
  for (const BodyTerm& t : set.columns) {
    set.least_column[local(t.body)] = std::min(set.least_column[local(t.body)], t.unknown);
  }
  for (const BodyTerm& t : set.equations) {
    set.least_equation[local(t.body)] = std::min(set.least_equation[local(t.body)], t.unknown);
  }
  set.first.resize(index(count));
  for (int u = 0; u < count; ++u) set.first[index(u)] = u;
  for (const BodyTerm& t : set.columns) {
    set.first[index(t.unknown)] =
        std::min(set.first[index(t.unknown)], set.least_equation[local(t.body)]);
  }
  for (const BodyTerm& t : set.equations) {
    set.first[index(t.unknown)] =
        std::min(set.first[index(t.unknown)], set.least_column[local(t.body)]);
  }
}

void assemble_coupled(World& world) {
  Scratch& s = world.scratch;
  ActiveSet& set = s.active_set;
  find_profile(world);
  for (const EquationTerm& term : set.equation_terms) {
    for (int k = set.impulse_begin[index(term.row)]; k < set.impulse_end[index(term.row)]; ++k) {
      const int other = set.impulse_terms[index(k)].index;  // through compliance, without a body
      const auto [low, high] = std::minmax(other, term.unknown);
      set.first[index(high)] = std::min(set.first[index(high)], low);
    }
  }
  set.lu.reset(set.first);
  for (const BodyTerm& t : set.equations) {
    const Eigen::Vector3d seen = s.mobility[index(t.body)] * t.vector;
    const auto& lists = set.columns_of_body;
    const std::size_t b = index(s.parts.local[index(t.body)]);
    for (int k = lists.begin[b]; k < lists.begin[b + 1]; ++k) {
      const BodyTerm& column = lists.items[index(k)];
      set.lu.add(t.unknown, column.unknown, seen.dot(column.vector));
    }
  }
  set.scale.assign(set.row_of_unknown.size(), 0.0);
  for (const EquationTerm& term : set.equation_terms) {
    const Row& row = s.rows[index(term.row)];
    for (int k = set.impulse_begin[index(term.row)]; k < set.impulse_end[index(term.row)]; ++k) {
      const Term& impulse = set.impulse_terms[index(k)];
      const double both = term.coefficient * impulse.coefficient;
      if (row.compliance > 0.0) set.lu.add(term.unknown, impulse.index, both * row.compliance);
      if (impulse.index == term.unknown) {
        set.scale[index(term.unknown)] += std::abs(both) * (row.diagonal + row.compliance);
      }
    }
  }
  for (double& scale : set.scale) {
    if (scale == 0.0) scale = 1.0;
  }
}

double dot(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

/// Appends an end of unknown u to the chain of its body.
void append_end(RowEnd* ends, int* last_end, int end, int body, const Eigen::Vector3d& j) {
  if (body < 0) return;
  int& last = last_end[body];
  ends[end].j = j;
  ends[end].previous = last;
  ends[end].least = last >= 0 ? ends[last].least : end / 2;
  last = end;
}

/// The matrix J M^-1 J^T + compliance where each unknown is one row's impulse. Every body keeps the
/// chain of the unknowns that move it, so that a row finds those that it is coupled with.
void assemble_symmetric(World& world) {
  Scratch& s = world.scratch;
  ActiveSet& set = s.active_set;
  const int count = static_cast<int>(set.row_of_unknown.size());
  set.last_end.assign(bodies_of(s.parts, part_being_solved(world)).size(), -1);
  set.ends.resize(2 * index(count));
  set.scale.resize(index(count));
  set.ldl.clear();
  const int* mobile = s.parts.mobile.data();
  RowEnd* ends = set.ends.data();
  int* last_end = set.last_end.data();
  for (int u = 0; u < count; ++u) {
    const Row& row = s.rows[index(set.row_of_unknown[index(u)])];
    const int a = row.a >= 0 ? mobile[row.a] : -1, b = row.b >= 0 ? mobile[row.b] : -1;
    const int last_a = a >= 0 ? last_end[a] : -1, last_b = b >= 0 ? last_end[b] : -1;
    int first = u;
    if (last_a >= 0) first = std::min(first, ends[last_a].least);
    if (last_b >= 0) first = std::min(first, ends[last_b].least);
    double* entries = set.ldl.append(first) - first;
    for (int e = last_a; e >= 0; e = ends[e].previous) entries[e / 2] += dot(row.ra, ends[e].j);
    for (int e = last_b; e >= 0; e = ends[e].previous) entries[e / 2] += dot(row.rb, ends[e].j);
    entries[u] = set.scale[index(u)] = row.diagonal + row.compliance;
    if (a >= 0 && a == b) entries[u] += 2.0 * dot(row.ra, row.jb);
    append_end(ends, last_end, 2 * u, a, row.ja);
    append_end(ends, last_end, 2 * u + 1, b, row.jb);
  }
}

/// Assembles and factors; returns how many rows repeat others.
int factor(World& world, double ridge) {
  ActiveSet& set = world.scratch.active_set;
  if (set.symmetric) {
    assemble_symmetric(world);
    return set.ldl.factor(set.scale, ridge);
  }
  assemble_coupled(world);
  return set.lu.factor(set.scale, ridge);
}

/// Whether the last step's factors serve: the same rows bear a force, and have changed by round-off
/// only.
bool factors_stand(const World& world) {
  const Scratch& s = world.scratch;
  const ActiveSet& set = s.active_set;
  if (!set.symmetric || !s.rows_stand || set.factored.empty()) return false;
  if (set.row_of_unknown != set.factored) return false;
  constexpr double rounding = 1e-13;
  for (std::size_t u = 0; u < set.factored.size(); ++u) {
    const Row& row = s.rows[index(set.factored[u])];
    const double change = row.diagonal + row.compliance - set.scale[u];
    if (std::abs(change) > rounding * set.scale[u]) return false;
  }
  return true;
}

/// Impulses of the rows for the unknowns' values, and the velocities.
void set_impulses(World& world) {
  Scratch& s = world.scratch;
  ActiveSet& set = s.active_set;
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    double p = 0.0;
    if (set.symmetric) {
      const int unknown = set.unknown_of_row[r];
      if (unknown >= 0) p = set.solution[index(unknown)];
    } else {
      for (int k = set.impulse_begin[r]; k < set.impulse_end[r]; ++k) {
        const Term& term = set.impulse_terms[index(k)];
        p += term.coefficient * set.solution[index(term.index)];
      }
    }
    s.rows[r].impulse = p;
  }
  apply_impulses(world);
}

/// The rows' speeds, and what each equation misses at them; returns the largest.
double find_residuals(World& world) {
  Scratch& s = world.scratch;
  ActiveSet& set = s.active_set;
  for (Row& row : s.rows) row.speed = row_speed(world, row) + row.compliance * row.impulse;
  set.residual.assign(set.row_of_unknown.size(), 0.0);
  if (set.symmetric) {
    for (std::size_t u = 0; u < set.residual.size(); ++u) {
      set.residual[u] = s.rows[index(set.row_of_unknown[u])].speed;
    }
  } else {
    for (const EquationTerm& term : set.equation_terms) {
      set.residual[index(term.unknown)] += term.coefficient * s.rows[index(term.row)].speed;
    }
  }
  double largest = 0.0;
  for (const double r : set.residual) largest = std::max(largest, std::abs(r));
  return largest;
}

double fastest(const World& world) {
  double speed = 0.0;
  for (const int b : bodies_of(world.scratch.parts, part_being_solved(world))) {
    speed = std::max(speed, world.velocity[index(b)].cwiseAbs().maxCoeff());
  }
  return speed;
}

/// One step of iterative refinement, and what it leaves. The residual is measured at the
/// velocities, where heavy and light bodies do not mix, so that it restores what elimination loses
/// at large mass ratios.
double refine(World& world) {
  ActiveSet& set = world.scratch.active_set;
  if (set.symmetric) {
    set.ldl.solve(set.residual);
  } else {
    set.lu.solve(set.residual);
  }
  for (std::size_t u = 0; u < set.solution.size(); ++u) set.solution[u] -= set.residual[u];
  set_impulses(world);
  return find_residuals(world);
}

/// J v + bias at the free velocities (m/s).
double free_speed(const Scratch& s, const Row& row) {
  const auto along = [&s](int body, const Eigen::Vector3d& j) {
    const Vec2& v = s.velocity_free[index(body)];
    return j.x() * v.x() + j.y() * v.y() + j.z() * s.angular_velocity_free[index(body)];
  };
  double w = row.bias;
  if (row.a >= 0) w += along(row.a, row.ja);
  if (row.b >= 0) w += along(row.b, row.jb);
  return w;
}

/// Starts from no impulses at all; returns the largest residual.
double start(World& world) {
  Scratch& s = world.scratch;
  ActiveSet& set = s.active_set;
  const std::size_t count = set.row_of_unknown.size();
  set.solution.assign(count, 0.0);
  if (set.symmetric) {
    set.residual.resize(count);
    double largest = 0.0;
    for (std::size_t u = 0; u < count; ++u) {
      set.residual[u] = free_speed(s, s.rows[index(set.row_of_unknown[u])]);
      largest = std::max(largest, std::abs(set.residual[u]));
    }
    return largest;
  }
  for (Row& row : s.rows) row.impulse = 0.0;
  release_bodies(world);
  return find_residuals(world);
}

/// Of all solutions of a system with repeated rows, (nearly) the one of least norm: that of the
/// system with a small ridge on its diagonal, whose right side is first made consistent by a basic
/// solution.
void spread_over_repeated_rows(World& world, double rounding) {
  ActiveSet& set = world.scratch.active_set;
  constexpr double ridge = 1e-8;
  set.right_side = set.residual;  // what a basic solution leaves of contradictory constraints
  const auto subtract_contradictions = [&set] {
    double largest = 0.0;
    for (std::size_t u = 0; u < set.residual.size(); ++u) {
      set.residual[u] -= set.right_side[u];
      largest = std::max(largest, std::abs(set.residual[u]));
    }
    return largest;
  };
  factor(world, ridge);
  start(world);
  for (int k = 0; k < 3; ++k) {
    subtract_contradictions();
    refine(world);
  }
  // Beside masses that differ by more than the ridge it has not found all of the solution: the rest
  // is added without it.
  if (subtract_contradictions() <= rounding) return;
  factor(world, 0.0);
  refine(world);
  for (int k = 0; k < 2 && subtract_contradictions() > rounding; ++k) refine(world);
}

}  // namespace

void release_bodies(World& world) {
  const Scratch& s = world.scratch;
  for (const int number : bodies_of(s.parts, part_being_solved(world))) {
    const std::size_t b = index(number);
    world.velocity[b] = s.velocity_free[b];
    world.angular_velocity[b] = s.angular_velocity_free[b];
  }
}

void apply_impulses(World& world) {
  release_bodies(world);
  for (const Row& row : world.scratch.rows) push(world, row, row.impulse);
}

void solve_for_states(World& world) {
  ActiveSet& set = world.scratch.active_set;
  if (!set.capstan.runs.empty()) make_groups(world);
  number_unknowns(world);
  if (!set.symmetric) {
    express(world);
    gather_body_terms(world);
  }
  int repeated = 0;
  if (!factors_stand(world)) {
    repeated = factor(world, 0.0);
    set.factored.clear();
    if (set.symmetric && repeated == 0) set.factored = set.row_of_unknown;
  }
  const double before = start(world);
  double residual = refine(world);
  const double rounding = 1e-13 * before + 4e-16 * fastest(world);
  for (int k = 0; k < 2 && repeated == 0 && residual > rounding; ++k) residual = refine(world);
  if (repeated > 0) spread_over_repeated_rows(world, rounding);
}

}  // namespace pinchlab
