// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/capstan.h"

#include <algorithm>
#include <cmath>

#include "sim/cable.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

/// Beyond this exponent no double tells the ratio from infinity in a product with a tension.
constexpr double largest_exponent = 600.0;

int sign(Slip slip) {
  return static_cast<int>(slip);
}

/// The transitional pinch of segment s, as seen by a body of friction mu at one of its ends.
void add_pressed_end(const Scratch& scratch, const World& world, const Segment& segment, double mu,
                     std::vector<Passage>& passages) {
  if (segment.contact < 0 || mu == 0.0) return;
  Passage passage;
  passage.normal = scratch.normal_row_of_contact[index(segment.contact)];
  passage.friction = mu / std::max(1, world.contacts[index(segment.contact)].pinch_points);
  passages.push_back(passage);
}

Run make_run(const Scene& scene, World& world, int c, int first, int last) {
  Scratch& scratch = world.scratch;
  CapstanScratch& s = scratch.active_set.capstan;
  const CableState& cable = world.cables[index(c)];
  const Link& link = cable.links[index(first)];
  const double mu = scene.bodies[index(link.body)].cable_friction;
  const bool three = world.configuration.pinch_rows == PinchRows::three;
  const auto factor = [](double friction, double arc) {
    return std::exp(std::min(friction * arc, largest_exponent));
  };
  const auto row_of = [&scratch, c](int segment) {
    return scratch.row_of_segment[index(scratch.segment_begin[index(c)] + segment)];
  };
  Run run;
  run.cable = c;
  run.first_link = first;
  run.last_link = last;
  run.frictionless = mu == 0.0;
  run.slip = run.frictionless ? Slip::forward : mu == infinity ? Slip::stick : link.slip;
  run.passages_begin = run.passages_end = static_cast<int>(s.passages.size());
  if (mu == infinity) return run;
  if (!three) add_pressed_end(scratch, world, cable.segments[index(first)], mu, s.passages);
  for (int i = first;; i = next_link(cable, i)) {
    const Link& part = cable.links[index(i)];
    Passage passage;
    if (part.pinch_middle && first == last) {
      passage.factor = factor(mu, middle_arc);
    } else if (part.pinch_middle) {
      passage.middle = row_of(i);
      if (three) {
        passage.middle_out = row_of(next_link(cable, i));
        passage.middle_factor = factor(scene.bodies[index(part.body)].cable_friction, middle_arc);
      } else {
        scratch.rows[index(passage.middle)].run = static_cast<int>(s.runs.size());
      }
      if (part.contact >= 0 && !three) {
        passage.normal = scratch.normal_row_of_contact[index(part.contact)];
        passage.friction = mu / std::max(1, world.contacts[index(part.contact)].pinch_points);
      }
    } else {
      passage.factor = factor(mu, std::max(part.wrap, 0.0));
    }
    s.passages.push_back(passage);
    if (i == last) break;
  }
  const int after = next_link(cable, last);
  if (!three) add_pressed_end(scratch, world, cable.segments[index(after)], mu, s.passages);
  run.passages_end = static_cast<int>(s.passages.size());
  return run;
}

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

/// Tension after a sliding passage from that before it, or (upstream) the other way:
///     arc: T_after = factor^s T_before;   pinch: T_after = T_before + s friction N - tau,
/// s = +1 where the material slides forward, tau the middle body's share.
void pass(const World& world, const Passage& passage, int s, bool upstream,
          std::vector<Term>& expression) {
  const ActiveSet& set = world.scratch.active_set;
  if (passage.factor != 1.0) {
    const double factor = (s > 0) != upstream ? passage.factor : 1.0 / passage.factor;
    for (Term& term : expression) term.coefficient *= factor;
  }
  const double way = upstream ? -1.0 : 1.0;
  if (passage.normal >= 0) {
    add_to(expression, set.unknown_of_row[index(passage.normal)], way * s * passage.friction);
  }
  if (passage.middle >= 0) {
    for (int k = set.impulse_begin[index(passage.middle)];
         k < set.impulse_end[index(passage.middle)]; ++k) {
      const Term& term = set.impulse_terms[index(k)];
      add_to(expression, term.index, -way * term.coefficient);
    }
  }
}

void pass_run(const World& world, const Run& run, bool upstream, std::vector<Term>& expression) {
  const CapstanScratch& s = world.scratch.active_set.capstan;
  const int count = run.passages_end - run.passages_begin;
  for (int k = 0; k < count; ++k) {
    const int i = upstream ? run.passages_end - 1 - k : run.passages_begin + k;
    pass(world, s.passages[index(i)], sign(run.slip), upstream, expression);
  }
}

void store(ActiveSet& set, int row, const std::vector<Term>& expression) {
  set.impulse_begin[index(row)] = static_cast<int>(set.impulse_terms.size());
  set.impulse_terms.insert(set.impulse_terms.end(), expression.begin(), expression.end());
  set.impulse_end[index(row)] = static_cast<int>(set.impulse_terms.size());
}

