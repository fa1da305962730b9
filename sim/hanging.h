// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How chains hang at rest.

#include <vector>

#include "sim/scene.h"

namespace pinchlab {

/// A chain at rest.
struct Hanging {
  std::vector<Vec2> directions;  // unit, of its pieces from its start on
  double tension = 0.0;          // N, of the piece that bears most
};

/// A chain of pieces of equal length (m) whose ends are d (m) apart, with `weights` (N) at the
/// nodes between them. The tension of piece k is t_k = t_0 - sum of the weights before it, and the
/// pieces l t_k / |t_k| add up to d: where the convex function sum l |t_k| - t_0 . d is least,
/// which Newton's method finds. The chain must be longer than d.
Hanging hang(const std::vector<Vec2>& weights, double length, const Vec2& d);

}  // namespace pinchlab
