// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/world.h"

namespace pinchlab {

struct Part;
struct Workspace;

/// An impact of a part: velocities after it, from those just before it, at the same time and
/// positions.
///
/// Contacts that rebound are struck one after another, the fastest first, as Newton's law of impact
/// has it for two bodies: J v+ = -e J v-, e the greater of the two coefficients; those that close
/// equally fast at once. Meanwhile taut cables hold, and other contacts do not: so Newton's cradle
/// passes its impulse on. What still approaches then is stopped, all at once: of all contacts and
/// cables J v+ >= 0, inelastic, with friction. Each of these solves is a projection of the
/// velocities (but for a share e <= 1 of the normal one), so that none of them makes energy.
///
/// What parts from what it touches has `Contact::rebounds` until it has. `rebounds`: false leaves
/// out the blows, as if all restitution were 0, and what they lift.
void strike(const Scene& scene, World& world, Workspace& work, const Part& part, bool rebounds);

}  // namespace pinchlab