/// The tension after the run if it slid in direction `s` everywhere, for the impulses just solved.
double sliding_limit(const World& world, const Run& run, int s) {
  const auto& rows = world.scratch.rows;
  double t = rows[index(run.row_in)].impulse;
  for (int k = run.passages_begin; k < run.passages_end; ++k) {
    const Passage& p = world.scratch.active_set.capstan.passages[index(k)];
    t = s > 0 ? t * p.factor : t / p.factor;
    if (p.normal >= 0) t += s * p.friction * rows[index(p.normal)].impulse;
    if (p.middle >= 0) t -= rows[index(p.middle)].impulse;
  }
  return t;
}

}  // namespace

void find_runs(const Scene& scene, World& world, const Part& part) {
  Scratch& scratch = world.scratch;
  CapstanScratch& s = scratch.active_set.capstan;
  const bool link_by_link = world.configuration.pinch_rows == PinchRows::three &&
                            world.configuration.solver == Solver::direct;
  s.runs.clear();
  s.passages.clear();
  s.segments.clear();
  s.run_before.clear();
  s.cable_begin.assign(1, 0);
  if (!part.may_slide) return;
  for (const int number : cables_of(scratch.parts, part)) {
    const std::size_t c = index(number);
    const CableState& cable = world.cables[c];
    if (!slides_somewhere(scene, cable)) continue;
    const auto row_of = [&](int segment) {
      return scratch.row_of_segment[index(scratch.segment_begin[c] + segment)];
    };
    const int count = static_cast<int>(cable.links.size());
    // Start a closed cable outside of any pinch, an open one at the first segment that bears
    // tension.
    int start = cable.closed ? 0 : 1;
    while (cable.closed && (cable.links[index(start)].pinch_middle ||
                            cable.links[index(previous_link(cable, start))].pinch_middle)) {
      ++start;
    }
    if (row_of(start) < 0) ++start;
    int run_before = -1;
    const std::size_t first_of_cable = s.segments.size();
    for (int segment = start, seen = 0; seen < count; ++seen) {
      s.segments.push_back(row_of(segment));
      s.run_before.push_back(run_before);
      const int first = segment;
      int last = first;
      if (cable.links[index(first)].orientation == 0) break;  // the end of an open cable
      while (!link_by_link && cable.links[index(next_link(cable, last))].pinch_middle) {
        last = next_link(cable, next_link(cable, last));
        seen += 2;
      }
      segment = next_link(cable, last);
      if (row_of(segment) < 0) break;  // wound up here: the end is fast
      Run run = make_run(scene, world, static_cast<int>(c), first, last);
      run.row_in = row_of(first);
      run.row_out = row_of(segment);
      run_before = static_cast<int>(s.runs.size());
      s.runs.push_back(run);
    }
    if (cable.closed) s.run_before[first_of_cable] = run_before;
    s.cable_begin.push_back(static_cast<int>(s.segments.size()));
  }
}

namespace {

void part_slack_segments(World& world, int begin, int count, int start) {
  CapstanScratch& s = world.scratch.active_set.capstan;
  bool slack_before = false;
  int oldest = -1;
  for (int k = 0; k < count; ++k) {
    const int position = begin + (start + k) % count;
    const int number = s.run_before[index(position)];
    if (k > 0) {
      Run& run = s.runs[index(number)];
      if (run.slip == Slip::stick) {
        slack_before = false;
        oldest = -1;
      } else if (!run.frictionless && (oldest < 0 || run.flipped < s.runs[index(oldest)].flipped)) {
        oldest = number;
      }
    }
    if (world.scratch.rows[index(s.segments[index(position)])].on) continue;
    if (slack_before && oldest >= 0) {
      s.runs[index(oldest)].slip = Slip::stick;
      s.runs[index(oldest)].flipped = world.scratch.active_set.solves + 1;
    }
    slack_before = true;
    oldest = -1;
  }
}

}  // namespace

void make_groups(World& world) {
  Scratch& scratch = world.scratch;
  CapstanScratch& s = scratch.active_set.capstan;
  s.groups.clear();
  s.members.clear();
  s.member_runs.clear();
  s.group_of_row.assign(scratch.rows.size(), -1);
  for (std::size_t c = 0; c + 1 < s.cable_begin.size(); ++c) {
    const int begin = s.cable_begin[c], count = s.cable_begin[c + 1] - begin;
    // Start where something sticks; a closed cable that slides everywhere is cut at its first run.
    int start = 0;
    for (int k = 0; k < count; ++k) {
      const int run = s.run_before[index(begin + k)];
      if (run < 0 || s.runs[index(run)].slip == Slip::stick) {
        start = k;
        break;
      }
    }
    part_slack_segments(world, begin, count, start);
    for (int k = 0; k < count; ++k) {
      const int position = begin + (start + k) % count;
      const int row = s.segments[index(position)], run = s.run_before[index(position)];
      const bool slack = !scratch.rows[index(row)].on;
      const bool sticks = k == 0 || s.runs[index(run)].slip == Slip::stick;
      // A second slack segment ends the group: what lies between two slack ones bears no tension.
      if (sticks || (slack && s.groups.back().slack >= 0)) {
        s.groups.push_back({});
        s.groups.back().begin = static_cast<int>(s.members.size());
      }
      Group& group = s.groups.back();
      const int member = static_cast<int>(s.members.size());
      if (slack) group.slack = member;
      s.members.push_back(row);
      s.member_runs.push_back(member == group.begin ? -1 : run);
      s.group_of_row[index(row)] = static_cast<int>(s.groups.size()) - 1;
      group.end = member + 1;
    }
  }
}

