// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/relax.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/creep.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// mu theta of what slides over a link, below 0 where it slides backward: ln(T after / T before).
double turned_by_friction(const World& world, const Link& link) {
  return static_cast<int>(link.slip) * at(world.bodies, link.body).cable_friction * link.wrap;
}

/// Strains between which what lies on a rim is stretched: the greater, and mu theta.
struct Strains {
  double most = 0.0, turned = 0.0;

  double least() const { return most * std::exp(-turned); }
  /// m that are stretch, a metre of the rim.
  double stretch() const {
    const double strained = most / (1.0 + most);
    return turned == 0.0 ? strained : -std::log1p(strained * std::expm1(-turned)) / turned;
  }
  /// Its change with the greater strain.
  double change() const {
    const double share = turned == 0.0 ? 1.0 : -std::expm1(-turned) / turned;
    return share / ((1.0 + most) * (1.0 + least()));
  }
};

double strain_of(const Segment& span) {
  const double stretch = std::max(span.length - span.rest_length, 0.0);
  return span.rest_length > 0.0 ? stretch / span.rest_length : 0.0;
}

/// For the strain of the span that is pulled more.
Strains strains_at(const World& world, const CableState& cable, int link) {
  const double turned = turned_by_friction(world, at(cable.links, link));
  const int tighter = turned > 0.0 ? next_link(cable, link) : link;
  return {strain_of(at(cable.segments, tighter)), std::abs(turned)};
}

}  // namespace

bool is_pinched_beside(const CableState& cable, int link) {
  const int after = next_link(cable, link);
  return at(cable.segments, link).pinched || (after >= 0 && at(cable.segments, after).pinched);
}

bool lies_relaxed(const World& world, const CableState& cable, int number) {
  if (number < 0 || cable.rims.empty()) return false;
  const Link& link = at(cable.links, number);
  return !at(cable.rims, number).laid.empty() && !link.pinch_middle && link.wrap >= 0.0 &&
         (is_smooth(world, link) || link.slip != Slip::stick) && !is_pinched_beside(cable, number);
}

Beside lies_beside(const World& world, const CableState& cable, int number, bool after) {
  const Link& link = at(cable.links, number);
  const double lies = wrapped_material(world, cable, index(number));
  const Strains strains = strains_at(world, cable, number);
  const double half = 0.5 * strains.turned, pulled = std::tanh(half);
  double share = half > 0.0 ? 0.5 * pulled / half : 0.5;
  if (strains.most > 0.0) {
    const double stretch = strains.stretch();
    share = stretch / ((1.0 - stretch) * (strains.most + strains.least()));
  }
  const bool more = after == (link.slip == Slip::forward);  // it is pulled
  const double of_stretch = 0.5 * (more ? 1.0 + pulled : 1.0 - pulled);
  return {share * lies, of_stretch * (lies - stored_length(link))};
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

/// How the strains of a group's spans follow one another.
struct Course {
  double material = 0.0, way = 0.0;  // m
  double tightest = 0.0;             // ln of the strain of the span that has most, over the first's
  bool smooth = true;                // all are alike
};

Course course_of(const World& world, const CableState& cable, const Sliding& group) {
  Course course;
  double turned = 0.0;
  each(
      cable, group,
      [&](int i) {
        course.material += at(cable.segments, i).rest_length;
        course.way += at(cable.segments, i).length;
        course.tightest = std::max(course.tightest, turned);
      },
      [&](int i) {
        const Link& link = at(cable.links, i);
        course.material += wrapped_material(world, cable, index(i));
        course.way += stored_length(link);
        course.smooth = course.smooth && is_smooth(world, link);
        turned += turned_by_friction(world, link);
      });
  return course;
}

/// What spans and rims of a stretched group have, one after another.
struct Shares {
  const World& world;
  const CableState& cable;
  double tightest = 0.0;  // strain of the span that has most
  double level = 0.0;     // ln of that of the next span, over it

  double strain() const { return tightest * std::exp(level); }
  /// On rim i, to the span after which it goes on.
  Strains pass(int i) {
    const double before = level;
    level += turned_by_friction(world, at(cable.links, i));
    return {tightest * std::exp(std::max(before, level)), std::abs(level - before)};
  }
  /// m of material.
  double of_span(int i) const { return at(cable.segments, i).length / (1.0 + strain()); }
  double of_rim(int i) { return stored_length(at(cable.links, i)) * (1.0 - pass(i).stretch()); }
};

/// Those of a group that is stretched, at the first of its spans.
Shares shares_of(const World& world, const CableState& cable, const Sliding& group,
                 const Course& course) {
  Shares shares{world, cable, course.way / course.material - 1.0, -course.tightest};
  if (course.smooth) return shares;
  // Newton: what the way takes of material is convex in the strain, and falls, so that from none on
  // it comes up to the root and never beyond.
  constexpr int most_rounds = 100;
  shares.tightest = 0.0;
  for (int round = 0; round < most_rounds; ++round) {
    double spare = -course.material, change = 0.0;  // m
    Shares next = shares;
    each(
        cable, group,
        [&](int i) {
          const double length = at(cable.segments, i).length, stretched = 1.0 + next.strain();
          spare += length / stretched;
          change -= length * std::exp(next.level) / (stretched * stretched);
        },
        [&](int i) {
          const double length = stored_length(at(cable.links, i)), before = next.level;
          const Strains strains = next.pass(i);
          spare += length * (1.0 - strains.stretch());
          change -= length * std::exp(std::max(before, next.level)) * strains.change();
        });
    const double strain = shares.tightest - spare / change;
    if (!(strain > shares.tightest)) break;  // by round-off
    shares.tightest = strain;
  }
  return shares;
}

/// Those of strains that grow or, with `turned` below 0, fall along a rim as e^(mu phi), as much as
/// `stretch` in the mean.
RimCells cells_of(const Strains& strains, double turned, double stretch) {
  RimCells all;
  double sum = 0.0;
  for (int k = 0; k < rim_cells; ++k) {
    const double from_tail = (k + 0.5) / rim_cells;
    const double from_most = turned > 0.0 ? 1.0 - from_tail : from_tail;
    const double strain = strains.most * std::exp(-from_most * strains.turned);
    at(all, k) = strain / (1.0 + strain);
    sum += at(all, k);
  }
  for (double& one : all) one *= sum > 0.0 ? rim_cells * stretch / sum : 0.0;
  return all;
}

/// Lays all of a group anew: material_of(span) (m) in each span, and on each rim, which is moved by
/// `later` (m), what lay_rim(link, later) lays there; it returns how much (m of material).
template <class MaterialOf, class LayRim>
void lay_anew(const World& world, CableState& cable, const Sliding& group,
              const MaterialOf& material_of, const LayRim& lay_rim) {
  double later = 0.0;
  each(
      cable, group, [&](int i) { later += material_of(i) - at(cable.segments, i).rest_length; },
      [&](int i) {
        const double had = wrapped_material(world, cable, index(i));
        later += lay_rim(i, later) - had;
      });
  update_wraps_and_rest_lengths(world, cable);
}

/// Lets nothing of a slack one be stretched, nor pushed on to a rim: what spans and rims lack comes
/// from the spans that have some to spare, in proportion.
void loosen(const World& world, CableState& cable, const Sliding& group) {
  constexpr double rounding = 1e-15;  // of the cable's length
  constexpr double none = 0.0;        // stretch
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
      [&](int i) {
        const Segment& span = at(cable.segments, i);
        return span.length + left * std::max(span.rest_length - span.length, 0.0);
      },
      [&](int i, double later) {
        lay_on_rim(world, cable, i, {&none, 1}, later);
        return stored_length(at(cable.links, i));
      });
}

