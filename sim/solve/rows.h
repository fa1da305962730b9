// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Constraint rows: one scalar condition on the velocities of two bodies each, or three
// (contact_bodies.h).

#include "base/at.h"
#include "sim/compound.h"
#include "sim/solve/part_system.h"
#include "sim/stages.h"
#include "sim/world.h"

namespace pinchlab {

struct Parts;
struct Part;
struct SolveScratch;

/// A body's place in its part; static bodies and the world (-1) share the one after the last.
int place_of(const Parts& parts, const PartSystem& system, int body);

/// Restitution of two bodies, or of a body and a wall: the greater of the two, so that who asks for
/// a rebound gets it.
double restitution_of(const World& world, const Contact& contact);

/// What a body (-1: none) adds to J v of a row that sees it by j, at the world's velocities (m/s).
inline double speed_of(const World& world, int body, const Eigen::Vector3d& j) {
  if (body < 0) return 0.0;
  const int mover = mover_of(world, body);
  const Vec2& v = at(world.velocity, mover);
  return j.x() * v.x() + j.y() * v.y() + j.z() * at(world.angular_velocity, mover);
}

/// Rows of a part for one solve at the present positions: of its cables, then of its contacts.
/// Notes in `scratch` what the solve must know of the interval.
void make_rows(const Scene& scene, const World& world, const Parts& parts, const Part& part,
               const TimeSpan& interval, PartSystem& system, SolveScratch& scratch,
               Stopwatch& watch);

/// Rows of a part's cables, from the first row on (thesis: SegmentsInit). Where the rows made last
/// were for the same links and the same kick, only those of segments that have moved are made anew.
void make_segment_rows(const Scene& scene, const World& world, const Parts& parts, const Part& part,
                       const TimeSpan& interval, PartSystem& system);

/// Adds the rows of a part's contacts (thesis: ContactsInit), and bounds all friction. Bodies that
/// cannot give way to one another get none.
void make_contact_rows(const Scene& scene, const World& world, const Parts& parts, const Part& part,
                       const TimeSpan& interval, PartSystem& system, SolveScratch& scratch);

}  // namespace pinchlab