void express_impulses(World& world) {
  ActiveSet& set = world.scratch.active_set;
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
      pass_run(world, s.runs[index(s.member_runs[index(m)])], false, t);
      store(set, s.members[index(m)], t);
    }
    t.clear();
    for (int m = base; m > group.begin; --m) {
      pass_run(world, s.runs[index(s.member_runs[index(m)])], true, t);
      store(set, s.members[index(m - 1)], t);
    }
  }
}

// With w the rows' speeds without sliding and sigma the sliding speeds, a taut segment needs
// w = sigma_head - sigma_tail and a middle body that sticks needs w = -sigma of its run. Summing
// the rows from one sticking place to the next (with the middle rows at both ends) cancels every
// sigma.
void add_group_equations(World& world) {
  ActiveSet& set = world.scratch.active_set;
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
          world.scratch.rows[index(middle)].in_group_equation = true;
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

void slip_speeds(World& world) {
  const auto& rows = world.scratch.rows;
  CapstanScratch& s = world.scratch.active_set.capstan;
  for (Run& run : s.runs) run.speed = 0.0;
  for (const Group& group : s.groups) {
    double spare = 0.0, short_of = 0.0, total = 0.0;
    bool tension = false;
    for (int m = group.begin; m < group.end; ++m) {
      const Row& row = rows[index(s.members[index(m)])];
      total += row.speed;
      (row.speed > 0.0 ? spare : short_of) += std::abs(row.speed);
      tension = tension || row.impulse > 0.0;
    }
    // A group without tension moves material only to segments that would be taut, from those that
    // have some to spare, in proportion.
    const bool share = group.slack >= 0 && !tension;
    if (share && short_of == 0.0) continue;
    double sum = 0.0;
    for (int m = group.begin; m < group.end; ++m) {
      if (s.member_runs[index(m)] >= 0) s.runs[index(s.member_runs[index(m)])].speed = sum;
      const double w = rows[index(s.members[index(m)])].speed;
      double left_over = 0.0;
      if (share) {
        left_over = spare > 0.0 ? std::max(w, 0.0) * total / spare : 0.0;
      } else if (m == group.slack) {
        left_over = total;
      }
      sum += w - left_over;
    }
  }
}

void check_runs(World& world, double speed_tolerance, double impulse_tolerance) {
  const auto& rows = world.scratch.rows;
  ActiveSet& set = world.scratch.active_set;
  CapstanScratch& s = set.capstan;
  slip_speeds(world);
  for (const Group& group : s.groups) {
    if (group.slack >= 0) {
      double w = 0.0;
      for (int k = group.slack_begin; k < group.slack_end; ++k) {
        w += s.slack_terms[index(k)].coefficient * rows[index(s.slack_terms[index(k)].index)].speed;
      }
      const int row = s.members[index(group.slack)];
      if (w < -speed_tolerance && rows[index(row)].diagonal > 0.0) {
        set.flips.push_back({row, false, true, Slip::stick});
      }
    }
    // The member that would be pushed hardest goes slack.
    int worst = -1;
    double least = -impulse_tolerance;
    for (int m = group.begin; m < group.end; ++m) {
      const double impulse = rows[index(s.members[index(m)])].impulse;
      if (impulse < least) {
        least = impulse;
        worst = s.members[index(m)];
      }
    }
    if (worst >= 0) set.flips.push_back({worst, false, false, Slip::stick});
  }
  for (std::size_t i = 0; i < s.runs.size(); ++i) {
    const Run& run = s.runs[i];
    if (run.frictionless || run.frozen || run.passages_begin == run.passages_end) continue;
    const int number = static_cast<int>(i);
    const double out = rows[index(run.row_out)].impulse;
    if (run.slip != Slip::stick) {
      const bool bears =
          out > impulse_tolerance || rows[index(run.row_in)].impulse > impulse_tolerance;
      const bool against = sign(run.slip) * run.speed < -speed_tolerance;
      if (bears && against) set.flips.push_back({number, true, true, Slip::stick});
      continue;
    }
    if (out > sliding_limit(world, run, 1) + impulse_tolerance) {
      set.flips.push_back({number, true, true, Slip::forward});
    } else if (out < sliding_limit(world, run, -1) - impulse_tolerance) {
      set.flips.push_back({number, true, true, Slip::backward});
    }
  }
}

}  // namespace pinchlab
