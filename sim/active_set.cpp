// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/active_set.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "sim/cable.h"
#include "sim/ordering.h"
#include "sim/system.h"

namespace pinchlab {

namespace {

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

bool is_friction(const Row& row) {
  return row.kind == RowKind::tangent || row.kind == RowKind::pinch_middle;
}

/// Friction rows bear force only where their contact does. A pinch on a cable that is slack on both
/// sides passes friction from body to body, as much as the smoother of the two allows.
void bound_friction(World& world) {
  std::vector<Row>& rows = world.scratch.rows;
  if (!world.scratch.has_friction_rows) return;
  for (Row& row : rows) {
    if (!is_friction(row) || row.repeats >= 0) continue;
    if (row.normal >= 0) row.on = rows[index(row.normal)].on;
    row.bound = row.friction;
    if (row.run >= 0) {
      const Run& run = world.scratch.active_set.capstan.runs[index(row.run)];
      const bool slack = !rows[index(run.row_in)].on && !rows[index(run.row_out)].on;
      if (slack) row.bound = std::min(row.friction, row.wrapped_friction);
    }
    if (row.bound == 0.0 || row.dropped) row.on = false;
    if (row.bound == infinity) row.slip = Slip::stick;
  }
}

struct Tolerances {
  double speed;    // m/s
  double impulse;  // N s
};

/// Round-off of the quantities that the checks compare: of speeds, and of positions and lengths,
/// which the rows' biases divide by the step. The errors of a cable's segments add up along it.
Tolerances tolerances(const World& world) {
  const Scratch& s = world.scratch;
  const Part& part = part_being_solved(world);
  double speed = 0.0, extent = 0.0, impulse = 0.0, stiffest = 0.0;
  for (const int number : bodies_of(s.parts, part)) {
    const std::size_t b = index(number);
    extent = std::max(extent, world.position[b].cwiseAbs().maxCoeff());
    speed = std::max(
        {speed, world.velocity[b].cwiseAbs().maxCoeff(), s.velocity_free[b].cwiseAbs().maxCoeff()});
  }
  for (const int c : cables_of(s.parts, part)) {
    const CableState& cable = world.cables[index(c)];
    const auto segments = static_cast<double>(cable.segments.size());
    extent = std::max(extent, cable.length * std::max(1.0, 0.1 * segments));
  }
  for (const Row& row : s.rows) {
    impulse = std::max(impulse, std::abs(row.impulse));
    stiffest = std::max(stiffest, row.diagonal);
    if (row.on) speed = std::max(speed, std::abs(row.bias));
  }
  // What takes many solves is round-off more likely than not: it is given more room with each.
  constexpr int patience = 4, most_doublings = 10;
  const int doublings = std::clamp(s.active_set.solves - patience, 0, most_doublings);
  const double tolerance =
      std::ldexp(1e-12 * speed + 1e-15 * extent / world.step_length, doublings);
  return {tolerance, 1e-10 * impulse + (stiffest > 0.0 ? tolerance / stiffest : 0.0)};
}

void check_friction(const Row& row, int number, double sliding, const World& world,
                    const Tolerances& tolerance, std::vector<Flip>& flips) {
  if (!row.on || row.frozen || row.bound == infinity) return;
  const double bound = row.bound * world.scratch.rows[index(row.normal)].impulse;
  if (row.slip == Slip::stick) {
    if (std::abs(row.impulse) <= bound + tolerance.impulse) return;
    flips.push_back({number, false, true, row.impulse > 0.0 ? Slip::backward : Slip::forward});
  } else if (sliding * static_cast<int>(row.slip) < -tolerance.speed && bound > tolerance.impulse) {
    flips.push_back({number, false, true, Slip::stick});
  }
}

/// Sliding speed over the wrapped body at a middle link's pinch: that of its run.
double run_speed(const World& world, const Row& row) {
  return row.run >= 0 ? world.scratch.active_set.capstan.runs[index(row.run)].speed : 0.0;
}

/// Which states the solution contradicts.
void check(World& world) {
  Scratch& s = world.scratch;
  ActiveSet& set = s.active_set;
  set.flips.clear();
  const Tolerances tolerance = tolerances(world);
  const bool slides = !set.capstan.runs.empty();
  if (slides) check_runs(world, tolerance.speed, tolerance.impulse);
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    const Row& row = s.rows[r];
    const int number = static_cast<int>(r);
    if (row.kind == RowKind::tangent) {
      check_friction(row, number, row.speed, world, tolerance, set.flips);
    } else if (row.kind == RowKind::pinch_middle) {
      const double sliding = row.speed + run_speed(world, row);
      check_friction(row, number, sliding, world, tolerance, set.flips);
    } else if (row.diagonal > 0.0 && (!slides || set.capstan.group_of_row[r] < 0)) {
      if (row.on && row.impulse < -tolerance.impulse) {
        set.flips.push_back({number, false, false, Slip::stick});
      } else if (!row.on && row.speed < -tolerance.speed) {
        set.flips.push_back({number, false, true, Slip::stick});
      }
    }
  }
}

bool is_unilateral(const Row& row) {
  return row.kind == RowKind::segment || row.kind == RowKind::normal;
}

/// Whether the solution's negative impulses are round-off: whether, with zero in their place, every
/// row still holds to within the tolerance. (Of a cable that hardly bears tension the impulses are
/// uncertain by the tolerance times the matrix' condition, which grows with the square of its
/// segments.) Leaves zeros in their place if so.
bool clear_rounding(World& world) {
  Scratch& s = world.scratch;
  if (!s.active_set.symmetric) return false;
  for (const Flip& flip : s.active_set.flips) {
    if (flip.is_run || flip.on) return false;
  }
  const double tolerance = tolerances(world).speed;
  for (Row& row : s.rows) {
    if (is_unilateral(row)) row.impulse = std::max(row.impulse, 0.0);
  }
  apply_impulses(world);
  for (Row& row : s.rows) {
    row.speed = row_speed(world, row) + row.compliance * row.impulse;
    if (row.diagonal == 0.0 || (!row.on && !is_unilateral(row))) continue;
    if (row.speed < -tolerance || (row.on && row.speed > tolerance)) return false;
  }
  return true;
}

void apply(World& world, const Flip& flip) {
  if (flip.is_run) {
    Run& run = world.scratch.active_set.capstan.runs[index(flip.row)];
    run.slip = flip.slip;
    run.flipped = world.scratch.active_set.solves;
    return;
  }
  Row& row = world.scratch.rows[index(flip.row)];
  row.flipped = world.scratch.active_set.solves;
  if (is_friction(row)) {
    row.slip = flip.slip;
  } else {
    row.on = flip.on;
  }
}

/// One flip, where flipping everything makes no progress. With friction every fixed rule of choice
/// has its cycles, so the choice hops about: by a fixed multiplicative sequence, the same in every
/// run.
const Flip& choose_flip(const ActiveSet& set, int solve) {
  const auto hop = static_cast<std::uint32_t>(solve) * 2654435761u;
  return set.flips[(hop >> 8) % set.flips.size()];
}

/// Whether all that the solution asks for is that more rows bear a force.
bool only_grows(const ActiveSet& set) {
  return std::all_of(set.flips.begin(), set.flips.end(),
                     [](const Flip& flip) { return !flip.is_run && flip.on; });
}

/// Makes the segments taut that lie up to `reach` before or after one that is to be made taut. A
/// slack cable that is pulled tight grows taut by one segment a solve from where it is pulled; with
/// a reach that doubles it takes the logarithm of that, and those that are too many slacken again.
void spread_tautness(World& world, int reach) {
  std::vector<Row>& rows = world.scratch.rows;
  for (const Flip& flip : world.scratch.active_set.flips) {
    const Row& pulled = rows[index(flip.row)];
    if (pulled.kind != RowKind::segment) continue;
    const int last = std::min(flip.row + reach, static_cast<int>(rows.size()) - 1);
    for (int r = std::max(flip.row - reach, 0); r <= last; ++r) {
      Row& row = rows[index(r)];
      if (row.kind != RowKind::segment || row.index != pulled.index || row.on) continue;
      row.on = row.diagonal > 0.0;
      row.flipped = world.scratch.active_set.solves;
    }
  }
}

/// Friction of bare surfaces that has changed in this step is left out of it: sticking may
/// contradict what cables and contacts ask of the same bodies, but frictionless they can always be
/// met.
void drop_friction(World& world) {
  for (Row& row : world.scratch.rows) {
    if (row.kind == RowKind::tangent && row.frozen) row.dropped = true;
  }
}

/// Everything that friction has changed in this step sticks for the rest of it. Sticking neither
/// makes energy nor moves material; only the bound on its force is exceeded, for one step.
void freeze_friction(World& world) {
  for (Row& row : world.scratch.rows) {
    if (!is_friction(row) || row.flipped == 0) continue;
    row.slip = Slip::stick;
    row.frozen = true;
  }
  for (Run& run : world.scratch.active_set.capstan.runs) {
    if (run.frictionless || run.flipped == 0) continue;
    run.slip = Slip::stick;
    run.frozen = true;
  }
}

/// Projected Gauss-Seidel from the present impulses: what is done when friction makes the states
/// cycle. Sliding runs are held for this step; every impulse stays inside its bounds, so no energy
/// comes in.
void sweep(World& world) {
  Scratch& s = world.scratch;
  for (Row& row : s.rows) {
    if (row.kind == RowKind::segment || row.kind == RowKind::normal)
      row.impulse = std::max(row.impulse, 0.0);
  }
  for (Run& run : s.active_set.capstan.runs) run.speed = 0.0;
  apply_impulses(world);
  constexpr int sweeps = 200;
  for (int k = 0; k < sweeps; ++k) {
    for (Row& row : s.rows) {
      if (row.diagonal == 0.0) continue;
      double least = 0.0, most = infinity;
      if (is_friction(row)) {
        const double force = row.normal >= 0 ? s.rows[index(row.normal)].impulse : infinity;
        most = row.bound == 0.0 || row.dropped || force == 0.0 ? 0.0 : row.bound * force;
        least = -most;
      }
      const double before = row.impulse;
      const double w = row_speed(world, row) + row.compliance * before;
      row.impulse = std::clamp(before - w / (row.diagonal + row.compliance), least, most);
      push(world, row, row.impulse - before);
    }
  }
  for (Row& row : s.rows) {
    row.speed = row_speed(world, row);
    if (!is_friction(row)) row.on = row.impulse > 0.0;
  }
}

}  // namespace

