// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/repair.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/creep.h"
#include "sim/compound.h"
#include "sim/motion/clearance.h"
#include "sim/solve/active_set.h"
#include "sim/solve/complementary.h"
#include "sim/solve/light_bodies.h"
#include "sim/solve/motors.h"
#include "sim/solve/rows.h"
#include "sim/solve/rubbing.h"
#include "sim/touch.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

// Where directions turn little, a repair leaves the square of what it found, so that few do. Where
// a cable is as straight as it can be and hardly gives, ways are long: so many go three radii of a
// body. What a 64th of a way makes no better, the way is wrong for.
constexpr int most_repairs = 64, most_halvings = 6;
constexpr double longest_way = 0.05;  // of a body's radius, in one repair

/// The most that a part's constraints are violated by (m).
struct Violation {
  double lengths = 0.0, gaps = 0.0;
  double most() const { return std::max(lengths, gaps); }
};

/// Whether it is of a segment that may stretch: forces act on it in time, none in a repair.
bool is_elastic(const World& world, const Row& row) {
  if (row.kind != RowKind::segment) return false;
  const CableState& cable = at(world.cables, row.index);
  return cable.elastic && (row.compliance > 0.0 || !at(cable.segments, row.item).pinched);
}

Violation violation(const World& world, const PartSystem& s) {
  Violation v;
  for (const Row& row : s.rows) {
    if (row.kind == RowKind::tangent || row.kind == RowKind::pinch_middle) continue;
    if (is_of_sleeve(row) || is_elastic(world, row)) continue;
    const double clearance = clearance_of(world, row);
    double& most = row.kind == RowKind::normal ? v.gaps : v.lengths;
    most = std::max(most, row.clamped ? std::abs(clearance) : -clearance);
  }
  return v;
}

/// Moves a part's bodies by `share` of the displacements that were just solved for.
void displace(World& world, Workspace& work, const Part& part, double share) {
  const PartSystem& s = at(work.systems, part.system);
  const std::span<const int> bodies = bodies_of(work.parts, part);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    at(world.position, bodies[i]) += share * s.velocity[i].head<2>();
    at(world.angle, bodies[i]) += share * s.velocity[i].z();
  }
  carry(world, carried_of(work.parts, part));
  for (const Run& run : work.solve.capstan.runs) {
    CableState& cable = at(world.cables, run.cable);
    for (int i = run.first_link;; i = next_link(cable, i)) {
      if (!at(cable.links, i).pinch_middle) at(cable.links, i).material -= share * run.speed;
      if (i == run.last_link) break;
    }
  }
  for (std::size_t k = 0; k < s.sleeves.size(); ++k) {
    const Sleeve& sleeve = s.sleeves[k].sleeve;
    CableState& cable = at(world.cables, sleeve.cable);
    const double way = share * slip_speed_of(s, s.velocity, world, k);
    for (int i = sleeve.first;; i = next_link(cable, i)) {
      if (!at(cable.links, i).pinch_middle) at(cable.links, i).material -= way;
      if (i == sleeve.last) break;
    }
  }
  for (const int c : cables_of(work.parts, part))
    update_cable(world, at(world.cables, c), false, is_known(work));
}

/// Goes `share` of the way that was just solved for, or less where that makes nothing better than
/// `before`: where a span hardly bends round a body, its direction turns much within the whole of
/// the way. Returns whether it went at all.
bool go(World& world, Workspace& work, const Part& part, double share, const Violation& before) {
  const PartSystem& s = at(work.systems, part.system);
  displace(world, work, part, share);
  for (int halvings = 0;; ++halvings) {
    const Violation now = violation(world, s);
    if (now.most() < before.most() && now.gaps <= std::max(before.gaps, s.reach)) return true;
    if (halvings == most_halvings) break;
    share *= 0.5;
    displace(world, work, part, -share);
  }
  displace(world, work, part, -share);
  return false;
}

/// Solves for displacements that make up for what the rows, which are made, miss.
void find_way(const World& world, Workspace& work, const Part& part) {
  PartSystem& s = at(work.systems, part.system);
  SolveScratch& set = work.solve;
  for (Row& row : s.rows) {
    if (!is_elastic(world, row)) continue;
    row.bias = 0.0;  // it resists being stretched, as much as in a step
    row.compliance /= world.step_length * world.step_length;
  }
  s.elastic_ends.clear();  // what slides goes no further than lengths ask for
  for (Friction& friction : s.frictions) friction.dropped = friction.normal >= 0;
  for (SleevePlace& sleeve : s.sleeves) sleeve.dropped = true;
  set.smooth = true;
  solve_direct(world, work.parts, part, s, set);
  // On a cable that hardly bends what is missed and round-off are much alike to doubles.
  if (set.contradicts || set.left_out) solve_complementary(s, set);
  set.smooth = false;
}

