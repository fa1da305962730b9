// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/at.h"
#include "sim/cable/sleeve.h"
#include "sim/world.h"

namespace pinchlab {

/// How bodies, and cables with mass, move before a kick. By note_instant.
struct Instant {
  std::vector<double> lag;               // s, of World::pace
  std::vector<Vec2> velocity;            // m/s
  std::vector<double> turning;           // rad/s
  std::vector<Eigen::Matrix3d> carried;  // by find_carried
  std::vector<Sleeve> sleeves;           // likewise
};

void note_instant(const World& world, Instant& instant);

/// Whether all velocities are finite; if not, world.failure says which body, at what step and time.
bool check_finite(const Scene& scene, World& world);

/// The same of positions, angles, and spans' lengths and tensions, and of what is too far away.
bool check_positions(const Scene& scene, World& world);

/// The same, where links have come, of how many corners a cable bends round: not absurdly many.
bool check_corners(const Scene& scene, World& world);

/// Energy of gravity and of stretched cables at the present positions (J).
double potential_energy(const Scene& scene, const World& world);

/// Zero, or a NaN where a velocity of the body's is not finite: one sum tells of many.
inline double zero_if_finite(const World& world, int body) {
  const Vec2& v = at(world.velocity, body);
  return 0.0 * v.x() + 0.0 * v.y() + 0.0 * at(world.angular_velocity, body);
}

/// Kinetic energy (J) of a body that moves at v (m/s) and turns at omega (rad/s).
double kinetic_energy(const BodyProperties& body, const Vec2& v, double omega);

/// Kinetic energy of all bodies at the velocities that they have (J).
double kinetic_energy(const World& world);

/// Kinetic energy (J) at the time of `before`'s positions, from the velocities before and after a
/// kick, the latter in the middle of an interval of `length` (s) from there: what is between them
/// is right to second order. Of all that moves, of one body, or of a cable's sleeves.
double kinetic_energy(const World& world, const Instant& before, double length);
double kinetic_energy(const World& world, const Instant& before, double length, int body);
double kinetic_energy_of_sleeves(const World& world, const Instant& before, double length,
                                 int cable);

/// Stretch, gaps and cable lengths at the present positions.
void measure_cables(const Scene& scene, World& world);

}  // namespace pinchlab