void store_states(World& world, double kick) {
  Scratch& s = world.scratch;
  for (Row& row : s.rows) {
    if (row.repeated > 0) row.impulse /= 1 + row.repeated;
    if (row.repeats < 0) continue;
    const Row& first = s.rows[index(row.repeats)];  // comes before, and has its share by now
    row.impulse =
        row.ja.dot(row.a == first.a ? first.ja : first.jb) > 0.0 ? first.impulse : -first.impulse;
  }
  for (const Row& row : s.rows) {
    if (row.kind == RowKind::segment || row.kind == RowKind::pinch_middle) {
      CableState& cable = world.cables[index(row.index)];
      Segment& segment = cable.segments[index(row.item)];
      segment.tension = row.impulse / kick;
      if (row.kind == RowKind::segment) {
        segment.slack = !row.on;
      } else {
        cable.links[index(row.item)].slip = row.slip;
      }
    } else {
      Contact& contact = world.contacts[index(row.index)];
      if (row.kind == RowKind::normal) {
        contact.touching = row.on;
        contact.normal_force = row.impulse / kick;
      } else {
        contact.slip = row.slip;
        contact.tangent_force = row.impulse / kick;
      }
    }
  }
  for (Run& run : s.active_set.capstan.runs) {
    const bool bears =
        s.rows[index(run.row_in)].impulse > 0.0 || s.rows[index(run.row_out)].impulse > 0.0;
    if (!bears && run.speed == 0.0) run.slip = Slip::stick;
    CableState& cable = world.cables[index(run.cable)];
    for (int i = run.first_link;; i = next_link(cable, i)) {
      Link& link = cable.links[index(i)];
      if (!link.pinch_middle || run.first_link == run.last_link) {
        link.slip = run.slip;
        link.slip_speed = run.speed;
      }
      if (i == run.last_link) break;
    }
  }
  for (const Row& row : s.rows) {
    if (row.kind != RowKind::pinch_middle) continue;
    const bool sticks = row.on && row.slip == Slip::stick;
    world.cables[index(row.index)].links[index(row.item)].slip_speed =
        sticks ? 0.0 : row.speed + run_speed(world, row);
  }
}

