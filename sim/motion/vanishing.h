// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Intervals while a span vanishes, or comes into being.
//
// Where a cable crosses over between two circles whose radii add up to Delta, its span has the
// length L = sqrt(D^2 - Delta^2), D the distance of their centres. The time tau before they touch,
// which they do at the speed u = |dD/dt|, or after they have parted,
//     L^2 = 2 D u tau.
// So the span turns as the root of tau, what tension that takes goes as 1 / sqrt(tau), and
// velocities as v_0 + v_1 sqrt(tau). The leapfrog takes the span's direction from the middle of its
// kick and errs, in an interval h at tau, by tension times the direction's second derivative,
//     1/sqrt(tau) tau^(-3/2) h^3 = h^3 / tau^2
// (times a speed squared over a length). Over equal intervals that adds up to as much as the last
// one errs, by h: of first order, however well the touch is located. Intervals of
//     h (tau / T)^(2/3)   where tau < T
// err by h^3 / T^2 each; there are 3 T / h of them, and they err by 3 h^2 / T together: of second
// order. (The step is h. T is vanishing_time: what takes longer steps can follow.)
//     The span of a cable that stretches has little material left when it is short, slack or not:
// its stiffness grows as 1 / L, and an interval that begins with three times the material that it
// ends with takes it for a third as stiff as it is. Intervals of tau / 2 leave it as stiff as it
// was to a factor of sqrt(2), and (omega h)^2 goes as tau^2 / L, to 0. Where its rims creep, no
// more than half of what is in it goes through it in one: what comes on is taken as it was before.
//     A node that is moored at a polygon's corner goes round it as fast as the cable slips there:
// round a sharp one several times in a step. Intervals follow it.

#include <span>

#include "sim/world.h"

namespace pinchlab {

struct Parts;

/// s. Not so many steps: it must stay while these get shorter, for the second order. About a frame,
/// so that only the frame of the touch costs the 3 T / h intervals.
constexpr double vanishing_time = 1.0 / 30.0;

/// How long an interval of these parts may be (s), as the world is; infinity: as long as the step.
/// No shorter than a share of 1e-4 of it.
double longest_interval(const World& world, const Parts& parts, std::span<const int> of);

}  // namespace pinchlab
