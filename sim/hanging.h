// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How chains hang at rest.

#include <optional>
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
  std::vector<Vec2> tensions;    // N, of the pieces
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

/// A chain of rods, which bear a push too, between a point and another `reach` (m) from it; all
/// weights point one way, and none is 0. It is at rest where
///     F = sum s_j l_j t_j / |t_j| - reach = 0,    t_j = t_k + (the weights from rod j to rod k),
/// with s_j = 1 for rods that pull and -1 for those that push, which Newton's method solves for t_k
/// with J = sum s_j l_j / |t_j| (I - u_j u_j^T).
///     A chain of which no piece is slack is one of rods that all pull. Where one is, rod k, the
/// rest of the chain stands upright, and leaves r = reach - sum of l_j u_j to it, |r| < l_k: too
/// little for a rod, which pushes. For a small push a in direction v, t_k = -a v, the others lean
/// by c a v_x, c = sum of l_j / |t_j|, with x across the weights and y along them:
///     l_k v_y = r_y,    l_k v_x = r_x + c a v_x,    |v| = 1,
/// from where Newton's method starts; to either side where r_x = 0.
///     Nothing where it finds none.
std::optional<Hanging> hang_rods(const std::vector<Vec2>& weights,
                                 const std::vector<double>& lengths, const Vec2& reach);

}  // namespace pinchlab
