// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The yardstick of the stress experiment: the least that a direct step of one cable can consist of.

#include <vector>

#include "sim/world.h"

namespace pinchlab::experiments {

/// One cable as arrays, an entry a link in order along it.
struct BarePass {
  struct Body {
    Vec2 position, velocity;               // m, m/s
    double angular_velocity;               // rad/s
    double inverse_mass, inverse_inertia;  // 1/kg, 1/(kg m^2)
    double signed_radius;                  // m, of the cable's centre line
  };
  struct Row {
    Vec2 direction;              // unit, of the segment
    double length, rest_length;  // m
    double diagonal, upper, impulse;
  };
  std::vector<Body> bodies;
  std::vector<Row> rows;                       // rows[i] is the segment from body i to body i + 1
  double step_length = 0.0, compliance = 0.0;  // s; m/(N s^2) a metre of rest length

  /// From a world of one open cable that visits each body once.
  BarePass(const Scene& scene, const World& world);

  /// Tangents in closed form, assembly of J M^-1 J^T, Thomas elimination, velocities; nothing else:
  /// no forces, no motion, no material that moves, no detection, no slack.
  void step();
};

}  // namespace pinchlab::experiments
