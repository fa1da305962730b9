// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Straight pieces of cables with mass whose number of nodes adapts, and what asks for nodes in
// them: adapt_nodes.h has the reasons.

#include <array>

#include "sim/box_tree.h"
#include "sim/world.h"

namespace pinchlab {

/// Of what makes one piece two, what lets two be one: so that nothing comes and goes at one border,
/// though two pieces show somewhat less of a curve than one would.
constexpr double hysteresis = 0.5;

/// A straight line between two ends: of a piece, or of what two would become.
struct Line {
  const Link *from = nullptr, *to = nullptr;
  std::array<int, 2> passes{-1, -1};  // bodies before and after it, that it cannot meet; or -1
  Vec2 direction = Vec2::Zero();
  double length = 0.0;   // m
  double tension = 0.0;  // N, of the last step
  int pieces = 0;        // of the finest
};

/// 1/m, as a line and the piece before or after it tell.
double curvature(const Line& line, const Segment& other);

/// What lines may come near: bodies but nodes, each with the room that its own motion asks for,
/// and, as -1 - wall, walls.
void find_surroundings(const Scene& scene, const World& world, BoxTree& near);

/// Whether a body or wall is no further from the line than `times` (at most 1 / hysteresis) what
/// both may move in two steps, with what the cable may be off it (m).
bool is_near_something(const Scene& scene, const World& world, const BoxTree& near,
                       const Line& line, double off, double times);

/// J/kg, |v_b - v_a|^2 / 8.
double spread_of(const World& world, const Line& line);

/// J/kg, of a node's swing between two pieces: of its motion (m/s) to the line, and of how far it
/// is off where it would be in balance across that, bearing `pull` (N), or less, beside tensions.
double swing_of(double mass, const Vec2& motion, const Vec2& pull, const Line& line,
                const Segment& before, const Segment& after);

/// Whether a node is in touch with something.
bool is_in_contact(const World& world, int node);

/// The share of its bend that a piece is to have after a step: it is let out towards `wanted`,
/// c (m) being the length of its line. `rate`: of the letting out (1/s), which follows.
double share_let_out(const Scene& scene, double step_length, double wanted, double c, double& rate);

/// What a bend would be, as a share of what it is, under half of its line's tension. The line is
/// `spare` (m) shorter than its cable and holds that first moment (kg m, in the frame of the line).
double wanted_share(const Scene& scene, const Segment& line, double spare, const Vec2& held);

}  // namespace pinchlab
