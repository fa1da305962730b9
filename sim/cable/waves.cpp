// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/waves.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/mass.h"
#include "sim/cable/strung.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

// (omega h)^2 at most; the header has the reasons.
constexpr double in_steps = 1.0;            // of a whole step, of cables that run over bodies
constexpr double in_steps_of_pieces = 2.0;  // the same, of pieces between nodes
constexpr double in_intervals = 0.25;       // of the intervals of others, as tried
// With the tensions that have come of them: they may double before an interval is tried again, so
// that one that rises does not ask for a trial each time; omega h is well below 1 still.
constexpr double at_most = 2.0 * in_intervals;

/// The square of the turning (1/s^2) of the span before a link, where neither of its ends is a node
/// and one is a rim.
double turning_before(const World& world, const CableState& cable, int link) {
  const int before = previous_link(cable, link);
  if (before < 0) return 0.0;
  const Segment& span = at(cable.segments, link);
  const Link &tail = at(cable.links, before), &head = at(cable.links, link);
  if (is_strung(cable, tail) || (tail.orientation == 0 && head.orientation == 0)) return 0.0;
  if (span.pinched || !(span.length > 0.0) || is_side(tail, head)) return 0.0;
  const Vec2 apart = velocity_of(world, head) - velocity_of(world, tail);
  const double turning = cross(span.direction, apart) / span.length;
  return turning * turning;
}

/// omega^2 (1/s^2): of what is not lost of the nodes and the spans' turning of a cable that runs
/// over bodies, or of the nodes at either end of a piece, under its tension; else 0.
double fastest_on(const World& world, const CableState& cable) {
  if (is_massed(cable)) {
    double fastest = 0.0;
    for (int i = 0; index(i) < cable.links.size(); ++i) {
      const double wave = is_strung(cable, at(cable.links, i)) ? wave_at_node(world, cable, i)
                                                               : turning_before(world, cable, i);
      if (!is_lost(world, wave)) fastest = std::max(fastest, wave);
    }
    return fastest;
  }
  if (!cable.piece || cable.pieces == 0) return 0.0;
  const Segment& s = cable.segments[1];
  double lightest = infinity;
  for (const Link& end : cable.links) {
    if (end.body >= 0 && at(world.bodies, end.body).node) {
      lightest = std::min(lightest, at(world.bodies, end.body).mass);
    }
  }
  return std::max(4.0 * s.tension / (s.length * lightest), 0.0);
}

}  // namespace

double wave_of(const World& world, const CableState& cable) {
  if (!locates_events(world.configuration)) return 0.0;
  const double wave = fastest_on(world, cable), most = cable.piece ? in_steps_of_pieces : in_steps;
  return wave * world.step_length * world.step_length > most ? wave : 0.0;
}

bool is_lost(const World& world, double wave) {
  const double least = shortest_followed * world.step_length;
  return wave * least * least > in_intervals;
}

double interval_for(const World& world, double wave) {
  return std::max(std::sqrt(in_intervals / wave), shortest_followed * world.step_length);
}

bool follows(const World& world, double wave, double length) {
  return wave * length * length <= at_most || length <= shortest_followed * world.step_length;
}

}  // namespace pinchlab
