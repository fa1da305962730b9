// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/gauss_seidel.h"

#include <algorithm>
#include <cmath>

#include "sim/active_set.h"
#include "sim/system.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

/// Share of a position error that one step makes up: the thesis' biases.
constexpr double segment_gain = 0.2, contact_gain = 0.7;

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

bool is_friction(const Row& row) {
  return row.kind == RowKind::tangent || row.kind == RowKind::pinch_middle;
}

/// The bias of a row with the thesis' gain on what it has to make up. Rebounds and springs are no
/// errors: they keep theirs.
double steered_bias(const Row& row) {
  if (row.rebounds || row.compliance > 0.0) return row.bias;
  if (row.kind == RowKind::pinch_middle) return segment_gain * row.bias;
  const double gain = row.kind == RowKind::segment ? segment_gain : contact_gain;
  return row.bias < 0.0 ? gain * row.bias : row.bias;
}

SweepRow sweep_row(const World& world, const Row& row) {
  const std::vector<Mobility>& mobility = world.scratch.mobility;
  SweepRow r;
  const int ground = static_cast<int>(mobility.size());
  r.a = row.a >= 0 ? row.a : ground;
  r.b = row.b >= 0 ? row.b : ground;
  r.other = row.normal;
  r.clamp = is_friction(row) ? Clamp::friction : Clamp::tension;
  r.by_run = false;
  r.ja = r.jb = r.response_a = r.response_b = Eigen::Vector3d::Zero();
  if (row.a >= 0) r.ja = row.ja, r.response_a = mobility[index(row.a)] * row.ja;
  if (row.b >= 0) r.jb = row.jb, r.response_b = mobility[index(row.b)] * row.jb;
  r.bias = steered_bias(row);
  r.compliance = row.compliance;
  r.stiffness = row.diagonal > 0.0 ? row.diagonal + row.compliance : 0.0;
  r.bound = row.friction;
  r.impulse = 0.0;
  return r;
}

void load(World& world) {
  SweepScratch& s = world.scratch.sweeps;
  const std::size_t bodies = world.velocity.size();
  s.velocity.resize(bodies + 1, Eigen::Vector3d::Zero());
  for (const int number : bodies_of(world.scratch.parts, part_being_solved(world))) {
    const std::size_t b = index(number);
    s.velocity[b] << world.velocity[b], world.angular_velocity[b];
  }
  s.rows.clear();
  for (const Row& row : world.scratch.rows) s.rows.push_back(sweep_row(world, row));
  CapstanScratch& capstan = world.scratch.active_set.capstan;
  for (Run& run : capstan.runs) {
    s.rows[index(run.row_in)].by_run = s.rows[index(run.row_out)].by_run = true;
    run.speed = 0.0;
    run.slip = Slip::stick;
    for (int k = run.passages_begin; k < run.passages_end; ++k) {
      const Passage& p = capstan.passages[index(k)];
      if (p.middle_out < 0) continue;
      s.rows[index(p.middle)].clamp = s.rows[index(p.middle_out)].clamp = Clamp::middle;
      s.rows[index(p.middle)].other = p.middle_out;
      s.rows[index(p.middle_out)].other = p.middle;
    }
  }
}

double speed(const SweepScratch& s, const SweepRow& row) {
  return row.ja.dot(s.velocity[index(row.a)]) + row.jb.dot(s.velocity[index(row.b)]) + row.bias +
         row.compliance * row.impulse;
}

void set_impulse(SweepScratch& s, SweepRow& row, double impulse) {
  const double change = impulse - row.impulse;
  s.velocity[index(row.a)] += change * row.response_a;
  s.velocity[index(row.b)] += change * row.response_b;
  row.impulse = impulse;
}

double unclamped(const SweepScratch& s, const SweepRow& row) {
  return row.impulse - speed(s, row) / row.stiffness;
}

/// Most that a friction row may bear at the present force on it.
double most_friction(const SweepScratch& s, const SweepRow& row) {
  const double force = row.other >= 0 ? s.rows[index(row.other)].impulse : infinity;
  return row.bound == 0.0 || force == 0.0 ? 0.0 : row.bound * force;
}

void relax(SweepScratch& s, SweepRow& row) {
  if (row.stiffness == 0.0) return;
  double least = 0.0, most = infinity;
  if (row.clamp == Clamp::friction) {
    most = most_friction(s, row);
    least = -most;
  } else if (row.clamp == Clamp::middle) {
    most = s.rows[index(row.other)].impulse + row.bound;
  }
  set_impulse(s, row, std::clamp(unclamped(s, row), least, most));
}

/// What the middle body of a pinch takes from the tension.
double middle_impulse(const SweepScratch& s, const Passage& p) {
  const double out = p.middle_out >= 0 ? s.rows[index(p.middle_out)].impulse : 0.0;
  return s.rows[index(p.middle)].impulse - out;
}

