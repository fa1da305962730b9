// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/elastic.h"

#include <algorithm>

#include "base/at.h"
#include "sim/cable/creep.h"
#include "sim/solve/rows.h"
#include "sim/world.h"

namespace pinchlab {

void make_elastic(const World& world, const Cable& given, const Segment& segment, const TimeSpan& t,
                  PartSystem& s, int number) {
  const double stiffness = given.axial_stiffness;
  const bool both_ways = given.rod;
  Row& row = at(s.rows, number);
  RowBodies& bodies = at(s.bodies, number);
  const double h = t.length > 0.0 ? t.length : world.step_length;
  const double flexibility = std::max(segment.rest_length, 0.0) / stiffness;  // m/N
  const bool sweeps =
      world.configuration.solver == Solver::iterative;  // the thesis' implicit Euler
  const double square = h * h * row.diagonal;           // (omega h)^2 times flexibility
  const double damped =
      sweeps || flexibility == 0.0 ? 1.0 : std::max(0.0, 1.0 - 4.0 * flexibility / square);
  const double b = 0.25 * (1.0 - damped);
  const CableState& cable = at(world.cables, row.index);
  const Link &to = at(cable.links, row.item),
             &from = at(cable.links, previous_link(cable, row.item));
  const double creep = cable.rims.empty() ? 0.0 : creep_speed(world, cable, row.item);
  const double before = to.slip_speed - from.slip_speed - speed_of(world, from.body, bodies.ja) -
                        speed_of(world, to.body, bodies.jb) + creep;         // dC/dt(v-), m/s
  double known = t.kick * row.clearance + 4.0 * b * t.lag * t.lag * before;  // -m s
  if (t.length == 0.0) {
    if (damped > 0.0) return;
    const double impulse = both_ways ? -known / flexibility : std::max(0.0, -known / flexibility);
    const RowResponse& response = at(s.responses, number);
    at(s.free_velocity, bodies.a) += impulse * response.ra;
    at(s.free_velocity, bodies.b) += impulse * response.rb;
    const double damper = given.damping * t.kick;  // kg
    row.idle = damper == 0.0;
    row.on = row.clamped = !row.idle;
    row.bias = 0.0;
    row.compliance = row.idle ? 0.0 : 1.0 / damper;
    return;
  }
  const double damper = flexibility * given.damping * t.kick;  // s^2
  const double taken = given.damping * t.kick * row.diagonal;
  const double after = taken > 0.0 ? Drag(taken).after / taken : 0.5;  // its share
  known -= (1.0 - after) * damper * before;
  const double scale = b * h * h + damped * h * t.kick + after * damper;
  row.idle = false;
  row.clamped = both_ways;
  row.on = both_ways || !segment.slack;
  row.compliance = flexibility / scale;
  bodies.curvature = -creep;  // and what else there is of it is found at the interval's end
  row.bias = known / scale - creep;
}

}  // namespace pinchlab
