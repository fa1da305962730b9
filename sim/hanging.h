// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How chains hang at rest.

#include <vector>

#include "sim/scene.h"

namespace pinchlab {

/// What holds an end of a chain: a circle that the chain lies on and leaves as its tangent; with
/// p = 0 a point.
struct HangingEnd {
  Vec2 centre = Vec2::Zero();       // m
  double p = 0.0;                   // m, signed radius: the tangent's point is at -p left(u)
  Vec2 direction = Vec2(1.0, 0.0);  // in which the piece there has the length that it is given;
                                    // others lay some of it on the circle, or take some off
};

/// A chain at rest.
struct Hanging {
  std::vector<Vec2> directions;  // unit, of its pieces from its start on
  std::vector<double> lengths;   // m, between its nodes
  Vec2 tail = Vec2::Zero();      // m, where the first begins
  double tension = 0.0;          // N, of the piece that bears most
};

/// A chain of pieces of these lengths (m) between two ends, with `weights` (N) at the nodes between
/// them. The tension of piece k is t_k = t_0 - sum of the weights before it, its direction
/// u_k = t_k / |t_k|, and the pieces l_k u_k reach from the one end to the other: where
///     sum l_k |t_k| + P . t_0 - Q . t_n
/// is least, with P and Q the ends' points, which Newton's method finds. As an end's direction
/// turns by da its point moves by p u da, and the piece gets as much shorter or longer, so that the
/// gradient is P + sum l_k u_k - Q with circles too, and its derivative that of pieces alone.
///     Where the least is where a piece has no tension, that piece is slack: with |t| rounded to
/// sqrt(t^2 + e^2) it spans l t / sqrt(t^2 + e^2), whatever is left for it as e falls to nothing.
/// The chain must be longer than the ends are apart.
Hanging hang(const std::vector<Vec2>& weights, const std::vector<double>& lengths,
             const HangingEnd& tail, const HangingEnd& head);

}  // namespace pinchlab
