// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/world.h"

namespace pinchlab {

struct Workspace;

/// Whether all velocities are finite; if not, world.failure says which body, at what step and time.
bool check_finite(const Scene& scene, World& world);

/// Energy at the step's start, from the velocities before and after the kick (their mean is the
/// velocity at the positions' time to second order).
void measure_energy(const Scene& scene, World& world, const Workspace& work);

/// Stretch, gaps and cable lengths at the present positions.
void measure_cables(const Scene& scene, World& world);

}  // namespace pinchlab
