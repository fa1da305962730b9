// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/light_bodies.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "sim/cable.h"
#include "sim/parts.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// Below this part of a body's mass a span's share is not worth adding up.
constexpr double negligible = 0.05;

/// Whether the segment counts for `body` at its one end; `other` is at its other end.
bool note_end(const Scene& scene, World& world, const Segment& segment, int body, int other) {
  if (body < 0) return false;
  const auto b = static_cast<std::size_t>(body);
  if (!can_move(scene.bodies[b])) return false;
  const double h = world.step_length;
  const double twice = 2.0 * h * h * segment.tension;  // m times the span's share
  if (!(twice > negligible * scene.bodies[b].mass * segment.length)) return false;
  const double mass = twice / segment.length;
  std::vector<SpanMass>& masses = world.scratch.span_masses;
  if (masses.empty()) masses.resize(scene.bodies.size());
  const Vec2 n = left(segment.direction);
  masses[b].mass += mass * n * n.transpose();
  if (other >= 0) {
    masses[b].momentum += mass * n * n.dot(world.velocity[static_cast<std::size_t>(other)]);
  }
  return true;
}

/// Mobilities as they are without spans.
void restore(const Scene& scene, std::span<const int> bodies, double kick, Scratch& scratch) {
  for (const int number : bodies) {
    const auto b = static_cast<std::size_t>(number);
    if (scratch.span_masses[b].steadied) scratch.mobility[b] = mobility_of(scene.bodies[b], kick);
    scratch.span_masses[b] = {};
  }
}

/// Along unit vector v: the share of the body's mass in max(m, h^2 k), and with it the free speed.
double steady(const Body& body, const SpanMass& span, const Vec2& v, Vec2& velocity) {
  const double mass = v.dot(span.mass * v);
  if (mass <= body.mass) return 1.0;
  const double share = body.mass / mass, line = v.dot(span.momentum) / mass;
  velocity += (1.0 - share) * (line - v.dot(velocity)) * v;
  return share;
}

void steady(const Body& body, SpanMass& span, Mobility& mobility, Vec2& velocity) {
  if (span.mass.trace() <= body.mass) return;
  span.steadied = true;
  if (body.kind == BodyKind::rail) {
    const double share = steady(body, span, body.rail_axis.normalized(), velocity);
    mobility.xx *= share;
    mobility.xy *= share;
    mobility.yy *= share;
    return;
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> principal;
  principal.computeDirect(span.mass);
  Eigen::Matrix2d inverse = Eigen::Matrix2d::Zero();
  for (int i = 0; i < 2; ++i) {
    const Vec2 v = principal.eigenvectors().col(i);
    inverse += mobility.xx * steady(body, span, v, velocity) * v * v.transpose();
  }
  mobility.xx = inverse(0, 0);
  mobility.xy = inverse(0, 1);
  mobility.yy = inverse(1, 1);
}

}  // namespace

void steady_light_bodies(const Scene& scene, World& world, const Part& part, double kick) {
  Scratch& scratch = world.scratch;
  const std::span<const int> bodies = bodies_of(scratch.parts, part);
  if (!scratch.span_masses.empty()) restore(scene, bodies, kick, scratch);
  if (!part.can_move) return;
  const double least = negligible * part.lightest / (2.0 * world.step_length * world.step_length);
  bool any = false;
  for (const int c : cables_of(scratch.parts, part)) {
    const CableState& cable = world.cables[static_cast<std::size_t>(c)];
    for (std::size_t s = first_segment(cable); s < cable.segments.size(); ++s) {
      const Segment& segment = cable.segments[s];
      if (!(segment.tension > least * segment.length)) continue;
      if (segment.length <= 2.0 * cable.half_width) continue;
      const int head = cable.links[s].body;
      const int from = previous_link(cable, static_cast<int>(s));
      const int tail = cable.links[static_cast<std::size_t>(from)].body;
      any = note_end(scene, world, segment, head, tail) || any;
      any = note_end(scene, world, segment, tail, head) || any;
    }
  }
  if (!any) return;
  for (const int number : bodies) {
    const auto b = static_cast<std::size_t>(number);
    steady(scene.bodies[b], scratch.span_masses[b], scratch.mobility[b], scratch.velocity_free[b]);
  }
}

}  // namespace pinchlab
