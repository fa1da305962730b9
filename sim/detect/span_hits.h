// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Bodies against free spans: new links (thesis: SegmentIntersections and AddJoints).

#include <span>
#include <vector>

#include "sim/world.h"

namespace pinchlab {

struct Happening;
struct SpanPair;
struct Workspace;

/// Overlap below which a body only grazes the cable, as a share of its radius and the half width:
/// round-off must not make links.
constexpr double graze = 1e-10;

/// Gives every body that has met a free span a link on it. A body meets a span when its margin
/// reaches the span's centre line with the body's centre beside the span, or when its centre has
/// crossed the span within the step, however fast. The cable runs round the side on which the body
/// was before.
void add_hit_links(World& world, Workspace& work);

/// Gives a segment that has just closed up, where its cable had gone over a point (m), links on
/// what lies within that bend, of the bodies that the cable's spans were near. Returns how many.
int meet_in_closing(World& world, Workspace& work, int cable, std::size_t segment,
                    const Vec2& over);

/// Whether the body is so near to where the span is, or was before, that it may have met it.
bool may_meet(const World& world, const SpanPair& pair);

/// Hits of these bodies and spans since the interval's start, appended to Workspace::events.
void find_hits(const World& world, Workspace& work, std::span<const SpanPair> pairs);

/// How far the body of a hit, or its corner, is with its margin from the span's centre line, on the
/// side on which a cable that ran round it would have that orientation (m); below 0 where it is
/// deeper. Of what has come to be beside the span at least how far it is from that.
double span_clearance(const World& world, const Happening& hit);

}  // namespace pinchlab
