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

}  // namespace pinchlab
