// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/stability/watch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/cable/cable.h"
#include "sim/step.h"
#include "sim/tangent.h"

namespace pinchlab::experiments::stability {

namespace {

double gap(const Scene& scene, const World& world, std::size_t a, std::size_t b) {
  return (world.position[b] - world.position[a]).norm() - scene.bodies[a].radius -
         scene.bodies[b].radius;
}

/// Whether cable lies on link i in the direction of unit vector u from its body's centre.
bool covers(const CableState& cable, std::size_t i, const Vec2& u) {
  constexpr double turn = 2.0 * std::numbers::pi;
  constexpr double touch = 1e-6;  // rad: wraps may meet exactly where a body presses
  const Link& link = cable.links[i];
  const Vec2 along = link.orientation * Vec2(-u.y(), u.x());
  double arc = link.orientation * (heading(along) - cable.segments[i].alpha);
  arc -= turn * std::floor(arc / turn);
  return arc <= link.wrap + touch || arc >= turn - touch;
}

/// Overlap (m) with what is wrapped on the body of link i.
double wrap_overlap(const Scene& scene, const World& world, const CableState& cable,
                    std::size_t i) {
  const Link& link = cable.links[i];
  if (link.orientation == 0 || link.pinch_middle) return 0.0;
  const double width = 2.0 * cable.half_width;
  const std::size_t a = index(link.body);
  double deepest = 0.0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (b == a) continue;
    const double depth = width - gap(scene, world, a, b);
    if (depth <= deepest) continue;
    if (covers(cable, i, (world.position[b] - world.position[a]).normalized())) deepest = depth;
  }
  return deepest;
}

/// Overlap (m) with segment i: of the bodies that pinch it, or of others with the free span.
double span_overlap(const Scene& scene, const World& world, const CableState& cable,
                    std::size_t i) {
  const Link& to = cable.links[i];
  const Link& from = cable.links[index(previous_link(cable, static_cast<int>(i)))];
  const double width = 2.0 * cable.half_width;
  double deepest = 0.0;
  if (opposite(from, to)) {
    deepest = std::max(deepest, width - gap(scene, world, index(from.body), index(to.body)));
  }
  const Segment& segment = cable.segments[i];
  if (segment.pinched) return deepest;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (from.body == static_cast<int>(b) || to.body == static_cast<int>(b)) continue;
    const Vec2 x = world.position[b] - segment.tail;
    const double along = segment.direction.dot(x);
    if (along <= 0.0 || along >= segment.length) continue;
    const double side = std::abs(x.x() * segment.direction.y() - x.y() * segment.direction.x());
    deepest = std::max(deepest, scene.bodies[b].radius + cable.half_width - side);
  }
  return deepest;
}

/// Largest speed of a centre or a rim, m/s.
double fastest(const Scene& scene, const World& world) {
  double speed = 0.0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    speed = std::max({speed, world.velocity[b].norm(),
                      std::abs(world.angular_velocity[b]) * scene.bodies[b].radius});
  }
  return speed;
}

std::int64_t link_count(const World& world) {
  std::int64_t count = 0;
  for (const CableState& cable : world.cables) {
    count += static_cast<std::int64_t>(cable.links.size());
  }
  return count;
}

void note_energy(const Case& test, const World& world, double start, Measures& m) {
  if (test.energy == EnergyLaw::unchecked) return;
  const double gain = (world.diagnostics.energy - start) / test.energy_at_play_j;
  m.energy_gained = std::max(m.energy_gained, gain);
  if (test.energy == EnergyLaw::keeps) m.energy_lost = std::max(m.energy_lost, -gain);
}

void note_positions(const Scene& scene, const World& world, Measures& m) {
  m.strain = std::max(m.strain, strain(scene, world));
  m.squeeze = std::max(m.squeeze, squeeze(scene, world));
  for (const CableState& cable : world.cables) {
    m.length = std::max(m.length, world.diagnostics.cable_length_error / cable.length);
  }
}

}  // namespace

double squeeze(const Scene& scene, const World& world) {
  double worst = 0.0;
  for (const CableState& cable : world.cables) {
    if (is_passed(cable)) continue;
    double deepest = 0.0;
    for (std::size_t i = 0; i < cable.links.size(); ++i) {
      deepest = std::max(deepest, wrap_overlap(scene, world, cable, i));
      if (i < first_segment(cable)) continue;
      deepest = std::max(deepest, span_overlap(scene, world, cable, i));
    }
    worst = std::max(worst, deepest / (2.0 * cable.half_width));
  }
  return worst;
}

double strain(const Scene& scene, const World& world) {
  double worst = 0.0;
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    const CableState& cable = world.cables[c];
    double excess = 0.0;
    for (std::size_t i = first_segment(cable); i < cable.links.size(); ++i) {
      const Segment& segment = cable.segments[i];
      double stretch = segment.length - segment.rest_length;
      if (scene.cables[c].axial_stiffness < infinity) {
        stretch -= segment.tension * segment.rest_length / scene.cables[c].axial_stiffness;
      }
      excess += std::max(stretch, 0.0);
    }
    worst = std::max(worst, excess / cable.length);
  }
  return worst;
}

std::int64_t step_count(const Case& test) {
  return static_cast<std::int64_t>(std::llround(test.seconds / step_length(test.scene)));
}

Result watch(const Case& test, const std::string& method, const Configuration& configuration) {
  Result result;
  result.series = test.series;
  result.method = method;
  result.x = test.x;
  result.y = test.y;
  Measures& m = result.measures;
  Configuration measured = configuration;
  measured.diagnostics = true;
  World world = make_world(test.scene, measured);
  Workspace work;
  const std::int64_t steps = step_count(test), last_tenth = steps - steps / 10;
  double start_energy = 0.0;
  std::int64_t links = link_count(world);
  for (; result.steps < steps && m.finite; ++result.steps) {
    if (step(test.scene, world, work) != StepStatus::ok) {
      m.finite = false;
      break;
    }
    if (result.steps == 0) start_energy = world.diagnostics.energy;
    note_energy(test, world, start_energy, m);
    note_positions(test.scene, world, m);
    if (test.rests && result.steps >= last_tenth) {
      m.end_speed_m_s = std::max(m.end_speed_m_s, fastest(test.scene, world));
    }
    result.most_solves = std::max(result.most_solves, world.diagnostics.active_set_solves);
    result.link_changes += std::abs(link_count(world) - links);
    links = link_count(world);
  }
  if (m.finite && test.error) m.error = test.error(test.scene, world);
  if (m.finite && test.passed_through) m.passed_through = test.passed_through(test.scene, world);
  result.total_solves = world.diagnostics.total_solves;
  result.fallbacks = world.diagnostics.fallbacks;
  result.verdict = judge(m);
  return result;
}

}  // namespace pinchlab::experiments::stability