/// Lets the material slide over the run's body at another speed, and with it through the pinches.
void slide(SweepScratch& s, const CapstanScratch& capstan, Run& run, double speed) {
  const double change = speed - run.speed;
  run.speed = speed;
  s.rows[index(run.row_in)].bias -= change;
  s.rows[index(run.row_out)].bias += change;
  for (int k = run.passages_begin; k < run.passages_end; ++k) {
    const Passage& p = capstan.passages[index(k)];
    if (p.middle >= 0) s.rows[index(p.middle)].bias += change;
    if (p.middle_out >= 0) s.rows[index(p.middle_out)].bias -= change;
  }
}

/// p_out = factor * p_in + offset where the material slides `way` (1 forward, -1 backward).
struct SlidingLaw {
  double factor = 1.0, offset = 0.0;
};

SlidingLaw sliding_law(const SweepScratch& s, const CapstanScratch& capstan, const Run& run,
                       int way) {
  constexpr double largest = 1e250;  // tells as well as infinity that the cable sticks
  SlidingLaw law;
  for (int k = run.passages_begin; k < run.passages_end; ++k) {
    const Passage& p = capstan.passages[index(k)];
    const double factor = way > 0 ? p.factor : 1.0 / p.factor;
    law.factor = std::clamp(law.factor * factor, 1.0 / largest, largest);
    law.offset = std::clamp(law.offset * factor, -largest, largest);
    if (p.normal >= 0) law.offset += way * p.friction * s.rows[index(p.normal)].impulse;
    if (p.middle >= 0) law.offset -= middle_impulse(s, p);
  }
  return law;
}

/// The speed of slip at which the segments' next relaxation would put their tensions on the law,
/// half of the way there: other rows answer as well, and the whole way overshoots.
double speed_for_law(const SweepRow& in, const SweepRow& out, double p_in, double p_out,
                     const SlidingLaw& law, double present) {
  const double excess = p_out - law.factor * p_in - law.offset;
  return present + 0.5 * excess / (1.0 / out.stiffness + law.factor / in.stiffness);
}

/// The segments before and after a sliding body at the present slip, then the slip for their
/// tensions. Slip is relaxed like an impulse: forward as far as the forward law is broken, backward
/// as far as the backward one is, else none.
void relax_run(World& world, Run& run) {
  SweepScratch& s = world.scratch.sweeps;
  const CapstanScratch& capstan = world.scratch.active_set.capstan;
  SweepRow &in = s.rows[index(run.row_in)], &out = s.rows[index(run.row_out)];
  relax(s, in);
  relax(s, out);
  const bool sticks = run.passages_begin == run.passages_end;
  if (sticks || in.stiffness == 0.0 || out.stiffness == 0.0) return;
  const double p_in = unclamped(s, in), p_out = unclamped(s, out);
  double slip = 0.0;
  if (p_in <= 0.0 && p_out <= 0.0) {
    // Both slack: only what the one lacks slides over from the other.
    const double w_in = speed(s, in) + run.speed, w_out = speed(s, out) - run.speed;
    slip = std::max(-w_out, std::min(w_in, 0.0));
  } else {
    const auto to_law = [&](int way) {
      return speed_for_law(in, out, p_in, p_out, sliding_law(s, capstan, run, way), run.speed);
    };
    const double forward = to_law(1), backward = to_law(-1);
    if (forward > 0.0 && backward >= 0.0) slip = forward;
    if (backward < 0.0 && forward <= 0.0) slip = backward;
  }
  run.slip = slip > 0.0 ? Slip::forward : slip < 0.0 ? Slip::backward : Slip::stick;
  slide(s, capstan, run, slip);
}

/// What the middle bodies of pinches can hold while the tensions before and after the run are what
/// they are.
///
/// One row: friction of the contact's force; on a cable that is slack on both sides friction passes
/// from body to body, as much as the smoother of the two allows. Three rows: tensions t1 before
/// and t2 after the middle body within t1 / f <= t2 <= f t1. With u1 and u2 the largest that they
/// can be, all arcs holding as much as they can, t1 - t2 is at most both u1 (1 - 1/f) and
/// u2 (f - 1), and t2 - t1 the like.
void bound_middles(World& world, const Run& run) {
  SweepScratch& s = world.scratch.sweeps;
  const CapstanScratch& capstan = world.scratch.active_set.capstan;
  double tension = s.rows[index(run.row_in)].impulse;
  const bool slack = tension == 0.0 && s.rows[index(run.row_out)].impulse == 0.0;
  for (int k = run.passages_begin; k < run.passages_end; ++k) {
    const Passage& p = capstan.passages[index(k)];
    tension *= p.factor;
    if (p.middle < 0) continue;
    if (p.middle_out >= 0) {
      s.rows[index(p.middle)].bound = tension * (1.0 - 1.0 / p.middle_factor);
      s.rows[index(p.middle_out)].bound = tension * (p.middle_factor - 1.0);
    } else {
      const Row& row = world.scratch.rows[index(p.middle)];
      s.rows[index(p.middle)].bound =
          slack ? std::min(row.friction, row.wrapped_friction) : row.friction;
    }
    tension = std::max(0.0, tension - middle_impulse(s, p));
  }
  tension = s.rows[index(run.row_out)].impulse;
  for (int k = run.passages_end - 1; k >= run.passages_begin; --k) {
    const Passage& p = capstan.passages[index(k)];
    tension *= p.factor;
    if (p.middle_out < 0) continue;
    SweepRow &middle = s.rows[index(p.middle)], &middle_out = s.rows[index(p.middle_out)];
    middle.bound = std::min(middle.bound, tension * (p.middle_factor - 1.0));
    middle_out.bound = std::min(middle_out.bound, tension * (1.0 - 1.0 / p.middle_factor));
    tension = std::max(0.0, tension + middle_impulse(s, p));
  }
}

