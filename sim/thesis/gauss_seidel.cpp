// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/thesis/gauss_seidel.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/solve/friction.h"
#include "sim/solve/solve_scratch.h"
#include "sim/thesis/sweep_scratch.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

/// Share of a position error that one step makes up: the thesis' biases.
constexpr double segment_gain = 0.2, contact_gain = 0.7;

/// What a sweep works on.
struct Sweep {
  SweepScratch& own;
  CapstanScratch& capstan;
  PartSystem& system;
};

/// The bias of a row with the thesis' gain on what it has to make up. Rebounds and springs are no
/// errors: they keep theirs.
double steered_bias(const Row& row) {
  if (row.rebounds || row.compliance > 0.0) return row.bias;
  if (row.kind == RowKind::pinch_middle) return segment_gain * row.bias;
  const double gain = row.kind == RowKind::segment ? segment_gain : contact_gain;
  return row.bias < 0.0 ? gain * row.bias : row.bias;
}

SweepRow sweep_row(const PartSystem& system, std::size_t number) {
  const Row& row = system.rows[number];
  const RowBodies& bodies = system.bodies[number];
  SweepRow r;
  r.a = bodies.a;
  r.b = bodies.b;
  r.ja = bodies.ja;
  r.jb = bodies.jb;
  r.response_a = at(system.mobility, r.a) * r.ja;
  r.response_b = at(system.mobility, r.b) * r.jb;
  r.by_run = false;
  r.clamp = Clamp::tension;
  r.bound = 0.0;
  if (row.clamped) {
    r.clamp = Clamp::friction;
    r.bound = infinity;
  } else if (row.friction >= 0) {
    const Friction& friction = at(system.frictions, row.friction);
    r.clamp = Clamp::friction;
    r.other = friction.normal;
    r.bound = friction.coefficient;
  }
  r.bias = steered_bias(row);
  r.compliance = row.compliance;
  r.third = row.has_third ? row.item : -1;
  r.stiffness = row.diagonal > 0.0 ? row.diagonal + row.compliance : 0.0;
  r.impulse = 0.0;
  return r;
}

void load(const Sweep& s) {
  s.own.rows.clear();
  for (std::size_t r = 0; r < s.system.rows.size(); ++r) {
    s.own.rows.push_back(sweep_row(s.system, r));
  }
  for (Run& run : s.capstan.runs) {
    at(s.own.rows, run.row_in).by_run = at(s.own.rows, run.row_out).by_run = true;
    run.speed = 0.0;
    run.slip = Slip::stick;
    for (int k = run.passages_begin; k < run.passages_end; ++k) {
      const Passage& p = at(s.capstan.passages, k);
      if (p.middle_out < 0) continue;
      SweepRow &middle = at(s.own.rows, p.middle), &middle_out = at(s.own.rows, p.middle_out);
      middle.clamp = middle_out.clamp = Clamp::middle;
      middle.other = p.middle_out;
      middle_out.other = p.middle;
    }
  }
}

double speed(const Sweep& s, const SweepRow& row) {
  const double of_two = row.ja.dot(at(s.system.velocity, row.a)) +
                        row.jb.dot(at(s.system.velocity, row.b)) + row.bias +
                        row.compliance * row.impulse;
  if (row.third < 0) return of_two;
  const ThirdBody& third = at(s.system.thirds, row.third);
  return of_two + third.j.dot(at(s.system.velocity, third.place));
}

void set_impulse(const Sweep& s, SweepRow& row, double impulse) {
  const double change = impulse - row.impulse;
  at(s.system.velocity, row.a) += change * row.response_a;
  at(s.system.velocity, row.b) += change * row.response_b;
  if (row.third >= 0) {
    const ThirdBody& third = at(s.system.thirds, row.third);
    at(s.system.velocity, third.place) += change * third.response;
  }
  row.impulse = impulse;
}

double unclamped(const Sweep& s, const SweepRow& row) {
  return row.impulse - speed(s, row) / row.stiffness;
}

/// Most that a friction row may bear at the present force on it.
double most_of(const Sweep& s, const SweepRow& row) {
  const double force = row.other >= 0 ? at(s.own.rows, row.other).impulse : infinity;
  return most_friction(row.bound, force);
}

