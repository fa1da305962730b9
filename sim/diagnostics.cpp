// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/diagnostics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/held.h"
#include "sim/cable/held_spans.h"
#include "sim/cable/mass.h"
#include "sim/energy.h"

namespace pinchlab {

bool check_finite(const Scene& scene, World& world) {
  double sum = 0.0;
  for (int b = 0; index(b) < world.bodies.size(); ++b) sum += zero_if_finite(world, b);
  if (sum == 0.0) return true;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    if (std::isfinite(world.velocity[b].x()) && std::isfinite(world.velocity[b].y()) &&
        std::isfinite(world.angular_velocity[b])) {
      continue;
    }
    std::string cables;
    for (std::size_t c = 0; c < world.cables.size(); ++c) {
      const auto& links = world.cables[c].links;
      for (std::size_t i = 0; i < links.size(); ++i) {
        if (links[i].body == static_cast<int>(b)) {
          cables += fmt::format(", cable '{}' link {}", scene.cables[c].name, i);
        }
      }
    }
    world.failure = fmt::format(
        "step {} (t = {} s): velocity of body '{}' is not finite{}; method {}", world.step,
        world.time(), scene.bodies[b].name, cables, to_string(world.configuration));
    return false;
  }
  return true;
}

namespace {

/// Fails where a body is so far away that numbers do not tell a thousandth of a cable's half width
/// there: whatever has exploded goes on at ten seconds a step, for long.
bool check_distances(const Scene& scene, World& world) {
  constexpr double least = 1e-3, unit = std::numeric_limits<double>::epsilon();
  for (const Cable& cable : scene.cables) {
    const double most = least * cable.half_width / unit;  // m
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
      const double distance = world.position[b].cwiseAbs().maxCoeff();
      if (!(distance > most)) continue;
      world.failure = fmt::format(
          "step {} (t = {} s): body '{}' is {:.3g} m away, where numbers do not tell a thousandth "
          "of "
          "the half width of cable '{}'; method {}",
          world.step, world.time(), scene.bodies[b].name, distance, cable.name,
          to_string(world.configuration));
      return false;
    }
  }
  return true;
}

}  // namespace

bool check_positions(const Scene& scene, World& world) {
  constexpr double far = 1e9;        // m, within which no cable is so thin
  double sum = 0.0, farthest = 0.0;  // the sum as above
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    sum += 0.0 * (world.position[b].x() + world.position[b].y() + world.angle[b]);
    farthest = std::max(farthest, world.position[b].cwiseAbs().maxCoeff());
  }
  const bool bodies = sum == 0.0;
  std::size_t c = 0;
  while (c < world.cables.size() && world.cables[c].finite) ++c;
  const bool finite = bodies && c == world.cables.size();
  if (finite) return farthest < far || check_distances(scene, world);
  std::string what = "a position";
  for (std::size_t b = 0; !bodies && b < world.bodies.size(); ++b) {
    if (world.position[b].allFinite() && std::isfinite(world.angle[b])) continue;
    what = fmt::format("position of body '{}'", scene.bodies[b].name);
  }
  if (bodies) what = fmt::format("a span of cable '{}'", scene.cables[c].name);
  world.failure = fmt::format("step {} (t = {} s): {} is not finite; method {}", world.step,
                              world.time(), what, to_string(world.configuration));
  return false;
}

bool check_corners(const Scene& scene, World& world) {
  // A cable that a polygon winds up without end costs more with each turn: this is what makes a
  // step last milliseconds.
  constexpr std::size_t most_corners_met = 20'000;
  for (std::size_t i = 0; i < world.cables.size(); ++i) {
    const std::vector<Link>& links = world.cables[i].links;
    if (links.size() <= most_corners_met) continue;  // of discs and corners
    const auto met = std::count_if(links.begin(), links.end(),
                                   [](const Link& link) { return link.corner >= 0; });
    if (static_cast<std::size_t>(met) <= most_corners_met) continue;
    world.failure = fmt::format("step {} (t = {} s): cable '{}' bends round more than {} corners",
                                world.step, world.time(), scene.cables[i].name, most_corners_met);
    return false;
  }
  return true;
}

