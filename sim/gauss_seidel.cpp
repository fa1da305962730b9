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

/// dw of one row by a unit impulse on another, through the bodies that they share.
double coupling(const SweepRow& p, const SweepRow& q) {
  double sum = 0.0;
  if (p.a == q.a) sum += p.ja.dot(q.response_a);
  if (p.a == q.b) sum += p.ja.dot(q.response_b);
  if (p.b == q.a) sum += p.jb.dot(q.response_a);
  if (p.b == q.b) sum += p.jb.dot(q.response_b);
  return sum;
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
  s.coupling.clear();
  CapstanScratch& capstan = world.scratch.active_set.capstan;
  for (Run& run : capstan.runs) {
    SweepRow &in = s.rows[index(run.row_in)], &out = s.rows[index(run.row_out)];
    in.by_run = out.by_run = true;
    s.coupling.push_back(coupling(in, out));
    run.speed = 0.0;
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

/// The two segments of a run with the material at rest on the body, solved exactly, each >= 0.
void relax_sticking(SweepScratch& s, SweepRow& in, SweepRow& out, double coupled) {
  const double determinant = in.stiffness * out.stiffness - coupled * coupled;
  if (determinant <= 1e-12 * in.stiffness * out.stiffness) {
    // One repeats the other (or cannot move anything): both take half.
    const double most = std::max(in.stiffness, out.stiffness);
    if (most == 0.0) return;
    const double w_in = speed(s, in), w_out = speed(s, out);
    set_impulse(s, in, std::max(0.0, in.impulse - 0.5 * w_in / most));
    set_impulse(s, out, std::max(0.0, out.impulse - 0.5 * w_out / most));
    return;
  }
  const double w_in = speed(s, in), w_out = speed(s, out);
  double p_in = in.impulse - (out.stiffness * w_in - coupled * w_out) / determinant;
  double p_out = out.impulse - (in.stiffness * w_out - coupled * w_in) / determinant;
  if (p_in < 0.0) {
    p_in = 0.0;
    p_out = std::max(0.0, out.impulse - (w_out - coupled * in.impulse) / out.stiffness);
  } else if (p_out < 0.0) {
    p_out = 0.0;
    p_in = std::max(0.0, in.impulse - (w_in - coupled * out.impulse) / in.stiffness);
  }
  set_impulse(s, in, p_in);
  set_impulse(s, out, p_out);
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

/// Sliding: tensions on the law, one unknown p_in, such that the two segments together have the
/// material that they need, w_in + w_out = 0. Returns the speed at which what the one lacks slides
/// over from the other.
double relax_sliding(SweepScratch& s, SweepRow& in, SweepRow& out, double coupled,
                     const SlidingLaw& law) {
  const double by_in = in.stiffness + coupled, by_out = out.stiffness + coupled;
  const double by_both = by_in + law.factor * by_out;
  double p_in = (in.impulse + out.impulse - law.offset) / (1.0 + law.factor);
  if (by_both > 1e-12 * (in.stiffness + law.factor * out.stiffness)) {
    p_in =
        (by_in * in.impulse + by_out * (out.impulse - law.offset) - speed(s, in) - speed(s, out)) /
        by_both;
  }
  p_in = std::max({p_in, 0.0, -law.offset / law.factor});
  set_impulse(s, in, p_in);
  set_impulse(s, out, std::max(0.0, law.factor * p_in + law.offset));
  return std::max(-speed(s, out), std::min(speed(s, in), 0.0));
}

void relax_run(World& world, Run& run, double coupled) {
  SweepScratch& s = world.scratch.sweeps;
  const CapstanScratch& capstan = world.scratch.active_set.capstan;
  SweepRow &in = s.rows[index(run.row_in)], &out = s.rows[index(run.row_out)];
  slide(s, capstan, run, 0.0);
  run.slip = Slip::stick;
  relax_sticking(s, in, out, coupled);
  if (run.passages_begin == run.passages_end) return;
  for (const Slip slip : {Slip::forward, Slip::backward}) {
    const int way = static_cast<int>(slip);
    const SlidingLaw law = sliding_law(s, capstan, run, way);
    if (!(way * (out.impulse - law.factor * in.impulse - law.offset) > 0.0)) continue;
    run.slip = slip;
    slide(s, capstan, run, relax_sliding(s, in, out, coupled, law));
    return;
  }
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
  for (std::size_t i = 0; i < runs.size(); ++i) relax_run(world, runs[i], s.coupling[i]);
  for (std::size_t r = contacts; r < s.rows.size(); ++r) relax(s, s.rows[r]);
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
  unload(world);
  store_states(world, kick);
  store_middles(world);
}

}  // namespace pinchlab