void relax(const Sweep& s, SweepRow& row) {
  if (row.stiffness == 0.0) return;
  double least = 0.0, most = infinity;
  if (row.clamp == Clamp::friction) {
    most = most_of(s, row);
    least = -most;
  } else if (row.clamp == Clamp::middle) {
    most = at(s.own.rows, row.other).impulse + row.bound;
  }
  set_impulse(s, row, std::clamp(unclamped(s, row), least, most));
}

/// What the middle body of a pinch takes from the tension.
double middle_impulse(const Sweep& s, const Passage& p) {
  const double out = p.middle_out >= 0 ? at(s.own.rows, p.middle_out).impulse : 0.0;
  return at(s.own.rows, p.middle).impulse - out;
}

/// Lets the material slide over the run's body at another speed, and with it through the pinches.
void slide(const Sweep& s, Run& run, double speed) {
  const double change = speed - run.speed;
  run.speed = speed;
  at(s.own.rows, run.row_in).bias -= change;
  at(s.own.rows, run.row_out).bias += change;
  for (int k = run.passages_begin; k < run.passages_end; ++k) {
    const Passage& p = at(s.capstan.passages, k);
    if (p.middle >= 0) at(s.own.rows, p.middle).bias += change;
    if (p.middle_out >= 0) at(s.own.rows, p.middle_out).bias -= change;
  }
}

/// p_out = factor * p_in + offset where the material slides `way` (1 forward, -1 backward).
struct SlidingLaw {
  double factor = 1.0, offset = 0.0;
};

SlidingLaw sliding_law(const Sweep& s, const Run& run, int way) {
  constexpr double largest = 1e250;  // tells as well as infinity that the cable sticks
  SlidingLaw law;
  for (int k = run.passages_begin; k < run.passages_end; ++k) {
    const Passage& p = at(s.capstan.passages, k);
    const SlidingTerms terms = sliding_terms(p, way);
    law.factor = std::clamp(law.factor * terms.before, 1.0 / largest, largest);
    law.offset = std::clamp(law.offset * terms.before, -largest, largest);
    if (p.normal >= 0) law.offset += terms.pressed * at(s.own.rows, p.normal).impulse;
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
void relax_run(const Sweep& s, Run& run) {
  SweepRow &in = at(s.own.rows, run.row_in), &out = at(s.own.rows, run.row_out);
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
      return speed_for_law(in, out, p_in, p_out, sliding_law(s, run, way), run.speed);
    };
    const double forward = to_law(1), backward = to_law(-1);
    if (forward > 0.0 && backward >= 0.0) slip = forward;
    if (backward < 0.0 && forward <= 0.0) slip = backward;
  }
  run.slip = slip > 0.0 ? Slip::forward : slip < 0.0 ? Slip::backward : Slip::stick;
  slide(s, run, slip);
}

/// What the middle bodies of pinches can hold while the tensions before and after the run are what
/// they are.
///
/// One row: friction of the contact's force; on a cable that is slack on both sides friction passes
/// from body to body, as much as the smoother of the two allows. Three rows: tensions t1 before
/// and t2 after the middle body within t1 / f <= t2 <= f t1. With u1 and u2 the largest that they
/// can be, all arcs holding as much as they can, t1 - t2 is at most both u1 (1 - 1/f) and
/// u2 (f - 1), and t2 - t1 the like.
void bound_middles(const Sweep& s, const Run& run) {
  double tension = at(s.own.rows, run.row_in).impulse;
  const bool slack = tension == 0.0 && at(s.own.rows, run.row_out).impulse == 0.0;
  for (int k = run.passages_begin; k < run.passages_end; ++k) {
    const Passage& p = at(s.capstan.passages, k);
    tension *= p.factor;
    if (p.middle < 0) continue;
    if (p.middle_out >= 0) {
      at(s.own.rows, p.middle).bound = tension * (1.0 - 1.0 / p.middle_factor);
      at(s.own.rows, p.middle_out).bound = tension * (p.middle_factor - 1.0);
    } else {
      const int friction = at(s.system.rows, p.middle).friction;
      at(s.own.rows, p.middle).bound = bound_in_force(at(s.system.frictions, friction), slack);
    }
    tension = std::max(0.0, tension - middle_impulse(s, p));
  }
  tension = at(s.own.rows, run.row_out).impulse;
  for (int k = run.passages_end - 1; k >= run.passages_begin; --k) {
    const Passage& p = at(s.capstan.passages, k);
    tension *= p.factor;
    if (p.middle_out < 0) continue;
    SweepRow &middle = at(s.own.rows, p.middle), &middle_out = at(s.own.rows, p.middle_out);
    middle.bound = std::min(middle.bound, tension * (p.middle_factor - 1.0));
    middle_out.bound = std::min(middle_out.bound, tension * (1.0 - 1.0 / p.middle_factor));
    tension = std::max(0.0, tension + middle_impulse(s, p));
  }
}

