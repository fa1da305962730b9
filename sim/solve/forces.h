// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pinchlab {

struct Part;
struct Parts;
struct PartSystem;
struct TimeSpan;
struct Scene;
struct Workspace;
struct World;

/// Velocities of all bodies that are awake after forces alone have acted for the interval's kick, and
/// what moves the bodies, into their parts' systems.
void apply_forces(const Scene& scene, const World& world, const TimeSpan& interval,
                  Workspace& work);

/// The same of one part.
void apply_forces(const Scene& scene, const World& world, const TimeSpan& interval,
                  const Parts& parts, const Part& part, PartSystem& system);

}  // namespace pinchlab
