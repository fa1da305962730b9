// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Energy (J) of single bodies and cables: diagnostics.h has that of all.

#include "sim/diagnostics.h"

namespace pinchlab {

/// Of a body in gravity; and of a cable, but for what a chain of nodes that adapts holds
/// (potential_energy_held).
double potential_energy_of_body(const Scene& scene, const World& world, int body);
double potential_energy_of_cable(const Scene& scene, const World& world, int cable);

/// The share of what is after a kick, of the velocity at its time.
inline double share_after(double lag, double length) {
  return lag / (lag + 0.5 * length);
}

/// Kinetic energy of one of Instant::sleeves, as that of bodies in diagnostics.h.
double kinetic_energy_of_sleeve(const World& world, const Instant& before, double length,
                                Sleeve sleeve);

}  // namespace pinchlab
