// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/foresight.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"

namespace pinchlab {

namespace {

constexpr int order = static_cast<int>(Curvature{}.size());

// Lengths are differences of times: what they differ by otherwise is round-off of these.
constexpr double rounding = 1e-9;

// Of intervals whose errors are not measured there are so many in succession, and only after one
// that erred by so much less than is allowed: as h^3 of an acceleration that grows, errors do not
// grow eightfold in so few steps, but where something happens.
constexpr int most_unmeasured = 7;
constexpr double safe_share = 0.125;

bool is_same(double p, double q) {
  return std::abs(p - q) <= rounding * q;
}

/// Of a World, const or not, a row's own curvature; or null where its condition is linear. What
/// spans between circles that have not moved is: lengths stay, and material turns evenly.
template <typename AnyWorld>
auto* curvature_of(AnyWorld& world, const Row& row) {
  using Pointer = decltype(&at(world.contacts, 0).curvature);
  if (row.kind == RowKind::segment || row.kind == RowKind::pinch_middle) {
    auto& segment = at(at(world.cables, row.index).segments, row.item);
    return segment.moved ? &segment.curvature : Pointer(nullptr);
  }
  return row.kind == RowKind::normal ? &at(world.contacts, row.index).curvature : Pointer(nullptr);
}

/// The backward differences that `known` values before and this one have.
void append(double value, int known, Curvature& differences) {
  double next = value;
  for (int k = 0; k < order; ++k) {
    const double before = at(differences, k);
    at(differences, k) = next;
    next = k < known ? next - before : 0.0;
  }
}

/// What nobody would correct is round-off (m/s), which must not become speed.
double least_curvature(const PartSystem& s, double length) {
  return s.tolerance() / length;
}

}  // namespace

bool is_even(double lag, double length) {
  return is_same(lag, 0.5 * length);
}

bool is_foreseen(const Pace& pace, double error, const TimeSpan& t) {
  if (!pace.curved || pace.intervals == 0 || !is_even(pace.lag, t.length)) return false;
  return error == 0.0 || pace.unmeasured < most_unmeasured;
}

void foresee(const World& world, double length, PartSystem& s) {
  const double least = least_curvature(s, length);
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    Row& row = s.rows[r];
    if (!row.on || row.idle) continue;
    const Curvature* differences = curvature_of(world, row);
    if (!differences) continue;
    double foreseen = 0.0;
    for (const double difference : *differences) foreseen += difference;
    if (std::abs(foreseen) <= least) continue;
    row.curved = foreseen;
    row.bias += foreseen;
    if (row.compliance > 0.0) s.bodies[r].curvature += foreseen;
    if (r < s.elastic_ends.size()) s.elastic_ends[r].bias += foreseen;  // what slides follows it
  }
}

bool note_curvatures(const PartSystem& s, double length, int known, bool curved, World& world) {
  const double least = least_curvature(s, length);
  bool any = false;
  for (const Row& row : s.rows) {
    Curvature* differences = curvature_of(world, row);
    if (!differences) continue;
    if (!curved) *differences = {};
    const bool curves = row.on && !row.idle && std::abs(row.curved) > least;
    append(curves ? row.curved : 0.0, known, *differences);
    any = any || *differences != Curvature{};
  }
  return any;
}

Pace pace_after(const Pace& before, const IntervalDone& done) {
  Pace after{.lag = 0.5 * done.length};
  if (!is_even(before.lag, done.length)) return after;
  const auto one_more = [](int number, int most) {
    return static_cast<std::int8_t>(std::min(number + 1, most));
  };
  after.intervals = one_more(before.intervals, order);
  if (done.foreseen) {
    after.unmeasured = one_more(before.unmeasured, most_unmeasured);
  } else if (done.local_error > safe_share * done.allowed) {
    after.unmeasured = most_unmeasured;
  }
  return after;
}

}  // namespace pinchlab
