// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What of a slack span lies on the bodies that hold its ends.

#include <array>
#include <vector>

#include "render/picture/hanging.h"
#include "render/picture/picture.h"
#include "sim/world.h"

namespace pinchlab {

/// Cable that lies on the rim to which it is fastened, from direction to direction (rad).
struct Rest {
  SpanEnd rim;  // none: of radius 0
  double from = 0.0, to = 0.0;
  double length() const { return std::abs(rim.signed_radius * (to - from)); }  // m
};

/// It as the points of a strip, of material that begins with `material` (m).
std::vector<StripPoint> points_of(const Rest& rest, double material);

struct RestingSpan {
  HangingSpan hung;
  Rest at_tail, at_head;
};

/// The shape of a slack span that does not hang through what holds its ends, of which it is `hung`
/// without heed of that: it lies on the turns of a drum, and on the rim of a disc to which it is
/// fastened. `links`: those of its tail and its head; `ends` likewise. `length`: m, as in hang.
RestingSpan rest_on_ends(const World& world, const CableState& cable,
                         const std::array<std::size_t, 2>& links, std::array<SpanEnd, 2> ends,
                         double length, const HangingSpan& hung, const Vec2& up);

}  // namespace pinchlab
