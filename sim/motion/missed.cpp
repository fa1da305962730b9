// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/missed.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/motion/clearance.h"
#include "sim/parts.h"
#include "sim/solve/capstan.h"
#include "sim/solve/part_system.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// Whether a row's condition changes by J v and nothing else: that of a segment between circles
/// which have not moved, as its length stands and its material turns evenly, or of a middle body
/// where nothing of its cable's course has.
bool is_linear(const World& world, const Row& row) {
  if (row.kind != RowKind::segment && row.kind != RowKind::pinch_middle) return false;
  const CableState& cable = at(world.cables, row.index);
  if (cable.stands) return true;
  return row.kind == RowKind::segment && !at(cable.segments, row.item).moved && !cable.fills &&
         cable.rims.empty();
}

/// J v + bias (m/s) of a row without compliance, at most; where the solver knows, as it knows.
double speed_left(const PartSystem& s, const SolveScratch& set, std::size_t r) {
  if (!set.direct) return std::abs(row_speed(s, r));
  return set.unknown_of_row[r] >= 0 ? set.missing : std::abs(s.rows[r].speed);
}

/// Whether the rows of a part's cables miss nothing: the conditions of all are linear, as hardly
/// where bodies can move, and the solver knows that it meets them but for so much (m/s).
bool cables_are_met(const World& world, const Parts& parts, const Part& part, const PartSystem& s,
                    const SolveScratch& set, double round_off) {
  if (part.can_move || !set.direct || !set.capstan.runs.empty() || s.too_long) return false;
  if (std::max(set.missing, set.fastest) > round_off) return false;
  const std::span<const int> cables = cables_of(parts, part);
  return std::all_of(cables.begin(), cables.end(),
                     [&world](int c) { return at(world.cables, c).stands; });
}

/// m/s, at which a segment of an elastic cable gets material by sliding.
double slid_in(const World& world, const Row& row) {
  const CableState& cable = at(world.cables, row.index);
  return at(cable.links, previous_link(cable, row.item)).slip_speed -
         at(cable.links, row.item).slip_speed;
}

}  // namespace

bool is_exact_row(const Row& row) {
  if (row.kind == RowKind::tangent || is_of_sleeve(row)) return false;
  return row.kind != RowKind::pinch_middle || row.slip == Slip::stick;
}

double add_missed(const World& world, const Parts& parts, const Part& part, const SolveScratch& set,
                  const TimeSpan& t, PartSystem& s, IntervalTrial& trial) {
  const CapstanScratch& capstan = set.capstan;
  const bool slides = !capstan.runs.empty() && !set.swept;
  const double still_left = 1.0 - t.length / t.repair;  // share of what is made up for by `bias`
  const double round_off = s.tolerance() / t.length;    // m/s
  double most = 0.0;
  const bool met = cables_are_met(world, parts, part, s, set, round_off);
  const std::size_t count = s.rows.size();
  for (std::size_t r = met ? index(s.first_contact_row) : 0; r < count; ++r) {
    Row& row = s.rows[r];
    const int group = slides ? capstan.group_of_row[r] : -1;
    // Most rows are done with here. What stretches may be too long, and may have any speed.
    const bool stays = group < 0 && (row.compliance > 0.0 || (row.clearance >= -t.made_up &&
                                                              speed_left(s, set, r) <= round_off));
    if (stays && is_linear(world, row)) continue;
    // Of a group that is slack somewhere any segment may run short of its share of the material.
    const bool shares = group >= 0 && at(capstan.groups, group).slack >= 0;
    if (!is_exact_row(row) || (row.idle && !shares)) continue;
    const bool middle = row.kind == RowKind::pinch_middle;
    if (middle && !row.on) continue;
    const bool violated = row.clearance < -t.made_up || (middle && row.clearance > t.made_up);
    if (violated && !middle && row.compliance == 0.0 && (row.diagonal > 0.0 || group >= 0)) {
      trial.violated = true;
    }
    if (!row.on && group >= 0 && !shares) continue;
    // By the interval's end as much of what was left at its start must be made up for as by `bias`.
    const bool made_up = row.clearance <= s.reach;
    const double left = violated ? row.clearance : made_up ? still_left * row.clearance : 0.0;
    double missed = clearance_of(world, row) - left;
    // Without tension no segment of a group is held to its length.
    const bool bears = row.on && !(shares && row.impulse == 0.0);
    const bool balances = group >= 0 && !s.elastic_ends.empty();
    if (row.compliance > 0.0) {
      const bool loose = !row.on && missed + left >= -s.tolerance();  // at the interval's end too
      if (balances ? !row.on && !shares : loose || group >= 0) continue;
      // The stretch over the interval's end is the real one.
      double straight = row_speed(s, r) - row.bias;
      if (balances) straight += slid_in(world, row);
      const double curvature = (missed + left - row.clearance) / t.length - straight;
      missed = (curvature - s.bodies[r].curvature) * t.length;
    }
    if (!bears) missed = std::min(missed, 0.0);
    double curvature = missed / t.length;
    // Of a row that bears no force the way itself has gained J v + bias, which has bent back.
    if (!bears && missed < 0.0 && group < 0) curvature -= std::max(row_speed(s, r), 0.0);
    // A row that repeats others is met by these, and has not the speed that its bias asks for: the
    // way has bent by what they let it have.
    if (!set.direct && bears && group < 0 && row.compliance == 0.0 &&
        std::abs(missed) <= s.tolerance()) {
      const double speed = row_speed(s, r) + (middle ? sliding_of_run(s, capstan, row) : 0.0);
      if (std::abs(speed) > round_off) curvature -= speed;
    }
    row.bias += curvature;
    row.curved += curvature;
    if (row.compliance > 0.0) s.bodies[r].curvature += curvature;
    if (balances) s.elastic_ends[r].bias += curvature;
    most = std::max(most, std::abs(missed));
  }
  return most;
}

}  // namespace pinchlab
