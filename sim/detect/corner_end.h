// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Spans that leave a polygon at a corner, or come to it there: what may be its next corner's way.

#include <cstddef>

#include "sim/world.h"

namespace pinchlab {

/// The end of a span that holds it at a corner of a polygon, and the other. Of both ends the tail,
/// if both hold it so.
struct CornerEnd {
  const Link *end = nullptr, *other = nullptr;
  bool leaves = false;  // the span does, there
};

/// That at which the body holds a span; none (null) if it does not, or by no corner of it.
CornerEnd corner_end(const CableState& cable, std::size_t segment, int body);

/// m, by which a circle is on the inner side of the arc with which the cable goes on beyond a span,
/// if it turns the same way there: as on the span's inner side before. Infinity where the circle is
/// not beside that arc.
double clearance_of_arc(const World& world, const CableState& cable, std::size_t segment,
                        const CornerEnd& corner, const Vec2& centre, double margin);

}  // namespace pinchlab