/// All rows of cables, then all rows of contacts, in their order.
void sweep(const Sweep& s) {
  for (const Run& run : s.capstan.runs) bound_middles(s, run);
  const std::size_t contacts = index(s.system.first_contact_row);
  for (std::size_t r = 0; r < contacts; ++r) {
    if (!s.own.rows[r].by_run) relax(s, s.own.rows[r]);
  }
  for (Run& run : s.capstan.runs) relax_run(s, run);
  for (std::size_t r = contacts; r < s.own.rows.size(); ++r) relax(s, s.own.rows[r]);
}

/// Sweeps that end before they have converged may leave a run sliding against its friction. It
/// then sticks for this step: friction must not drive what it should brake.
void stop_driven_runs(const Sweep& s) {
  for (Run& run : s.capstan.runs) {
    const double in = at(s.own.rows, run.row_in).impulse, out = at(s.own.rows, run.row_out).impulse;
    if (run.frictionless || (in == 0.0 && out == 0.0)) continue;
    double gained = out - in;
    for (int k = run.passages_begin; k < run.passages_end; ++k) {
      const Passage& p = at(s.capstan.passages, k);
      if (p.middle >= 0) gained += middle_impulse(s, p);
    }
    if (run.speed * gained >= 0.0) continue;
    slide(s, run, 0.0);
    run.slip = Slip::stick;
  }
}

/// Impulses and states. The rows' speeds are those that the unsteered rows see.
void unload(const Sweep& s) {
  for (std::size_t r = 0; r < s.own.rows.size(); ++r) {
    Row& row = s.system.rows[r];
    const double p = row.impulse = s.own.rows[r].impulse;
    row.speed = row_speed(s.system, r) + row.compliance * p;
    if (row.friction >= 0) {
      const double most = most_of(s, s.own.rows[r]);
      row.on = most > 0.0;
      row.slip = slip_of(p, most);
    } else {
      row.on = p > 0.0;
    }
  }
}

}  // namespace

void solve_iterative(const World& world, const Parts& parts, const Part& part, PartSystem& system,
                     SolveScratch& scratch, SweepScratch& sweeps) {
  system.velocity = system.free_velocity;
  scratch.solves = 0;
  scratch.capstan.runs.clear();
  if (system.rows.empty()) return;
  find_runs(world, parts, part, system, scratch);
  const Sweep s{sweeps, scratch.capstan, system};
  load(s);
  for (int k = 0; k < world.configuration.iterations; ++k) sweep(s);
  stop_driven_runs(s);
  unload(s);
}

void store_middles(const PartSystem& system, const SolveScratch& scratch,
                   const SweepScratch& sweeps, World& world) {
  for (const Run& run : scratch.capstan.runs) {
    for (int k = run.passages_begin; k < run.passages_end; ++k) {
      const Passage& p = at(scratch.capstan.passages, k);
      if (p.middle_out < 0) continue;
      const Row& row = at(system.rows, p.middle);
      const SweepRow &middle = at(sweeps.rows, p.middle), &out = at(sweeps.rows, p.middle_out);
      Link& link = at(at(world.cables, row.index).links, row.item);
      const double held = middle.impulse - out.impulse;
      if (held >= middle.bound) {
        link.slip = Slip::backward;
      } else if (-held >= out.bound) {
        link.slip = Slip::forward;
      } else {
        link.slip = Slip::stick;
      }
      link.slip_speed = link.slip == Slip::stick ? 0.0 : row.speed + run.speed;
    }
  }
}

}  // namespace pinchlab
