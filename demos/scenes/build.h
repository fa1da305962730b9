// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Pieces of scenes, for scenes that are made by rule instead of by file. Lengths in m, masses in
// kg; what is not said has the defaults of sim/scene.h.

#include <string>
#include <vector>

#include "sim/scene.h"

namespace pinchlab::build {

constexpr double pulley_radius = 0.5;      // m, of load_chain
constexpr double cable_half_width = 0.05;  // m

Body body(std::string name, BodyKind kind, const Vec2& position, double radius, double mass = 1.0);
Body body(std::string name, BodyKind kind, double x, double y, double radius, double mass = 1.0);

Attachment at(double x, double y);  ///< a point of the world
Attachment on(int body);            ///< the centre of a body

/// An open cable called "cable".
Cable cable(const Attachment& start, std::vector<Wrap> wraps, const Attachment& end,
            double half_width = cable_half_width);

/// Wraps of a row of bodies from `first` on: over the first, under the second, and so on in turn.
/// With both ends of the cable below, `count` is odd.
std::vector<Wrap> over_and_under(int first, int count);

/// Loads of `left` and `right` kg, bodies 0 and 1, on one cable over `pulleys` (odd) equal pulleys
/// with fixed axles in a row, over and under in turn: bodies 2 and on.
Scene load_chain(int pulleys, double left, double right, double pulley_mass,
                 double cable_friction = infinity);

}  // namespace pinchlab::build
