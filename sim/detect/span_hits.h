// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Bodies against free spans: new links (thesis: SegmentIntersections and AddJoints).

#include "sim/world.h"

namespace pinchlab {

struct Workspace;

/// Gives every body that has met a free span a link on it. A body meets a span when its margin
/// reaches the span's centre line with the body's centre beside the span, or when its centre has
/// crossed the span within the step, however fast. The cable runs round the side on which the body
/// was before.
void add_hit_links(World& world, const Workspace& work);

}  // namespace pinchlab
