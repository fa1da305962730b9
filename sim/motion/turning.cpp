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

/// J, of a place's body and the cables that it carries, at that velocity.
double kinetic_energy_at(const World& world, std::span<const int> bodies, std::size_t place,
                         const Eigen::Vector3d& v, const PartSystem& s) {
  double energy = 0.0;
  if (place < bodies.size())
    energy += kinetic_energy(at(world.bodies, bodies[place]), v.head<2>(), v.z());
  if (place < s.carried.size()) energy += 0.5 * v.dot(s.carried[place] * v);
  return energy;
}

/// The same of loose spans: the greatest share of its ends' energy that the flow over their rims
/// swings.
double turned_by_flow(const World& world, std::span<const int> bodies, double length,
                      const PartSystem& s) {
  if (s.carried.empty()) return 0.0;
  double greatest = 0.0;
  for (const MassedSpan& span : s.masses.spans) {
    if (spare_of(span) <= s.tolerance() || (span.p_a == 0.0 && span.p_b == 0.0)) continue;
    const FlowForces forces = flow_forces(span, s.velocity);
    const double pushed = forces.on_a.dot(at(s.mobility, span.a) * forces.on_a) +
                          forces.on_b.dot(at(s.mobility, span.b) * forces.on_b);
    if (pushed == 0.0) continue;
    const auto kinetic = [&](int place) {
      return kinetic_energy_at(world, bodies, index(place), at(s.velocity, place), s);
    };
    const double swung = 0.5 * length * length * pushed;
    greatest = std::max(greatest, swung / (kinetic(span.a) + kinetic(span.b)));
  }
  return greatest;
}

}  // namespace

double turned_square(const World& world, std::span<const int> bodies, double length,
                     const PartSystem& s) {
  const double round_off = s.tolerance() / length;  // m/s
  const double by_flow = turned_by_flow(world, bodies, length, s);
  double swung = 0.0;  // J
  for (const Row& row : s.rows) {
    if (std::abs(row.curved) <= round_off) continue;
    swung += std::abs(row.impulse * row.curved);
  }
  if (swung == 0.0) return by_flow;
  double kinetic = 0.0;  // J
  for (std::size_t i = 0; i < std::max(bodies.size(), s.carried.size()); ++i) {
    kinetic += std::max(kinetic_energy_at(world, bodies, i, s.velocity[i], s),
                        kinetic_energy_at(world, bodies, i, s.free_velocity[i], s));
  }
  return std::max(swung / kinetic, by_flow);
}

bool bends_too_far(const World& world, std::span<const int> bodies,
                   const std::vector<Eigen::Vector3d>& first,
                   const std::vector<Eigen::Vector3d>& corrected, double round_off) {
  const double fastest = greatest_speed(world, bodies, first, nullptr);
  return greatest_speed(world, bodies, corrected, &first) > std::max(0.5 * fastest, round_off);
}

}  // namespace pinchlab
