// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

namespace pinchlab {

struct Part;
struct Parts;
struct PartSystem;
struct World;

/// A taut span of tension T and length L is a spring across itself: it pulls a body that leaves its
/// line back by k = T/L times the way x. The step takes that force at its start, which is stable
/// while h^2 k < 4 m (leapfrog: omega h < 2). For bodies too light for that, in the directions
/// concerned, this puts the force at the step's end instead (implicit Euler), against the line's
/// own speed u, the mean of the spans' other ends weighted by their stiffnesses:
///
///     m (v' - v) = h (f - k (x + h (v' - u)))  =>  (m + h^2 k) v' = m v + h^2 k u + h (f - k x)
///
/// So the body gets the mass m + h^2 k towards impulses, and its speed before them is drawn towards
/// u. The rows supply f - k x. What vibrates faster than steps can follow is damped instead of
/// thrown off. To leave all else as it is, max(m, h^2 k) stands for m + h^2 k, with k twice the sum
/// of T/L, since the other ends may move against the body. Spans shorter than the cable's width are
/// left out: there the bodies' contact sets the distance. So are nodes of cables with mass, which
/// intervals follow (cable/waves.h), but for those that none can: for these u is 0, or, strung on a
/// cable that runs over bodies, the line's as of other bodies.
///
/// Changes mobilities and free velocities of the part's bodies; a comparison an end of a span where
/// no body is too light. Whether any is.
bool steady_light_bodies(const World& world, const Parts& parts, const Part& part, double kick,
                         PartSystem& system);

/// Whether what was just solved for has given the part's bodies energy. The greater mass is a
/// spring's force in another form, which others feel at the step's start only: as momentum it is
/// from nothing. On a line that swings that is no matter. But the tension of a span that cannot
/// give knows no bound, nor does the mass of what has come upon it, and it throws what strikes it.
bool gains_by_steadying(const World& world, const Parts& parts, const Part& part,
                        const PartSystem& system);

/// The same for displacements, by which rows have so far had `impulses` (kg m) in all: what makes
/// sum m d^2 / 2 least under constraints C(d) >= 0 is found by Newton's method with the second
/// derivative m - p d^2C, to which a span adds p / L across itself. Without it a body in a straight
/// span, which hardly can shorten that, goes far to and fro across it. Free velocities are zero.
void steady_for_repair(const World& world, const Parts& parts, const Part& part,
                       std::span<const double> impulses, PartSystem& system);

/// Gives all of them their own masses and free velocities again, in the same kick. What motors have
/// made of these since is theirs to drive anew.
void release_light_bodies(PartSystem& system);

}  // namespace pinchlab
