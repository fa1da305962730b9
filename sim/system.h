// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The linear system for one guess of the active set's states.

#include "sim/world.h"

namespace pinchlab {

/// Solves for the impulses of all rows that bear one, given the rows' and runs' states, and sets
/// impulses, velocities and the rows' speeds accordingly.
///
/// Unknowns z are impulses of rows, or of groups of rows that depend on one another: p = F z.
/// Equations are rows, or sums G of them: G (J (v* + M^-1 J^T p) + bias + compliance p) = 0. The
/// matrix G (J M^-1 J^T + compliance) F is narrow in the order of scratch.order and is factored
/// directly. Where nothing slides F and G are the identity and the matrix is symmetric. Where
/// constraints repeat one another, the solution of least norm is taken, as for equally stiff
/// cables.
void solve_for_states(World& world);

/// The part whose rows stand in world.scratch.rows.
inline const Part& part_being_solved(const World& world) {
  return world.scratch.parts.list[static_cast<std::size_t>(world.scratch.active_set.part)];
}

/// Velocities of the part's bodies = free velocities.
void release_bodies(World& world);

/// Velocities of the part's bodies = free velocities + what the rows' impulses do.
void apply_impulses(World& world);

/// J v at the present velocity of one of the row's bodies (m/s).
inline double body_speed(const World& world, int body, const Eigen::Vector3d& j) {
  const Vec2& v = world.velocity[static_cast<std::size_t>(body)];
  return j.x() * v.x() + j.y() * v.y() +
         j.z() * world.angular_velocity[static_cast<std::size_t>(body)];
}

/// J v + bias at the present velocities (m/s).
inline double row_speed(const World& world, const Row& row) {
  double w = row.bias;
  if (row.a >= 0) w += body_speed(world, row.a, row.ja);
  if (row.b >= 0) w += body_speed(world, row.b, row.jb);
  return w;
}

inline void push_body(World& world, int body, const Eigen::Vector3d& response, double impulse) {
  const auto b = static_cast<std::size_t>(body);
  world.velocity[b] += impulse * response.head<2>();
  world.angular_velocity[b] += impulse * response.z();
}

/// Changes the velocities of the row's bodies by an impulse on it (N s).
inline void push(World& world, const Row& row, double impulse) {
  if (impulse == 0.0) return;
  if (row.a >= 0) push_body(world, row.a, row.ra, impulse);
  if (row.b >= 0) push_body(world, row.b, row.rb, impulse);
}

}  // namespace pinchlab
