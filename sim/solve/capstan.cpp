// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/capstan.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/parts.h"
#include "sim/solve/solve_scratch.h"

namespace pinchlab {

namespace {

void add_to(std::vector<Term>& expression, int unknown, double coefficient) {
  if (unknown < 0 || coefficient == 0.0) return;
  for (Term& term : expression) {
    if (term.index == unknown) {
      term.coefficient += coefficient;
      return;
    }
  }
  expression.push_back({unknown, coefficient});
}

/// Tension after a passage (sliding_terms) from that before it, or (upstream) the other way; s = +1
/// where the material slides forward. An arc has no pinch, nor a pinch an arc, so that the order
/// does not matter.
void pass(const SolveScratch& set, const Passage& passage, int s, bool upstream,
          std::vector<Term>& expression) {
  if (passage.factor != 1.0) {
    const double factor = sliding_terms(passage, upstream ? -s : s).before;
    for (Term& term : expression) term.coefficient *= factor;
  }
  const double way = upstream ? -1.0 : 1.0;
  if (passage.normal >= 0) {
    add_to(expression, set.unknown_of_row[index(passage.normal)],
           way * sliding_terms(passage, s).pressed);
  }
  if (passage.middle >= 0) {
    for (int k = set.impulse_begin[index(passage.middle)];
         k < set.impulse_end[index(passage.middle)]; ++k) {
      const Term& term = set.impulse_terms[index(k)];
      add_to(expression, term.index, -way * term.coefficient);
    }
  }
}

void pass_run(const SolveScratch& set, const Run& run, bool upstream,
              std::vector<Term>& expression) {
  const int count = run.passages_end - run.passages_begin;
  for (int k = 0; k < count; ++k) {
    const int i = upstream ? run.passages_end - 1 - k : run.passages_begin + k;
    pass(set, at(set.capstan.passages, i), sign(run.slip), upstream, expression);
  }
}

void store(SolveScratch& set, int row, const std::vector<Term>& expression) {
  set.impulse_begin[index(row)] = static_cast<int>(set.impulse_terms.size());
  set.impulse_terms.insert(set.impulse_terms.end(), expression.begin(), expression.end());
  set.impulse_end[index(row)] = static_cast<int>(set.impulse_terms.size());
}

/// The tension after the run if it slid in direction `way` everywhere, for the impulses just
/// solved. Cable is pushed in pinches only: what would have to be pushed along an arc slides on to
/// it or, seen from the other end, lies on it without tension.
double sliding_limit(const PartSystem& system, const CapstanScratch& s, const Run& run, int way,
                     double tension_in, double tolerance) {
  const auto impulse = [&system](int row) { return row >= 0 ? at(system.rows, row).impulse : 0.0; };
  double t = tension_in;
  for (int k = run.passages_begin; k < run.passages_end; ++k) {
    const Passage& p = at(s.passages, k);
    if (is_arc(p) && t < -tolerance) t = way > 0 ? -infinity : 0.0;
    t = tension_after(p, way, t, impulse(p.normal), impulse(p.middle));
  }
  return t;
}

/// Which way a run that sticks has to slide for these tensions (N s) before and after it.
Slip way_to_slide(const PartSystem& system, const CapstanScratch& s, const Run& run, double in,
                  double out, double tolerance) {
  if (out > sliding_limit(system, s, run, 1, in, tolerance) + tolerance) return Slip::forward;
  if (out < sliding_limit(system, s, run, -1, in, tolerance) - tolerance) return Slip::backward;
  return Slip::stick;
}

/// The same for the present solution. An elastic cable slides by as much as its tensions ask for at
/// the interval's end, which may not be what the kick's mean tensions ask for: only where both ask
/// for the same way is that the way in which it then slides.
Slip way_to_slide(const PartSystem& system, const CapstanScratch& s, const Run& run,
                  double tolerance) {
  const Slip way = way_to_slide(system, s, run, at(system.rows, run.row_in).impulse,
                                at(system.rows, run.row_out).impulse, tolerance);
  if (way == Slip::stick || s.end_impulse.empty()) return way;
  const Slip at_end = way_to_slide(system, s, run, at(s.end_impulse, run.row_in),
                                   at(s.end_impulse, run.row_out), tolerance);
  return at_end == way ? way : Slip::stick;
}

Run make_run(const World& world, int cable, int first, int last) {
  const Link& link = at(at(world.cables, cable).links, first);
  const double mu = at(world.bodies, link.body).cable_friction;
  Run run;
  run.cable = cable;
  run.first_link = first;
  run.last_link = last;
  run.frictionless = mu == 0.0;
  run.slip = run.frictionless ? Slip::forward : mu == infinity ? Slip::stick : link.slip;
  return run;
}

/// Whether the segment that arrives at the link is inside a run.
bool begins_within_run(const CableState& cable, int link) {
  const Link &to = at(cable.links, link), &from = at(cable.links, previous_link(cable, link));
  return to.pinch_middle || from.pinch_middle || is_side(from, to);
}

/// The last link of the run that begins with link `first`; adds the links after that to `seen`.
int last_of_run(const CableState& cable, int first, bool link_by_link, int& seen) {
  int last = first;
  while (true) {
    const int after = next_link(cable, last);
    const Link& link = at(cable.links, after);
    if (link.pinch_middle && !link_by_link) {
      last = next_link(cable, after);
      seen += 2;
    } else if (link.corner >= 0 && link.body == at(cable.links, last).body) {
      last = after;  // along a side
      seen += 1;
    } else {
      return last;
    }
  }
}

/// Lets those stick that have friction, whatever that must bear.
void hold_rough(CapstanScratch& s) {
  for (Run& run : s.runs) {
    if (run.frictionless) continue;
    run.slip = Slip::stick;
    run.frozen = true;
  }
}

/// Takes friction off all runs that may slide.
void smooth(CapstanScratch& s) {
  for (Passage& passage : s.passages) {
    passage.factor = 1.0;
    passage.friction = 0.0;
  }
  for (Run& run : s.runs) {
    if (run.passages_begin == run.passages_end) continue;
    run.frictionless = true;
    run.slip = Slip::forward;
  }
}

}  // namespace

void find_runs(const World& world, const Parts& parts, const Part& part, PartSystem& system,
               SolveScratch& scratch) {
  CapstanScratch& s = scratch.capstan;
  const bool link_by_link = world.configuration.pinch_rows == PinchRows::three &&
                            world.configuration.solver == Solver::direct;
  s.runs.clear();
  s.passages.clear();
  s.segments.clear();
  s.run_before.clear();
  s.cable_begin.assign(1, 0);
  for (Friction& friction : system.frictions) friction.run = -1;  // of a solve before
  if (!part.may_slide) return;
  list_pressing(world, parts, part, s.pressing);
  const std::span<const int> cables = cables_of(parts, part);
  for (std::size_t place = 0; place < cables.size(); ++place) {
    const int c = cables[place];
    const CableState& cable = at(world.cables, c);
    if (!slides_without_mass(world, cable)) continue;
    const int begin = system.segment_begin[place];
    const int* row_of_segment = system.row_of_segment.data() + begin;
    const auto row_of = [row_of_segment](int segment) { return row_of_segment[segment]; };
    const int count = static_cast<int>(cable.links.size());
    // Start a closed cable outside of any pinch, an open one at the first segment that bears
    // tension: before it it may lie along many sides of the polygon that holds its start.
    int start = cable.closed ? 0 : 1;
    while (cable.closed && begins_within_run(cable, start)) ++start;
    while (start < count && row_of(start) < 0) ++start;
    if (start == count) continue;
    int run_before = -1;
    const std::size_t first_of_cable = s.segments.size();
    for (int segment = start, seen = 0; seen < count; ++seen) {
      s.segments.push_back(row_of(segment));
      s.run_before.push_back(run_before);
      const int first = segment;
      if (cable.links[index(first)].orientation == 0) break;  // the end of an open cable
      const int last = last_of_run(cable, first, link_by_link, seen);
      segment = next_link(cable, last);
      if (row_of(segment) < 0) break;  // wound up here: the end is fast
      Run run = make_run(world, c, first, last);
      run.passages_begin = static_cast<int>(s.passages.size());
      if (at(world.bodies, at(cable.links, first).body).cable_friction < infinity) {
        append_passages(world, system, scratch, c, first, last, begin,
                        static_cast<int>(s.runs.size()), s.passages);
      }
      run.passages_end = static_cast<int>(s.passages.size());
      run.row_in = row_of(first);
      run.row_out = row_of(segment);
      run_before = static_cast<int>(s.runs.size());
      s.runs.push_back(run);
    }
    if (cable.closed) s.run_before[first_of_cable] = run_before;
    s.cable_begin.push_back(static_cast<int>(s.segments.size()));
  }
  if (scratch.smooth) smooth(s);
  if (scratch.held) hold_rough(s);
}

namespace {

/// Makes a run stick, for the next solve at least.
void hold(SolveScratch& scratch, int run) {
  at(scratch.capstan.runs, run).slip = Slip::stick;
  at(scratch.capstan.runs, run).flipped = scratch.solves + 1;
}

/// Whether of two runs, one of which must stick, it is the first: the one that has kept its state
/// longer, or holds better, by the factor of tensions that its arcs allow.
bool holds_before(const CapstanScratch& s, const Run& one, const Run& other) {
  const auto factor = [&s](const Run& run) {
    double product = 1.0;
    for (int k = run.passages_begin; k < run.passages_end; ++k) product *= at(s.passages, k).factor;
    return product;
  };
  if (one.flipped != other.flipped) return one.flipped < other.flipped;
  return factor(one) > factor(other);
}

/// The first of a cable's segments, of which there are `count` from `begin` on, before which
/// something sticks. Where nothing does a closed cable is cut: at a run that is to stick, or, where
/// there is no friction at all, at its first.
int find_start(SolveScratch& scratch, int begin, int count) {
  const CapstanScratch& s = scratch.capstan;
  int oldest = -1;
  for (int k = 0; k < count; ++k) {
    const int number = at(s.run_before, begin + k);
    if (number < 0 || at(s.runs, number).slip == Slip::stick) return k;
    const Run& run = at(s.runs, number);
    if (run.frictionless) continue;
    if (oldest < 0 || holds_before(s, run, at(s.runs, at(s.run_before, begin + oldest))))
      oldest = k;
  }
  if (oldest < 0) return 0;
  hold(scratch, at(s.run_before, begin + oldest));
  return oldest;
}

void part_slack_segments(const PartSystem& system, SolveScratch& scratch, int begin, int count,
                         int start) {
  CapstanScratch& s = scratch.capstan;
  bool slack_before = false;
  int oldest = -1;
  for (int k = 0; k < count; ++k) {
    const int position = begin + (start + k) % count;
    const int number = s.run_before[index(position)];
    if (k > 0) {
      const Run& run = s.runs[index(number)];
      if (run.slip == Slip::stick) {
        slack_before = false;
        oldest = -1;
      } else if (!run.frictionless && (oldest < 0 || run.flipped < s.runs[index(oldest)].flipped)) {
        oldest = number;
      }
    }
    if (at(system.rows, s.segments[index(position)]).on) continue;
    if (slack_before && oldest >= 0) hold(scratch, oldest);
    slack_before = true;
    oldest = -1;
  }
}

}  // namespace

void make_groups(const PartSystem& system, SolveScratch& scratch) {
  CapstanScratch& s = scratch.capstan;
  s.groups.clear();
  s.members.clear();
  s.member_runs.clear();
  s.group_of_row.assign(system.rows.size(), -1);
  for (Run& run : s.runs) run.joins = false;
  for (std::size_t c = 0; c + 1 < s.cable_begin.size(); ++c) {
    const int begin = s.cable_begin[c], count = s.cable_begin[c + 1] - begin;
    const int start = find_start(scratch, begin, count);
    part_slack_segments(system, scratch, begin, count, start);
    for (int k = 0; k < count; ++k) {
      const int position = begin + (start + k) % count;
      const int row = s.segments[index(position)], run = s.run_before[index(position)];
      const bool slack = !at(system.rows, row).on;
      const bool sticks = k == 0 || s.runs[index(run)].slip == Slip::stick;
      // A second slack segment ends the group: what lies between two slack ones bears no tension.
      if (sticks || (slack && s.groups.back().slack >= 0)) {
        if (k > 0) s.groups.back().run_after = run;
        s.groups.push_back({});
        s.groups.back().begin = static_cast<int>(s.members.size());
        s.groups.back().run_before = run;
      }
      Group& group = s.groups.back();
      const int member = static_cast<int>(s.members.size());
      if (slack) group.slack = member;
      s.members.push_back(row);
      s.member_runs.push_back(member == group.begin ? -1 : run);
      if (member > group.begin) s.runs[index(run)].joins = true;
      s.group_of_row[index(row)] = static_cast<int>(s.groups.size()) - 1;
      group.end = member + 1;
    }
  }
}

void express_impulses(SolveScratch& set) {
  CapstanScratch& s = set.capstan;
  for (const Group& group : s.groups) {
    // From the slack member, where tension is zero, or from the first, whose tension is the
    // unknown.
    const int base = group.slack >= 0 ? group.slack : group.begin;
    std::vector<Term>& t = s.expression;
    t.clear();
    if (group.slack < 0) add_to(t, set.unknown_of_row[index(s.members[index(base)])], 1.0);
    store(set, s.members[index(base)], t);
    for (int m = base + 1; m < group.end; ++m) {
      pass_run(set, s.runs[index(s.member_runs[index(m)])], false, t);
      store(set, s.members[index(m)], t);
    }
    t.clear();
    for (int m = base; m > group.begin; --m) {
      pass_run(set, s.runs[index(s.member_runs[index(m)])], true, t);
      store(set, s.members[index(m - 1)], t);
    }
  }
}

// With w the rows' speeds without sliding and sigma the sliding speeds, a taut segment needs
// w = sigma_head - sigma_tail and a middle body that sticks needs w = -sigma of its run. Summing
// the rows from one sticking place to the next (with the middle rows at both ends) cancels every
// sigma.
//
// That is the system of all tensions and sliding speeds, eliminated by hand: the row of a taut
// segment for the sliding speed at its head, the law of a run for the tension after it, each with a
// pivot of 1, and what is left for the first tension of the group. Factored as it stands, that
// system has zeros on its diagonal wherever neither body of a span can give, and needs pivoting.
void add_group_equations(PartSystem& system, SolveScratch& set) {
  CapstanScratch& s = set.capstan;
  s.slack_terms.clear();
  for (Group& group : s.groups) {
    s.sums.clear();
    s.sums_begin.assign(1, 0);
    s.borders.clear();
    int slack_sum = -1;
    for (int m = group.begin; m < group.end; ++m) {
      if (s.member_runs[index(m)] >= 0) {
        const Run& run = s.runs[index(s.member_runs[index(m)])];
        for (int k = run.passages_begin; k < run.passages_end; ++k) {
          const int middle = s.passages[index(k)].middle;
          if (middle < 0 || set.unknown_of_row[index(middle)] < 0) continue;
          at(system.frictions, at(system.rows, middle).friction).in_group_equation = true;
          s.sums.push_back({middle, 1.0});
          s.borders.push_back(set.unknown_of_row[index(middle)]);
          s.sums_begin.push_back(static_cast<int>(s.sums.size()));
          s.sums.push_back({middle, -1.0});
        }
      }
      if (m == group.slack) slack_sum = static_cast<int>(s.borders.size());
      s.sums.push_back({s.members[index(m)], 1.0});
    }
    s.sums_begin.push_back(static_cast<int>(s.sums.size()));

    const int base = slack_sum >= 0 ? slack_sum : 0;
    const int base_unknown = set.unknown_of_row[index(s.members[index(group.begin)])];
    for (int j = 0; j + 1 < static_cast<int>(s.sums_begin.size()); ++j) {
      const int unknown = j == base ? base_unknown : s.borders[index(j < base ? j : j - 1)];
      const double way = j > base ? -1.0 : 1.0;
      const bool slack = j == slack_sum;
      if (slack) group.slack_begin = static_cast<int>(s.slack_terms.size());
      for (int k = s.sums_begin[index(j)]; k < s.sums_begin[index(j + 1)]; ++k) {
        const Term& term = s.sums[index(k)];
        if (slack) {
          s.slack_terms.push_back(term);
        } else if (unknown >= 0) {
          set.equation_terms.push_back({unknown, term.index, way * term.coefficient});
        }
      }
      if (slack) group.slack_end = static_cast<int>(s.slack_terms.size());
    }
  }
}

Shortage shortage_of(const Group& group, const PartSystem& system, const CapstanScratch& s) {
  Shortage shortage;
  const auto add = [&](int number, double coefficient) {
    const Row& row = at(system.rows, number);
    shortage.speed -= coefficient * row.speed;
    shortage.clearance += coefficient * row.clearance;
    shortage.gives = shortage.gives || row.diagonal > 0.0;
    if (row.stretches) shortage.clearance = infinity;
  };
  if (group.slack >= 0) {
    for (int k = group.slack_begin; k < group.slack_end; ++k) {
      add(at(s.slack_terms, k).index, at(s.slack_terms, k).coefficient);
    }
  } else {
    for (int m = group.begin; m < group.end; ++m) add(at(s.members, m), 1.0);
  }
  if (group.run_before >= 0) shortage.speed -= at(s.runs, group.run_before).speed;
  if (group.run_after >= 0) shortage.speed += at(s.runs, group.run_after).speed;
  return shortage;
}

bool may_bear(const Group& group, const Shortage& shortage, const PartSystem& system,
              const SolveScratch& set) {
  if (set.reach > -infinity) return shortage.clearance <= set.reach;
  return group.slack < 0 || !at(system.rows, at(set.capstan.members, group.slack)).idle;
}

namespace {

/// Where no body of a group can give, its neighbours on the cable may: runs at its ends begin to
/// slide, if they can, so that material comes to it. Returns whether any of them can.
bool slides_to(const Group& group, SolveScratch& set) {
  bool any = false;
  for (const auto& [number, slip] :
       {std::pair(group.run_before, Slip::forward), std::pair(group.run_after, Slip::backward)}) {
    if (number < 0) continue;
    const Run& run = at(set.capstan.runs, number);
    if (run.frozen || run.passages_begin == run.passages_end) continue;
    if (run.slip == Slip::stick) set.flips.push_back({number, true, true, slip});
    any = true;
  }
  return any;
}

/// Whether what slides bears force: tension, or where it has none what one body in a pinch rubs on
/// it and the other holds.
bool rubs_on(const PartSystem& system, const CapstanScratch& s, const Run& run, double tolerance) {
  if (bears(at(system.rows, run.row_out), tolerance)) return true;
  if (bears(at(system.rows, run.row_in), tolerance)) return true;
  for (int k = run.passages_begin; k < run.passages_end; ++k) {
    const int middle = at(s.passages, k).middle;
    if (middle >= 0 && std::abs(at(system.rows, middle).impulse) > tolerance) return true;
  }
  return false;
}

}  // namespace

void check_runs(const PartSystem& system, SolveScratch& set, double speed_tolerance,
                double impulse_tolerance) {
  const std::vector<Row>& rows = system.rows;
  CapstanScratch& s = set.capstan;
  slip_speeds(system, set);
  for (const Group& group : s.groups) {
    if (group.slack >= 0) {
      // A member between bodies that cannot move gets taut like any other: the rest of the group
      // gives way.
      const Shortage shortage = shortage_of(group, system, s);
      const int row = s.members[index(group.slack)];
      if (shortage.speed > speed_tolerance && may_bear(group, shortage, system, set) &&
          (shortage.gives || slides_to(group, set))) {
        set.flips.push_back({row, false, true, Slip::stick});
      }
    }
    // The member that would be pushed hardest goes slack.
    int worst = -1;
    double least = -impulse_tolerance;
    for (int m = group.begin; m < group.end; ++m) {
      const Row& row = rows[index(s.members[index(m)])];
      if (row.impulse < least && !row.clamped) {
        least = row.impulse;
        worst = s.members[index(m)];
      }
    }
    if (worst >= 0) set.flips.push_back({worst, false, false, Slip::stick});
  }
  for (std::size_t i = 0; i < s.runs.size(); ++i) {
    const Run& run = s.runs[i];
    if (run.frictionless || run.frozen || run.passages_begin == run.passages_end) continue;
    const int number = static_cast<int>(i);
    if (run.slip != Slip::stick) {
      const bool rubs = rubs_on(system, s, run, impulse_tolerance);
      const bool against = sign(run.slip) * run.speed < -speed_tolerance;
      if (rubs && against) set.flips.push_back({number, true, true, Slip::stick});
      continue;
    }
    const Slip way = way_to_slide(system, s, run, impulse_tolerance);
    if (way == Slip::stick) continue;
    constexpr int patience = 20;  // solves, before what slides is tried anew (active_set.cpp): only
                                  // what then circles still is jammed
    const Slip slip = set.solves <= patience ? way : way_to_try(way, run.slid);
    set.flips.push_back({number, true, true, slip});
  }
}

}  // namespace pinchlab
