// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Joints between bodies, in terms of what the solver knows: cables of one straight segment that
// nothing hits. A bar bears force both ways and keeps its length exactly, as pieces between the
// nodes of a cable with mass do; a spring is an elastic bar. In tables they are cables, whose
// tension is negative where they push.

#include <string>

#include "sim/scene.h"

namespace pinchlab {

// The two points of a joint must not be on one body, both on the world, or, of a bar or spring, in
// one place: SceneError, whose place is the joint's name. Attachment::point may lie outside of its
// body.

/// Keeps the two points at the distance that they start with.
void add_bar(Scene& scene, const std::string& name, const Attachment& start, const Attachment& end);

/// Holds two bodies together at a point of the world (m), about which they turn; `other` may be -1,
/// the world. They no longer touch each other. Two bars do it, `name`:x and `name`:y, that pull the
/// body along the axes of the start: from the point on one body to two points of the other, or of
/// the world. Both keep their length just where the point is the same on both bodies, or by 1.4 of
/// that off it; so they are as long as a body's radius and as far as the bodies' centres lie from
/// the point, at least. They turn with the body whose centre is further from it (`other`, of two as
/// far): a wheel may spin on its axle however fast.
void add_hinge(Scene& scene, const std::string& name, int body, int other, const Vec2& point);

/// A force k (l - l0) + c dl/dt along the line between the two points, l their distance:
/// `stiffness` k > 0 (N/m), natural length l0 (m; 0: the distance that they start with), `damping`
/// c >= 0 (N s/m).
void add_spring(Scene& scene, const std::string& name, const Attachment& start,
                const Attachment& end, double stiffness, double natural_length, double damping);

/// Ends a rail body's travel at `low` <= 0 and `high` >= 0 (m along its axis from where it starts),
/// low < high. It arrives there without a rebound.
void add_stops(Scene& scene, int body, double low, double high);

}  // namespace pinchlab
