// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Elastic creep: what a rim carries over has the strain that it came on with. Of a cable that is
// stretched by e, a rim that turns by ds takes ds / (1 + e) of material, and gives back what it has
// taken, whatever the tension is where it goes off: the belt on a driven pulley is slower than on
// the one that drives it,
//     w1 R1 / (w2 R2) = (1 + T1 / EA) / (1 + T2 / EA).
// On discs and corners. Where a cable without mass slides over them, what lies there is stretched
// as it is pulled (relax.h). One with mass carries its strain along as it slides, as on a sleeve
// that turns faster or slower than the body (sleeve.h); on rough bodies it slides in part, too
// (partial_slip.h). Smooth bodies that it may slip on, and layers, carry as much as they turn: to
// carry strain along costs energy, and nothing smooth does.
//
// Through a pinch goes what comes off the rim at its other side, as that has it, either way.

#include <algorithm>
#include <array>
#include <span>

#include "sim/world.h"

namespace pinchlab {

/// Material on a rim up to a place (m), beyond what lies there by what comes on.
double laid_material(const Rim& rim, double place);

/// Laid::moment up to a place on the rim of a link's circle, of signed radius p.
Vec2 laid_moment(const Rim& rim, double p, double place);

/// Finds the moments of all that a link's rim carries, if its cable has mass.
void sum_moments(CableState& cable, std::size_t link);

/// Material near the end where the cable leaves the rim, or comes to it: whichever way the place
/// lies off that by round-off, without a jump.
inline double laid_near_end(const Rim& rim, bool at_head, double place) {
  const std::size_t last = rim.laid.size() - 1;
  const Laid& end = at_head ? rim.laid[last] : rim.laid[0];
  const double beyond = place - end.place;
  if (last == 0) return laid_material(rim, place);
  if (at_head) {
    const Laid& piece = rim.laid[last - 1];
    if (place < piece.place) return laid_material(rim, place);
    return end.material + beyond * (beyond < 0.0 ? piece.slope : rim.comes_on_at_head);
  }
  if (place > rim.laid[1].place) return laid_material(rim, place);
  return end.material + beyond * (beyond > 0.0 ? end.slope : rim.comes_on_at_tail);
}

/// What a rim takes of the segment at one of its ends, and gives it, in m of material a metre of
/// the rim.
struct Laying {
  double takes = 1.0, gives = 1.0;
  bool keeps = false;  // what lies on the rim turns with the body: it creeps, or is wound up
};

/// Of the end where the cable leaves the rim, or with `at_head` false where it comes to it, while
/// the segment there has `taken` m of material a metre.
Laying laying_at(const Rim& rim, bool at_head, double taken);

/// Where on a link's rim (m) the place is that its body's direction at the angle 0 is. What lies on
/// a rim that a cable with mass slides over moves along with the cable, as on a sleeve (sleeve.h):
/// its places are counted from Link::material, which says how far that has slid.
inline double origin_of_rim(const CableState& cable, std::size_t link) {
  return cable.rims[link].slides ? cable.links[link].material : 0.0;
}

/// Makes what lies at a link material that is further along its cable by so much (m).
void shift_material(CableState& cable, int link, double by);

/// Whether a link's rim carries its cable over as stretched as that comes on.
bool may_carry(const World& world, const CableState& cable, std::size_t link);

/// Gives a link that is newly on its body a rim with so much material in each metre of it, if it is
/// one that may carry it.
void begin_to_carry(const World& world, CableState& cable, std::size_t link, double slope = 1.0);

/// Ends an interval: what has come on to rims keeps the strain that it came on with, and what has
/// gone off them is forgotten; and sets what will come on in the next. The interval's length is
/// `time` (s); 0 where it is not over. Nothing is done to a cable of which no rim carries anything.
void lay_down(const World& world, CableState& cable, double time = 0.0);

/// m/s, by which the rims at the ends of a segment of a cable that creeps change its material
/// otherwise than they turn, at the world's velocities.
double creep_speed(const World& world, const CableState& cable, int segment);

/// m of material on a link, which has wraps.
double wrapped_material(const World& world, const CableState& cable, std::size_t link);

/// Where the cable lies on a link's rim (m along it, forward along the cable).
struct RimSpan {
  double tail = 0.0, head = 0.0;
};
RimSpan span_on_rim(const World& world, const CableState& cable, std::size_t link);

/// Equal parts of what a rim carries, from the tail on: m of stretch in each metre of them.
constexpr int rim_cells = 24;
using RimCells = std::array<double, rim_cells>;

/// Lays what has so much stretch in equal parts of a link's rim on it, and moves it along the cable
/// so that what lies where the cable comes to it is by `later` (m) further along.
void lay_on_rim(const World& world, CableState& cable, int link, std::span<const double> stretch,
                double later);

/// Calls f(from, to, slope) for each piece of what a link's rim carries, if it creeps: from where
/// on it to where (m), and m of material in a metre there.
template <class F>
void each_piece(const World& world, const CableState& cable, std::size_t link, const F& f) {
  const RimSpan on = span_on_rim(world, cable, link);
  const Rim& rim = cable.rims[link];
  double from = on.tail, slope = rim.comes_on_at_tail;
  const auto go_to = [&](double place) {
    const double to = std::min(place, on.head);
    if (to > from) f(from, to, slope);
    from = std::max(from, to);
  };
  for (const Laid& laid : rim.laid) {
    go_to(laid.place);
    slope = &laid == &rim.laid.back() ? rim.comes_on_at_head : laid.slope;
  }
  go_to(on.head);
}

/// Where on the rim (m) so much material (m) lies, counted as laid_material does.
double place_of_laid(const Rim& rim, double material);

/// J, of the strain of what a cable's rims carry; `stiffness` (N) is finite.
double energy_carried(const World& world, const CableState& cable, double stiffness);

}  // namespace pinchlab
