// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/relax.h"

#include <algorithm>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/creep.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

bool is_pinched_beside(const CableState& cable, int link) {
  const int after = next_link(cable, link);
  return at(cable.segments, link).pinched || (after >= 0 && at(cable.segments, after).pinched);
}

}  // namespace

bool lies_relaxed(const World& world, const CableState& cable, int number) {
  if (number < 0 || cable.rims.empty()) return false;
  const Link& link = at(cable.links, number);
  return !at(cable.rims, number).laid.empty() && !link.pinch_middle && link.wrap >= 0.0 &&
         at(world.bodies, link.body).cable_friction == 0.0 && !is_pinched_beside(cable, number);
}

namespace {

/// Segments and links that slide as one: from segment `first`, `count` segments and the links after
/// all but the last; or, of a closed cable that slides all around, after the last too.
struct Sliding {
  int first = 0, count = 0;
  bool around = false;
};

/// Calls span(i) and rim(i) for segments and rims one after another.
template <class OnSpan, class OnRim>
void each(const CableState& cable, const Sliding& group, const OnSpan& span, const OnRim& rim) {
  int i = group.first;
  for (int k = 0; k < group.count; ++k, i = next_link(cable, i)) {
    span(i);
    if (k + 1 == group.count && !group.around) return;
    rim(i);
  }
}

/// m of material a metre of way, of a group; 1 where all is slack.
double slope_of(const World& world, const CableState& cable, const Sliding& group) {
  double material = 0.0, way = 0.0;
  each(
      cable, group,
      [&](int i) {
        material += at(cable.segments, i).rest_length;
        way += at(cable.segments, i).length;
      },
      [&](int i) {
        material += wrapped_material(world, cable, index(i));
        way += stored_length(at(cable.links, i));
      });
  return material < way ? material / way : 1.0;
}

/// Gives a rim so much material (m), evenly, and moves it along the cable so that what lies where
/// the cable comes to it is by `later` (m) further along.
void fill(const World& world, CableState& cable, int link, double material, double later) {
  const double angle = body_angle(world, at(cable.links, link));
  const double before = tail_material(cable, index(link), angle);
  const RimSpan on = span_on_rim(world, cable, index(link));
  const double width = on.head - on.tail, slope = width > 0.0 ? material / width : 1.0;
  std::vector<Laid>& laid = at(cable.rims, link).laid;
  laid.assign(1, {on.tail, on.tail, slope});
  if (width > 0.0) laid.push_back({on.head, on.tail + material, slope});
  at(cable.links, link).material += before + later - tail_material(cable, index(link), angle);
}

/// Stretches a group evenly.
void stretch(const World& world, CableState& cable, const Sliding& group, double slope) {
  double later = 0.0;
  each(
      cable, group,
      [&](int i) {
        const Segment& span = at(cable.segments, i);
        later += slope * span.length - span.rest_length;
      },
      [&](int i) {
        const double now = slope * stored_length(at(cable.links, i));
        const double had = wrapped_material(world, cable, index(i));
        fill(world, cable, i, now, later);
        later += now - had;
      });
}

/// Lets the rims of a slack one take what they lack from the spans beside them.
void loosen(const World& world, CableState& cable, const Sliding& group) {
  int i = group.first;
  for (int k = 0; k < group.count; ++k, i = next_link(cable, i)) {
    if (k + 1 == group.count && !group.around) return;
    const Segment &before = at(cable.segments, i), &after = at(cable.segments, next_link(cable, i));
    const double had = wrapped_material(world, cable, index(i));
    const double lacks = std::max(stored_length(at(cable.links, i)) - had, 0.0);
    const auto spare = [](const Segment& s) { return std::max(s.rest_length - s.length, 0.0); };
    const double from_before = std::min(lacks, spare(before));
    const double from_after = std::min(lacks - from_before, spare(after));
    if (from_before + from_after == 0.0) continue;
    fill(world, cable, i, had + from_before + from_after, -from_before);
    update_wraps_and_rest_lengths(world, cable);
  }
}

void settle(const World& world, CableState& cable, const Sliding& group) {
  if (group.count < 2 && !group.around) return;
  const double slope = slope_of(world, cable, group);
  if (slope == 1.0) return loosen(world, cable, group);
  stretch(world, cable, group, slope);
  update_wraps_and_rest_lengths(world, cable);
}

}  // namespace

void relax_rims(const World& world, CableState& cable) {
  const int count = static_cast<int>(cable.links.size());
  const int first = static_cast<int>(first_segment(cable));
  // A closed cable's groups begin after a link that it does not slide over, if there is one.
  int start = first;
  if (cable.closed) {
    while (start < count && lies_relaxed(world, cable, start)) ++start;
    if (start == count) return settle(world, cable, {first, count, true});
    start = next_link(cable, start);
  }
  Sliding group{start, 0};
  for (int k = first, i = start; k < count; ++k, i = next_link(cable, i)) {
    ++group.count;
    if (!lies_relaxed(world, cable, i)) {
      settle(world, cable, group);
      group = {next_link(cable, i), 0};
    }
  }
}

}  // namespace pinchlab
