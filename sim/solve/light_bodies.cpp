// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/light_bodies.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/mass.h"
#include "sim/cable/strung.h"
#include "sim/cable/waves.h"
#include "sim/compound.h"
#include "sim/parts.h"
#include "sim/solve/forces.h"
#include "sim/solve/part_system.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// Below this part of a body's mass a span's share is not worth adding up: twenty spans of one body
/// would have to pull on it for a body to be too light by what is left out.
constexpr double negligible = 0.05;

bool is_node(const World& world, const Link& link) {
  return link.body >= 0 && at(world.bodies, link.body).node;
}

int number_of(const CableState& cable, const Link& link) {
  return static_cast<int>(&link - cable.links.data());
}

/// kg; of a node what of its cable moves with it too, as its mobility has it.
double mass_of(const BodyProperties& body, const Mobility& mobility) {
  return body.node ? 1.0 / mobility.xx : body.mass;
}

Eigen::Matrix3d matrix_of(const Mobility& m) {
  return Eigen::Matrix3d{{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.angular}};
}

/// For (x, y, angle), on what the body can do (kg, kg m, kg m^2).
Eigen::Matrix3d masses_of(const BodyProperties& body, const Mobility& mobility) {
  if (mobility.xz != 0.0 || mobility.yz != 0.0) return inverse_for(body, matrix_of(mobility));
  const double mass = can_move(body) ? mass_of(body, mobility) : 0.0;
  const double inertia = mobility.angular > 0.0 ? 1.0 / mobility.angular : 0.0;
  return Eigen::Vector3d(mass, mass, inertia).asDiagonal();
}

/// Whether the segment counts for the body at its end `link`, where h^2 T is `pull` (kg m); `other`
/// is its other end, or null: as if that stood.
bool note_end(const World& world, const Parts& parts, const Segment& segment, const Link& link,
              const Link* other, double pull, PartSystem& system) {
  const int body = link.body >= 0 ? mover_of(world, link.body) : -1;
  if (body < 0 || !can_move(at(world.bodies, body))) return false;
  const double twice = 2.0 * pull;  // m times the span's share
  if (!(twice > negligible * at(world.bodies, body).mass * segment.length)) return false;
  const double mass = twice / segment.length;
  std::vector<SpanMass>& masses = system.span_masses;
  if (masses.empty()) masses.resize(system.mobility.size());
  SpanMass& span = at(masses, at(parts.local, body));
  const Vec2 n = left(segment.direction);
  const Eigen::Matrix2d across = mass * n * n.transpose();
  span.mass += across;
  if (!other || other->body < 0) return true;
  const Vec2 velocity = velocity_of(world, *other);
  span.momentum_x += velocity.x() * across;
  span.momentum_y += velocity.y() * across;
  return true;
}

/// Gives the body along unit vector v what the spans do there for a mass, where that is more than
/// its own, m = 1 / (v.W v) by its mobility W; with it the free velocity. Added mass a makes of W
/// and of velocity V, by a force a (u - v.V) along v,
///     W' = W - (W v)(W v)^T a / (1 + a / m),   V' = V + W' a (u - v.V) v.
/// The line's speed u is the mean of its other ends' along v, each weighted by what its span does
/// there: nearly parallel spans would else ask for any speed across v that fits their small angle.
void steady(const SpanMass& span, const Vec2& v, Eigen::Matrix3d& mobility,
            Eigen::Vector3d& velocity) {
  const double mass = v.dot(span.mass * v);
  const Eigen::Vector3d along(v.x(), v.y(), 0.0), moves = mobility * along;
  const double yielding = along.dot(moves);  // 1/kg
  if (mass * yielding <= 1.0) return;
  const double x = v.dot(span.momentum_x * v), y = v.dot(span.momentum_y * v);
  const double line = (x * v.x() + y * v.y()) / mass;
  const double taken = (1.0 - 1.0 / (mass * yielding)) / yielding;  // kg: a / (1 + a / m)
  velocity += taken * (line - along.dot(velocity)) * moves;
  mobility -= taken * moves * moves.transpose();
}

void steady(const BodyProperties& body, SpanMass& span, Mobility& mobility,
            Eigen::Vector3d& velocity) {
  if (span.mass.trace() * std::max(mobility.xx, mobility.yy) <= 1.0) return;
  span.steadied = true;
  span.own = mobility;
  span.velocity = velocity;
  Eigen::Matrix3d m = matrix_of(mobility);
  if (body.kind == BodyKind::rail) {
    steady(span, body.rail_axis.normalized(), m, velocity);
  } else {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> principal;
    principal.computeDirect(span.mass);
    for (int i = 0; i < 2; ++i) steady(span, principal.eigenvectors().col(i), m, velocity);
  }
  mobility = {m(0, 0), m(0, 1), m(1, 1), m(2, 2), m(0, 2), m(1, 2)};
}

void steady_all(const World& world, std::span<const int> bodies, PartSystem& system) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    steady(at(world.bodies, bodies[i]), system.span_masses[i], system.mobility[i],
           system.free_velocity[i]);
    system.mobility_changed = system.mobility_changed || system.span_masses[i].steadied;
  }
}