void solve_direct(const Scene& scene, World& world, int part, double kick) {
  Scratch& s = world.scratch;
  ActiveSet& set = s.active_set;
  set.part = part;
  set.solves = 0;
  if (s.rows.empty()) {
    release_bodies(world);
    return;
  }
  order_rows(world, part);
  find_runs(scene, world, part_being_solved(world));
  // All contradicted states flip while that makes progress, then one at a time.
  constexpr int patience = 3, before_freezing = 40, before_dropping = 70, most_solves = 150;
  std::size_t fewest = s.rows.size() + set.capstan.runs.size() + 1;
  int left = patience;
  int growing = 0, reached = 0;  // solves in succession that ask for more force only, and before
  bool settled = false, spread = false;
  for (int solves = 1; solves <= most_solves && !settled; ++solves) {
    if (solves == before_freezing) {
      freeze_friction(world);
      ++world.diagnostics.fallbacks;
    }
    if (solves == before_dropping) drop_friction(world);
    bound_friction(world);
    solve_for_states(world);
    set.solves = solves;
    check(world);
    settled = set.flips.empty() || clear_rounding(world);
    if (settled) break;
    growing = only_grows(set) ? growing + 1 : 0;
    if (growing > patience && !spread) {
      spread_tautness(world, 1 << std::min(growing - patience, 20));
    } else if (growing == 0 && reached > patience) {
      spread = true;
    }
    reached = growing;
    const bool progress = set.flips.size() < fewest;
    left = progress ? patience : left - 1;
    fewest = std::min(fewest, set.flips.size());
    if (left > 0) {
      for (const Flip& flip : set.flips) apply(world, flip);
    } else {
      apply(world, choose_flip(set, solves));
    }
  }
  if (!settled) sweep(world);
  for (Row& row : s.rows) {
    if (!is_friction(row)) row.impulse = std::max(row.impulse, 0.0);  // within round-off of zero
  }
  store_states(world, kick);
  world.diagnostics.active_set_solves = std::max(world.diagnostics.active_set_solves, set.solves);
}

}  // namespace pinchlab