/// All rows of cables, then all rows of contacts, in their order.
void sweep(World& world) {
  SweepScratch& s = world.scratch.sweeps;
  std::vector<Run>& runs = world.scratch.active_set.capstan.runs;
  for (const Run& run : runs) bound_middles(world, run);
  const std::size_t contacts = index(world.scratch.first_contact_row);
  for (std::size_t r = 0; r < contacts; ++r) {
    if (!s.rows[r].by_run) relax(s, s.rows[r]);
  }
  for (Run& run : runs) relax_run(world, run);
  for (std::size_t r = contacts; r < s.rows.size(); ++r) relax(s, s.rows[r]);
}

/// Sweeps that end before they have converged may leave a run sliding against its friction. It
/// then sticks for this step: friction must not drive what it should brake.
void stop_driven_runs(World& world) {
  SweepScratch& s = world.scratch.sweeps;
  CapstanScratch& capstan = world.scratch.active_set.capstan;
  for (Run& run : capstan.runs) {
    const double in = s.rows[index(run.row_in)].impulse, out = s.rows[index(run.row_out)].impulse;
    if (run.frictionless || (in == 0.0 && out == 0.0)) continue;
    double gained = out - in;
    for (int k = run.passages_begin; k < run.passages_end; ++k) {
      const Passage& p = capstan.passages[index(k)];
      if (p.middle >= 0) gained += middle_impulse(s, p);
    }
    if (run.speed * gained >= 0.0) continue;
    slide(s, capstan, run, 0.0);
    run.slip = Slip::stick;
  }
}

/// Velocities, impulses and states. The rows' speeds are those that the unsteered rows see.
void unload(World& world) {
  const SweepScratch& s = world.scratch.sweeps;
  for (const int number : bodies_of(world.scratch.parts, part_being_solved(world))) {
    const std::size_t b = index(number);
    world.velocity[b] = s.velocity[b].head<2>();
    world.angular_velocity[b] = s.velocity[b].z();
  }
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    Row& row = world.scratch.rows[r];
    const double p = row.impulse = s.rows[r].impulse;
    row.speed = row_speed(world, row) + row.compliance * p;
    if (is_friction(row)) {
      const double most = most_friction(s, s.rows[r]);
      row.on = most > 0.0;
      row.slip = std::abs(p) < most ? Slip::stick : p > 0.0 ? Slip::backward : Slip::forward;
    } else {
      row.on = p > 0.0;
    }
  }
}

/// The middle bodies of pinches with three rows: which of them let the cable slide through.
void store_middles(World& world) {
  const SweepScratch& s = world.scratch.sweeps;
  const CapstanScratch& capstan = world.scratch.active_set.capstan;
  for (const Run& run : capstan.runs) {
    for (int k = run.passages_begin; k < run.passages_end; ++k) {
      const Passage& p = capstan.passages[index(k)];
      if (p.middle_out < 0) continue;
      const Row& row = world.scratch.rows[index(p.middle)];
      Link& link = world.cables[index(row.index)].links[index(row.item)];
      const double held = middle_impulse(s, p);
      if (held >= s.rows[index(p.middle)].bound) {
        link.slip = Slip::backward;
      } else if (-held >= s.rows[index(p.middle_out)].bound) {
        link.slip = Slip::forward;
      } else {
        link.slip = Slip::stick;
      }
      link.slip_speed = link.slip == Slip::stick ? 0.0 : row.speed + run.speed;
    }
  }
}

}  // namespace

void solve_iterative(const Scene& scene, World& world, int part, double kick) {
  world.scratch.active_set.part = part;
  release_bodies(world);
  if (world.scratch.rows.empty()) return;
  find_runs(scene, world, part_being_solved(world));
  load(world);
  for (int k = 0; k < world.configuration.iterations; ++k) sweep(world);
  stop_driven_runs(world);
  unload(world);
  store_states(world, kick);
  store_middles(world);
}

}  // namespace pinchlab
