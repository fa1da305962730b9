// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What broad_phase.h finds, by trying everything: the thesis' way, cost quadratic in the scene.

namespace pinchlab {

struct Scene;
struct Workspace;
struct World;

/// The box of each body against that of each other (thesis: PinchBroadPhase), anew at each step.
/// The contacts that follow are those that follow from find_body_pairs.
void find_all_body_pairs(const Scene& scene, const World& world, Workspace& work);

/// Each segment, those without length too, against each body (the first half of the thesis'
/// SegmentIntersections; span_hits.h is the second). The hits that follow are those that follow
/// from find_span_pairs.
void find_all_span_pairs(const World& world, Workspace& work);

}  // namespace pinchlab
