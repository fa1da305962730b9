// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Tensions of a world in which nothing has been solved for yet.

namespace pinchlab {

struct Scene;
struct Workspace;
struct World;

/// Gives segments the tensions of time 0, which the first step's steady_light_bodies goes by. The
/// world's contacts and parts are to be those of its start. Systems of `work` are lost: all parts
/// are solved for in one, as a world of many would not fit into any cache.
void find_first_tensions(const Scene& scene, World& world, Workspace& work);

}  // namespace pinchlab
