// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What broad_phase.h finds, by trying everything: the thesis' way, cost quadratic in the scene.

namespace pinchlab {

struct Scene;
struct World;

/// The box of each body against that of each other (thesis: PinchBroadPhase). Finds what
/// find_body_pairs does, in its order.
void find_all_body_pairs(const Scene& scene, World& world);

/// Each segment, those without length too, against each body (the first half of the thesis'
/// SegmentIntersections; span_hits.h is the second). Finds what find_span_pairs does, in its order,
/// and besides the bodies at segments without length.
void find_all_span_pairs(const Scene& scene, World& world);

}  // namespace pinchlab
