// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/turning.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/diagnostics.h"
#include "sim/solve/part_system.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

/// The greatest speed of bodies and their rims (m/s), of `velocity` less `other`.
double greatest_speed(const World& world, std::span<const int> bodies,
                      const std::vector<Eigen::Vector3d>& velocity,
                      const std::vector<Eigen::Vector3d>* other) {
  double greatest = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Eigen::Vector3d v = velocity[i];
    if (other) v -= (*other)[i];
    const double rim = at(world.bodies, bodies[i]).radius * v.z();
    greatest = std::max({greatest, std::abs(v.x()), std::abs(v.y()), std::abs(rim)});
  }
  return greatest;
}

}  // namespace

double turned_square(const World& world, std::span<const int> bodies, double length,
                     const PartSystem& s) {
  const double round_off = s.tolerance() / length;  // m/s
  double swung = 0.0;                               // J
  for (const Row& row : s.rows) {
    if (row.compliance > 0.0 || std::abs(row.curved) <= round_off) continue;
    swung += std::abs(row.impulse * row.curved);
  }
  if (swung == 0.0) return 0.0;
  double kinetic = 0.0;  // J
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyProperties& body = at(world.bodies, bodies[i]);
    const Eigen::Vector3d &v = s.velocity[i], &free = s.free_velocity[i];
    kinetic += std::max(kinetic_energy(body, v.head<2>(), v.z()),
                        kinetic_energy(body, free.head<2>(), free.z()));
  }
  for (std::size_t i = 0; i < s.carried.size(); ++i) {
    const Eigen::Vector3d &v = s.velocity[i], &free = s.free_velocity[i];
    kinetic += 0.5 * std::max(v.dot(s.carried[i] * v), free.dot(s.carried[i] * free));
  }
  return swung / kinetic;
}

bool bends_too_far(const World& world, std::span<const int> bodies,
                   const std::vector<Eigen::Vector3d>& first,
                   const std::vector<Eigen::Vector3d>& corrected, double round_off) {
  const double fastest = greatest_speed(world, bodies, first, nullptr);
  return greatest_speed(world, bodies, corrected, &first) > std::max(0.5 * fastest, round_off);
}

}  // namespace pinchlab
