// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a scene's reader checks too, for scenes that are made by a program, and what only a laid
// scene can tell. All of these throw SceneError.

#include <string>

#include "sim/world.h"

namespace pinchlab {

struct BroadPhase;

/// Two things may overlap by this much (m) at the start, what decimal figures in a scene file
/// leave: a share of the scene's largest coordinate, length or radius.
double overlap_allowed(const Scene& scene);

/// "12.3 mm"
std::string in_mm(double metres);

/// "/bodies/3"
std::string pointer(const char* list, std::size_t i);

/// "body 'wheel'", or "the world" (-1).
std::string name_of_body(const Scene& scene, int body);

/// Figures that the geometry takes for granted.
void refuse_impossible_figures(const Scene& scene);

/// Bodies in one another or in a wall.
void refuse_overlaps(const Scene& scene, const World& world, const BroadPhase& broad);

/// Spans that run through bodies.
void refuse_cables_through_bodies(const Scene& scene, const World& world, const BroadPhase& broad);

/// Contacts nearer than the cable between them is wide.
void refuse_squeezed_wraps(const Scene& scene, const World& world);

}  // namespace pinchlab
