// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Intervals in which what bears force turns far.
//
// A body of mass m and speed v on a span of length L turns it by phi = v h / L in an interval h.
// What that takes, the impulse p = m v^2 h / L, acts along the span as it was when the interval
// began, and the span's condition changes by v^2 h / 2 L a second otherwise than by J v
// (Row::curved). So
//     sum p curved = phi^2 m v^2 / 2
// tells, as a share phi^2 of the kinetic energy, by how much that swings in a leapfrog (of a weight
// that hangs from it, and swings slowly, the share is (omega h)^2): by no more than that as long as
// intervals are of one length and the motion goes on. After a blow neither is so, and what it has
// swung by stays. A light ball that falls on a cable with a heavy weight on it turns the spans
// beside it by half a radian in a frame: it was thrown back with more energy than there was.
//     So no interval turns what bears force by more than a sixth of a radian, some ten degrees. A
// pendulum of a metre comes to that at 10 m/s and 60 steps a second, one of a decimetre at any
// speed.
//     Nor does one turn a span with mass far that is not taut: the flow over the rims at its ends
// is a force F then (cable/mass.h), and what an interval's F h has as energy on what it pushes, at
// rest, is as small a share of that of the span's two ends.
//     A span that stretches gives back what it takes, but along another direction, and counts too.

#include <Eigen/Core>
#include <span>
#include <vector>

namespace pinchlab {

struct PartSystem;
struct World;

/// phi^2 above (rad^2) of what was just solved for these bodies and an interval of `length` (s); 0
/// where nothing curves. The energy is what they and the cables that they carry have, or would have
/// without their rows: what rests turns nothing.
double turned_square(const World& world, std::span<const int> bodies, double length,
                     const PartSystem& system);

/// What that may be at most.
constexpr double most_turned = 1.0 / 36.0;

/// Whether a correction of a first solution changes the velocities of its bodies and rims by more
/// than half of the fastest: beyond that, what the first knows of the way's end has little to do
/// with it. `round_off`: m/s, that is no change.
bool bends_too_far(const World& world, std::span<const int> bodies,
                   const std::vector<Eigen::Vector3d>& first,
                   const std::vector<Eigen::Vector3d>& corrected, double round_off);

}  // namespace pinchlab
