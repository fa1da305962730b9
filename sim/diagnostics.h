// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/world.h"

namespace pinchlab {

struct Workspace;

/// Whether all velocities are finite; if not, world.failure says which body, at what step and time.
bool check_finite(const Scene& scene, World& world);

/// The same of positions, angles, and spans' lengths and tensions; and that no cable
/// bends round absurdly many corners.
bool check_positions(const Scene& scene, World& world);

/// Energy of gravity and of stretched cables at the present positions (J).
double potential_energy(const Scene& scene, const World& world);

/// Kinetic energy at the step's start (J), from the velocities before and after its first kick:
/// those between them are right to second order.
double kinetic_energy(const World& world, const Workspace& work);

/// Stretch, gaps and cable lengths at the present positions.
void measure_cables(const Scene& scene, World& world);

}  // namespace pinchlab