/// What is violated by more (m) is not repaired: a hundred times the way that so many repairs go.
double farthest_repaired(const World& world, std::span<const int> bodies) {
  double radius = 0.0;
  for (const int b : bodies) radius = std::max(radius, at(world.bodies, b).radius);
  return 100.0 * most_repairs * longest_way * radius;
}

/// How much of that way is gone at once. On so much of a body's radius directions turn by about as
/// many radians, and rows err by half the square of that, a thousandth.
double share_to_go(const World& world, std::span<const int> bodies, const PartSystem& s) {
  double share = 1.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double radius = at(world.bodies, bodies[i]).radius, way = s.velocity[i].head<2>().norm();
    if (way * share > longest_way * radius) share = longest_way * radius / way;
  }
  return share;
}

/// Adds up what rows have borne for `share` of the way.
void add_impulses(const PartSystem& s, double share, std::vector<double>& sums) {
  if (sums.size() != s.rows.size()) sums.assign(s.rows.size(), 0.0);
  for (std::size_t r = 0; r < sums.size(); ++r) sums[r] += share * s.rows[r].impulse;
}

/// Whether a segment is a pinch that is pressed, or nearly so: no material gets through.
bool is_closed(const World& world, const CableState& cable, int segment) {
  constexpr double nearly = 1e-3;  // of the half width: a body that rattles is closed
  const Segment& s = at(cable.segments, segment);
  if (!s.pinched || s.contact < 0) return false;
  const Contact& contact = at(world.contacts, s.contact);
  return contact.gap - contact.target <= nearly * cable.half_width;
}

/// Whether material may come into a segment: it is no closed pinch, and no side of a polygon. That
/// between a rim and a node which it holds may be slack.
bool opens(const World& world, const CableState& cable, int segment) {
  const int before = previous_link(cable, segment);
  const bool moored =
      at(cable.links, segment).moored || (before >= 0 && at(cable.links, before).moored);
  if (!moored && before >= 0 && is_side(at(cable.links, before), at(cable.links, segment)))
    return false;
  return !is_closed(world, cable, segment);
}

/// Lets go on what has gathered in a closed pinch, or come what it lacks.
void refill_pinch(const World& world, CableState& cable, int pinch) {
  if (!is_closed(world, cable, pinch)) return;
  const int before = previous_link(cable, pinch), after = next_link(cable, pinch);
  if (after < 0) return;
  const bool opens_before = opens(world, cable, before);
  const bool opens_after = opens(world, cable, after);
  if (!opens_before && !opens_after) return;
  const double material = at(cable.segments, pinch).rest_length;
  const double share = opens_before == opens_after ? 0.5 : opens_before ? 1.0 : 0.0;
  shift_material(cable, before, share * material);
  shift_material(cable, pinch, -(1.0 - share) * material);
  update_wraps_and_rest_lengths(world, cable);
}

void refill_pinches_of(const World& world, CableState& cable) {
  if (!cable.misfilled) return;
  const double rounding = material_rounding(cable);
  for (std::size_t i = first_segment(cable); i < cable.segments.size(); ++i) {
    if (is_misfilled(cable, cable.segments[i], rounding)) {
      refill_pinch(world, cable, static_cast<int>(i));
    }
  }
}

}  // namespace

void refill_pinches(World& world, const Parts& parts) {
  for (const Part& part : parts.list) {
    if (is_idle(part) || !has_contacts(part)) continue;
    for (const int c : cables_of(parts, part)) refill_pinches_of(world, at(world.cables, c));
  }
}

bool repair(const Scene& scene, World& world, Workspace& work, Part& part) {
  PartSystem& s = at(work.systems, part.system);
  TimeSpan t;
  t.length = t.repair = t.kick = 1.0;
  Stopwatch untimed(nullptr);
  bool any = false, met = false;
  work.solve.repaired_by.clear();
  for (int k = 0; k < most_repairs; ++k) {
    std::fill(s.free_velocity.begin(), s.free_velocity.end(), Eigen::Vector3d::Zero());
    make_rows(scene, world, work.parts, part, t, s, work.solve, untimed);
    const Violation before = violation(world, s);
    met = before.most() <= s.reach;
    if (met || before.most() > farthest_repaired(world, bodies_of(work.parts, part))) break;
    find_way(world, work, part);
    const double share = share_to_go(world, bodies_of(work.parts, part), s);
    if (!go(world, work, part, share, before)) {
      // Bodies with corners turn otherwise: once more as if no span did. Then, motors give.
      if (!work.solve.repaired_by.empty()) {
        work.solve.repaired_by.clear();
        release_light_bodies(s);
      } else if (!stall_all(s)) {
        break;
      }
      continue;
    }
    any = true;
    // The next step of Newton's method is from here.
    for (const int c : contacts_of(work.parts, part)) measure(world, at(world.contacts, c));
    add_impulses(s, share, work.solve.repaired_by);
    steady_for_repair(world, work.parts, part, work.solve.repaired_by, s);
  }
  release_light_bodies(s);
  if (!met) ++world.diagnostics.fallbacks;
  return any;
}

}  // namespace pinchlab
