// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/world.h"

namespace pinchlab {

struct BodyPair;
struct PiecePair;
struct Workspace;

/// Width of the widest cable that may come between bodies (m).
double widest_cable(const World& world);

/// Whether a pair, of which one moves, is so near that it may have a contact at the speeds that the
/// two have. `width` by widest_cable.
bool may_touch(const Scene& scene, const World& world, double width, const BodyPair& pair);
bool may_touch(const Scene& scene, const World& world, const PiecePair& pair);

/// Contacts of all pairs and walls that can touch within the next step; states of old ones are
/// kept. Of a divided step, contacts between neighbourhoods are for its end.
void find_contacts(const Scene& scene, World& world, Workspace& work);

}  // namespace pinchlab
