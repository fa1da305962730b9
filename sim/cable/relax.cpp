// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/relax.h"

#include <algorithm>
#include <cmath>

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

/// Lays all of a group anew: material_of(span) (m) in each span, and on rims so much a metre.
template <class Material>
void lay_anew(const World& world, CableState& cable, const Sliding& group,
              const Material& material_of, double on_rims) {
  double later = 0.0;
  each(
      cable, group,
      [&](int i) {
        const Segment& span = at(cable.segments, i);
        later += material_of(span) - span.rest_length;
      },
      [&](int i) {
        const double had = wrapped_material(world, cable, index(i));
        const double now = on_rims * stored_length(at(cable.links, i));
        fill(world, cable, i, now, later);
        later += now - had;
      });
  update_wraps_and_rest_lengths(world, cable);
}

/// Lets nothing of a slack one be stretched, nor pushed on to a rim: what spans and rims lack comes
/// from the spans that have some to spare, in proportion.
void loosen(const World& world, CableState& cable, const Sliding& group) {
  constexpr double rounding = 1e-15;  // of the cable's length
  double lacks = 0.0, spare = 0.0;    // m
  each(
      cable, group,
      [&](int i) {
        const Segment& span = at(cable.segments, i);
        const double has = span.rest_length - span.length;
        (has > 0.0 ? spare : lacks) += std::abs(has);
      },
      [&](int i) {
        lacks += stored_length(at(cable.links, i)) - wrapped_material(world, cable, index(i));
      });
  if (std::abs(lacks) <= rounding * cable.length || spare == 0.0) return;
  const double left = std::max(1.0 - lacks / spare, 0.0);
  lay_anew(
      world, cable, group,
      [left](const Segment& span) {
        return span.length + left * std::max(span.rest_length - span.length, 0.0);
      },
      1.0);
}

void settle(const World& world, CableState& cable, const Sliding& group) {
  if (group.count < 2 && !group.around) return;
  const double slope = slope_of(world, cable, group);
  if (slope == 1.0) return loosen(world, cable, group);
  lay_anew(
      world, cable, group, [slope](const Segment& span) { return slope * span.length; }, slope);
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
