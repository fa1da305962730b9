// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Tensions of a world in which nothing has been solved for yet.
//
// Lengths and gaps stay what they are, J v = 0, and so do these speeds:
//     J dv/dt + (dJ/dt) v = 0.
// Over a kick k from velocities v to v' that is J v' + k (dJ/dt) v = 0, exactly where forces stay
// the same meanwhile. The second term is by which the way is curved, as a pendulum's by v^2 / L.
// It is the change of J v as everything moves straight on: of a moment before and one after.

namespace pinchlab {

struct Scene;
struct Workspace;
struct World;

/// Gives segments the tensions of time 0, which the first step's steady_light_bodies goes by; where
/// velocities do not fit the cables, those after they have met them. Without the second term where
/// events are at the steps. The world's contacts and parts are to be those of its start. Systems of
/// `work` are lost: all parts are solved for in one, as a world of many would not fit into any
/// cache.
void find_first_tensions(const Scene& scene, World& world, Workspace& work);

}  // namespace pinchlab
