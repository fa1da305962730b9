// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A cable's centre line as points with material coordinates.

#include <numbers>
#include <vector>

#include "render/picture/picture.h"
#include "sim/world.h"

namespace pinchlab {

/// The angle (rad) from the x axis of a direction that the simulator measures from the y axis.
constexpr double from_x_axis(double alpha) {
  return alpha + 0.5 * std::numbers::pi;
}

/// Distance of a cable's marks, m of material: eight half widths; about sixteen, and a whole number
/// of them, in a closed cable.
double mark_spacing(const CableState& cable);

/// Appends the centre line from the first link to the last (a closed cable: round to the first
/// again), as the points of strips; returns the index at which each strip begins. There is more
/// than one only where the cable runs round a body by more than a turn: the turns that the last one
/// hides are left out. Slack spans hang with their rest length, unless they sag less than about
/// `smallest_sag` m; a span too short to hang hands its slack to a slack one beside it. A middle
/// link of a non-transitional pinch has no wrap: its two segments are left out. `sweeps`, if given,
/// gets by how much (rad) the cable turns on each link.
std::vector<std::size_t> append_cable_path(const Scene& scene, const World& world,
                                           const CableState& cable, double smallest_sag,
                                           std::vector<StripPoint>& points,
                                           std::vector<double>* sweeps = nullptr);

}  // namespace pinchlab
