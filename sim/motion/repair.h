// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is put right in the positions alone: a repair never becomes velocity.

#include "sim/world.h"

namespace pinchlab {

struct Part;
struct Parts;
struct Workspace;

/// Slack that a closing pinch would enclose goes to the spans beside it, half to either; all to the
/// one where the other is a closed pinch itself. What one lacks of a cable that stretches comes
/// from them likewise: bodies that made up for it would part. Cables that sleep keep theirs.
void refill_pinches(World& world, const Parts& parts);

/// Puts right what is too long or too near in a part by moving its bodies, the heavier the less;
/// their velocities stay. A step of this Newton's method is no longer than a small share of a body,
/// and one that makes nothing better is taken back. Where no other does, motors let their bodies
/// turn; where a constraint has hardly any gradient then, its violation stays, as a fallback.
/// Returns whether anything has been moved.
bool repair(const Scene& scene, World& world, Workspace& work, Part& part);

}  // namespace pinchlab
