// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/world.h"

namespace pinchlab {

struct Workspace;

/// Contacts of all pairs and walls that can touch within the next step; states of old ones are
/// kept. Of a divided step, contacts between neighbourhoods are for its end.
void find_contacts(const Scene& scene, World& world, Workspace& work);

}  // namespace pinchlab
