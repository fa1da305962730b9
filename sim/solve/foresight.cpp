// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/foresight.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/parts.h"
#include "sim/world.h"

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

/// How many intervals of that length all bodies of a part have just gone through, and their last.
Regularity regularity_of(const World& world, const Parts& parts, const Part& part, double length) {
  Regularity all{length, order, 0};
  for (const int body : bodies_of(parts, part)) {
    const Regularity& one = at(world.regularity, body);
    all.intervals = is_same(one.length, length) ? std::min(all.intervals, one.intervals) : 0;
    all.unmeasured = std::max(all.unmeasured, one.unmeasured);
  }
  return all;
}

/// Of a World, const or not, a row's own curvature; or null where it has none.
template <typename AnyWorld>
auto* curvature_of(AnyWorld& world, const Row& row) {
  if (row.kind == RowKind::segment || row.kind == RowKind::pinch_middle) {
    return &at(at(world.cables, row.index).segments, row.item).curvature;
  }
  return row.kind == RowKind::normal ? &at(world.contacts, row.index).curvature : nullptr;
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

}  // namespace

bool is_foreseen(const World& world, const Parts& parts, const Part& part, const TimeSpan& t) {
  if (!is_same(t.kick, t.length)) return false;
  const Regularity regular = regularity_of(world, parts, part, t.length);
  if (regular.intervals == 0) return false;
  return world.configuration.error == 0.0 || regular.unmeasured < most_unmeasured;
}

void foresee(const World& world, double length, PartSystem& s) {
  // What nobody would correct is round-off, which must not become speed.
  const double least = exact_share * s.reach / length;
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
  }
}

void note_curvature(const Parts& parts, const Part& part, const PartSystem& s,
                    const IntervalDone& done, World& world) {
  if (!is_same(done.kick, done.length)) return forget_curvature(parts, part, world);
  Regularity regular = regularity_of(world, parts, part, done.length);
  for (const Row& row : s.rows) {
    Curvature* differences = curvature_of(world, row);
    if (differences)
      append(row.on && !row.idle ? row.curved : 0.0, regular.intervals, *differences);
  }
  regular.intervals = std::min(regular.intervals + 1, order);
  if (done.foreseen) {
    ++regular.unmeasured;
  } else {
    regular.unmeasured = done.local_error <= safe_share * done.allowed ? 0 : most_unmeasured;
  }
  for (const int body : bodies_of(parts, part)) at(world.regularity, body) = regular;
}

void forget_curvature(const Parts& parts, const Part& part, World& world) {
  for (const int body : bodies_of(parts, part)) at(world.regularity, body).intervals = 0;
}

}  // namespace pinchlab