/// Stretches all of a group that is stretched by its shares.
void lay_stretched(const World& world, CableState& cable, const Sliding& group, Shares shares) {
  lay_anew(
      world, cable, group, [&](int i) { return shares.of_span(i); },
      [&](int i, double later) {
        const Link& link = at(cable.links, i);
        const Strains strains = shares.pass(i);
        const double a_metre = strains.stretch();
        if (strains.turned == 0.0) {
          lay_on_rim(world, cable, i, {&a_metre, 1}, later);
        } else {
          lay_on_rim(world, cable, i, cells_of(strains, turned_by_friction(world, link), a_metre),
                     later);
        }
        return stored_length(link) * (1.0 - a_metre);
      });
}

/// Whether a group that has slid for so long (s) has more energy if it is laid anew than friction
/// has taken meanwhile: what moves a metre of material from one strain to another does the work of
/// EA (e + e^2 / 2) at either.
bool makes_energy(const CableState& cable, const Sliding& group, Shares shares, double time) {
  const auto work = [](double strain) { return strain + 0.5 * strain * strain; };
  double gained = 0.0, rubbed = 0.0;  // m, over EA
  each(
      cable, group,
      [&](int i) {
        const Segment& span = at(cable.segments, i);
        gained +=
            energy_of(span.length, shares.of_span(i)) - energy_of(span.length, span.rest_length);
      },
      [&](int i) {
        const Link& link = at(cable.links, i);
        gained += energy_of(stored_length(link), shares.of_rim(i));
        each_piece(shares.world, cable, index(i), [&gained](double from, double to, double slope) {
          gained -= energy_of(to - from, (to - from) * slope);
        });
        const Segment& after = at(cable.segments, next_link(cable, i));
        const double pulled = work(strain_of(after)) - work(strain_of(at(cable.segments, i)));
        rubbed += time * link.slip_speed * pulled;
      });
  return gained > rubbed;
}

void settle(const World& world, CableState& cable, const Sliding& group, double time) {
  if (group.count < 2 && !group.around) return;
  const Course course = course_of(world, cable, group);
  if (course.material >= course.way) return loosen(world, cable, group);
  const Shares shares = shares_of(world, cable, group, course);
  if (course.smooth || !makes_energy(cable, group, shares, time)) {
    return lay_stretched(world, cable, group, shares);
  }
  // Then over smooth rims only.
  Sliding part{group.first, 0};
  for (int k = 1, i = group.first; k <= group.count; ++k, i = next_link(cable, i)) {
    ++part.count;
    if (k < group.count && is_smooth(world, at(cable.links, i))) continue;
    settle(world, cable, part, time);
    part = {next_link(cable, i), 0};
  }
}

}  // namespace

void relax_rims(const World& world, CableState& cable, double time) {
  const int count = static_cast<int>(cable.links.size());
  const int first = static_cast<int>(first_segment(cable));
  // A closed cable's groups begin after a link that it does not slide over, if there is one, or
  // that is rough.
  int start = first;
  if (cable.closed) {
    const auto holds = [&](int i) { return !lies_relaxed(world, cable, i); };
    const auto is_rough = [&](int i) { return !is_smooth(world, at(cable.links, i)); };
    while (start < count && !holds(start)) ++start;
    if (start == count) start = first;
    while (start < count && !holds(start) && !is_rough(start)) ++start;
    if (start == count) return settle(world, cable, {first, count, true}, time);
    start = next_link(cable, start);
  }
  Sliding group{start, 0};
  for (int k = first, i = start; k < count; ++k, i = next_link(cable, i)) {
    ++group.count;
    if (!lies_relaxed(world, cable, i) || k + 1 == count) {
      settle(world, cable, group, time);
      group = {next_link(cable, i), 0};
    }
  }
}

}  // namespace pinchlab