/// Mobilities as they are without spans.
void restore(const World& world, std::span<const int> bodies, double kick, PartSystem& system) {
  const bool are_new = !system.carried.empty();  // where cables have mass, with each kick
  for (std::size_t i = 0; i < bodies.size() && !system.span_masses.empty(); ++i) {
    SpanMass& span = system.span_masses[i];
    if (span.steadied && !are_new) {
      system.mobility[i] = mobility_of(at(world.bodies, bodies[i]), kick);
      system.mobility_changed = true;
    }
    span = {};
  }
}

}  // namespace

bool steady_light_bodies(const World& world, const Parts& parts, const Part& part, double kick,
                         PartSystem& system) {
  const std::span<const int> bodies = bodies_of(parts, part);
  restore(world, bodies, kick, system);
  if (!part.can_move || kick == 0.0) return false;
  const double least = negligible * part.lightest / (2.0 * kick * kick);
  const bool follows = locates_events(world.configuration);
  bool any = false;
  for (const int c : cables_of(parts, part)) {
    const CableState& cable = at(world.cables, c);
    // What one of a hinge's bars would let swing, the other holds.
    if (cable.joint == Joint::pin) continue;
    for (std::size_t s = first_segment(cable); s < cable.segments.size(); ++s) {
      const Segment& segment = cable.segments[s];
      if (!(segment.tension > least * segment.length)) continue;
      if (segment.length <= 2.0 * cable.half_width) continue;
      const Link& head = cable.links[s];
      const Link& tail = at(cable.links, previous_link(cable, static_cast<int>(s)));
      const double wave = cable.nodes > 0 ? 0.0 : wave_of(world, cable);  // each node has its own
      const bool lost = is_lost(world, wave);
      const auto note = [&](const Link& end, const Link& other) {
        const bool strung = is_strung(cable, end);
        if (strung && !is_lost(world, wave_at_node(world, cable, number_of(cable, end)))) return;
        const bool followed = follows && !strung && is_node(world, end);
        if (followed && !lost) return;
        const double pull = kick * kick * segment.tension;
        any =
            note_end(world, parts, segment, end, followed ? nullptr : &other, pull, system) || any;
      };
      note(head, tail);
      note(tail, head);
    }
  }
  if (any) steady_all(world, bodies, system);
  return any;
}

void steady_for_repair(const World& world, const Parts& parts, const Part& part,
                       std::span<const double> impulses, PartSystem& system) {
  release_light_bodies(system);
  bool any = false;
  for (std::size_t r = 0; r < system.rows.size(); ++r) {
    const Row& row = system.rows[r];
    if (row.kind != RowKind::segment || !(impulses[r] > 0.0)) continue;
    const CableState& cable = at(world.cables, row.index);
    const Segment& segment = at(cable.segments, row.item);
    if (segment.length <= 2.0 * cable.half_width) continue;
    for (const int link : {previous_link(cable, row.item), row.item}) {
      const Link& end = at(cable.links, link);
      any = note_end(world, parts, segment, end, nullptr, impulses[r], system) || any;
    }
  }
  if (any) steady_all(world, bodies_of(parts, part), system);
}

bool gains_by_steadying(const World& world, const Parts& parts, const Part& part,
                        const PartSystem& s) {
  double gain = 0.0, energy = 0.0;  // J, twice
  const auto add = [&](const Eigen::Matrix3d& mass, const Eigen::Vector3d& before,
                       const Eigen::Vector3d& v) {
    energy += before.dot(mass * before);
    gain += (v - before).dot(mass * (v + before));
  };
  const std::span<const int> bodies = bodies_of(parts, part);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Mobility own = s.mobility[i];
    Eigen::Vector3d before = s.free_velocity[i];
    if (i < s.span_masses.size() && s.span_masses[i].steadied) {
      own = s.span_masses[i].own;
      const bool turns_alone = own.xz == 0.0 && own.yz == 0.0;  // as its motor has it by now
      if (turns_alone) own.angular = s.mobility[i].angular;
      before = s.span_masses[i].velocity;
    }
    add(masses_of(at(world.bodies, bodies[i]), own), before, s.velocity[i]);
  }
  for (const SleevePlace& one : s.sleeves) {
    const Eigen::Matrix3d mobility = matrix_of(at(s.mobility, one.place));
    add(inverse_for_sleeve(world, one.sleeve, mobility), at(s.free_velocity, one.place),
        at(s.velocity, one.place));
  }
  for (const Row& row : s.rows) {
    if (row.impulse == 0.0) continue;
    if (row.compliance > 0.0) return false;  // it may give back what it stores
    gain += 2.0 * row.impulse * row.curved;
  }
  constexpr double rounding = 1e-9;  // far below any gain that shows
  return gain > rounding * energy;
}

void release_light_bodies(PartSystem& system) {
  for (std::size_t i = 0; i < system.span_masses.size(); ++i) {
    SpanMass& span = system.span_masses[i];
    if (span.steadied) {
      system.mobility[i] = span.own;
      system.free_velocity[i] = span.velocity;
      system.mobility_changed = true;
    }
    span = {};
  }
}

}  // namespace pinchlab
