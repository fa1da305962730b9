// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which contacts press a cable (thesis: PinchNarrowPhase, PinchConfirm, ConfigurePinchJoints).

#include "sim/world.h"

namespace pinchlab {

struct Workspace;

/// Which contacts press a cable, and the gap that they therefore keep. Puts middle links into new
/// non-transitional pinches and takes them out of those that have opened.
void configure_pinches(World& world, Workspace& work);

/// Tells each pinch of the parts that are awake its contact, and each contact how many cables it
/// presses and how far apart it must keep its bodies.
void assign_contacts(World& world, const Workspace& work);

/// Arc (rad after the tail) at which the direction `u` from the body's centre meets the cable
/// stored on link i, in [-tolerance, 2 pi - tolerance); the same plus whole turns up to link.wrap
/// also do.
double arc_of_direction(const CableState& cable, std::size_t link, const Vec2& u);

/// rad: what presses at the very end of an arc, where its span leaves, presses it, however that end
/// moves within a step. About a degree: no other turn, 2 pi away, comes near, and over so much of
/// an arc a span is off its body by 2e-4 of the radius only.
constexpr double arc_tolerance = 0.02;

}  // namespace pinchlab
