// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a scene's reader checks too, for scenes that are made by a program, and what only a laid
// scene can tell. All of these throw SceneError.

#include "sim/world.h"

namespace pinchlab {

struct BroadPhase;

/// kg, of a body that moves or turns, and is no node: a microgram, and more than anything that
/// hangs on a cable. What is beyond is a slip of the pen; what ratios are exact, README.md says.
constexpr double lightest_body = 1e-9, heaviest_body = 1e12;

/// Of a wrap: its angle is right to 1e-13 rad still, and nothing that is drawn shows more.
constexpr int most_extra_turns = 100;

/// Figures, choices and indices that everything else takes for granted (scene_figures.cpp).
void refuse_impossible_figures(const Scene& scene);

/// Of these only where cables run: what spread_nodes has to know before there is all of a scene.
void refuse_impossible_courses(const Scene& scene);

/// Cables with mass that may slip, where that is not solved: by sweeps, and with three rows a
/// pinch.
void refuse_slip_of_mass(const Scene& scene, const Configuration& configuration);

/// Bodies in one another or in a wall.
void refuse_overlaps(const Scene& scene, const World& world, const BroadPhase& broad);

/// Spans that run through bodies.
void refuse_cables_through_bodies(const Scene& scene, const World& world, const BroadPhase& broad);

/// More nodes than a cable of that length has room for.
void refuse_crowded_nodes(const Cable& given, const CableState& cable, std::size_t number);

/// Cables with mass and nodes that are straight between what holds them fast: no tension bears
/// their weight.
void refuse_what_cannot_hang(const Scene& scene, const World& world);

/// Cables with mass and nodes that hang into what they do not run over.
void refuse_hanging_into_others(const Scene& scene, const World& world, const BroadPhase& broad);

/// Contacts nearer than the cable between them is wide.
void refuse_squeezed_wraps(const Scene& scene, const World& world);

}  // namespace pinchlab