double potential_energy(const Scene& scene, const World& world) {
  double energy = 0.0;
  for (int b = 0; index(b) < world.bodies.size(); ++b) {
    energy += potential_energy_of_body(scene, world, b);
  }
  for (int c = 0; index(c) < world.cables.size(); ++c) {
    energy += potential_energy_of_cable(scene, world, c);
  }
  for (const NodeChain& chain : scene.chains) {
    energy += potential_energy_held(world, chain, scene.gravity);
  }
  return energy;
}

double kinetic_energy(const BodyProperties& body, const Vec2& v, double omega) {
  if (body.kind == BodyKind::fixed) return 0.0;
  const double turning = 0.5 * inertia_of(body) * omega * omega;
  return can_move(body) ? turning + 0.5 * body.mass * v.squaredNorm() : turning;
}

double kinetic_energy(const World& world) {
  double energy = 0.0;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    energy += kinetic_energy(world.bodies[b], world.velocity[b], world.angular_velocity[b]);
  }
  return energy;
}

double kinetic_energy(const World& world, const Instant& before, double length, int body) {
  const auto b = index(body);
  const double after = share_after(before.lag[b], length);
  const Vec2 v = (1.0 - after) * before.velocity[b] + after * world.velocity[b];
  const double omega = (1.0 - after) * before.turning[b] + after * world.angular_velocity[b];
  double energy = 0.0;
  if (!before.carried.empty()) {
    const Eigen::Vector3d all(v.x(), v.y(), omega);
    energy += 0.5 * all.dot(before.carried[b] * all);
  }
  return energy + kinetic_energy(world.bodies[b], v, omega);
}

double kinetic_energy(const World& world, const Instant& before, double length) {
  double energy = 0.0;
  for (int b = 0; index(b) < world.bodies.size(); ++b) {
    energy += kinetic_energy(world, before, length, b);
  }
  for (const Sleeve& sleeve : before.sleeves) {
    energy += kinetic_energy_of_sleeve(world, before, length, sleeve);
  }
  return energy;
}

double kinetic_energy_of_sleeves(const World& world, const Instant& before, double length,
                                 int cable) {
  double energy = 0.0;
  for (const Sleeve& sleeve : before.sleeves) {
    if (sleeve.cable != cable) continue;
    energy += kinetic_energy_of_sleeve(world, before, length, sleeve);
  }
  return energy;
}

void note_instant(const World& world, Instant& instant) {
  instant.lag.clear();
  for (const Pace& pace : world.pace) instant.lag.push_back(pace.lag);
  instant.velocity = world.velocity;
  instant.turning = world.angular_velocity;
  find_carried(world, instant.carried, instant.sleeves);
}

void measure_cables(const Scene& scene, World& world) {
  Diagnostics& d = world.diagnostics;
  d.largest_stretch = d.largest_gap_violation = d.cable_length_error = 0.0;
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    const CableState& cable = world.cables[c];
    double length = 0.0;
    for (std::size_t i = 0; i < cable.links.size(); ++i) {
      length += wrapped_material(world, cable, i);
      if (i < first_segment(cable)) continue;
      const Segment& segment = cable.segments[i];
      length += material_of_span(cable, i);
      if (segment.pinched || scene.cables[c].axial_stiffness < infinity) continue;
      d.largest_stretch = std::max(d.largest_stretch, segment.length - segment.rest_length);
    }
    d.cable_length_error = std::max(d.cable_length_error, std::abs(length - cable.length));
  }
  for (const Contact& contact : world.contacts) {
    d.largest_gap_violation = std::max(d.largest_gap_violation, contact.target - contact.gap);
  }
}

}  // namespace pinchlab
