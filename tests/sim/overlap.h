// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// By how much bodies and walls overlap, from their places alone: nothing here knows of contacts.

#include <algorithm>
#include <array>
#include <vector>

#include "sim/compound.h"
#include "sim/outline.h"
#include "sim/workspace.h"
#include "tests/sim/random.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {

/// The corners of what is round by `radius`: a polygon's, a disc's centre, or a wall's two ends.
struct Hull {
  std::vector<Vec2> corners;  // m, counter-clockwise
  double radius = 0.0;        // m
};

inline Hull hull_of(const World& world, std::size_t b) {
  const BodyProperties& body = world.bodies[b];
  if (!is_polygon(body)) return {{world.position[b]}, body.radius};
  Hull hull{{}, body.corner_radius};
  const double c = std::cos(world.angle[b]), s = std::sin(world.angle[b]);
  for (const Vec2& p : body.corners) {
    hull.corners.emplace_back(world.position[b].x() + c * p.x() - s * p.y(),
                              world.position[b].y() + s * p.x() + c * p.y());
  }
  return hull;
}

/// How far b is beyond a along `way` (m); below 0: not at all.
inline double beyond(const Hull& a, const Hull& b, const Vec2& way) {
  double furthest = -infinity, nearest = infinity;
  for (const Vec2& p : a.corners) furthest = std::max(furthest, way.dot(p));
  for (const Vec2& p : b.corners) nearest = std::min(nearest, way.dot(p));
  return nearest - furthest;
}

/// How far b is beyond the sides of a, along the side's way out that parts them most (m).
inline double beyond_sides(const Hull& a, const Hull& b) {
  double most = -infinity;
  for (std::size_t i = 0; a.corners.size() > 1 && i < a.corners.size(); ++i) {
    const Vec2 side = a.corners[(i + 1) % a.corners.size()] - a.corners[i];
    most = std::max(most, beyond(a, b, Vec2(side.y(), -side.x()).normalized()));
  }
  return most;
}

/// By how much the two overlap (m; below 0: they do not), by the theorem of separating axes: across
/// sides, and where one is round from corner to corner.
inline double overlap_of(const Hull& a, const Hull& b) {
  double apart = std::max(beyond_sides(a, b), beyond_sides(b, a));
  if (a.radius + b.radius > 0.0) {
    for (const Vec2& p : a.corners) {
      for (const Vec2& q : b.corners) apart = std::max(apart, beyond(a, b, (q - p).normalized()));
    }
  }
  return a.radius + b.radius - apart;
}

/// Whether nothing keeps the two from overlapping.
inline bool may_overlap(const Scene& scene, const World& world, std::size_t a, std::size_t b) {
  const int i = static_cast<int>(a), j = static_cast<int>(b);
  const bool apart = std::binary_search(scene.apart.begin(), scene.apart.end(), std::array{i, j});
  const bool stand = is_static(world.bodies[a]) && is_static(world.bodies[b]);
  return apart || stand || mover_of(world, i) == mover_of(world, j);
}

/// The most by which a body overlaps another, or a wall (m).
inline double largest_overlap(const Scene& scene, const World& world) {
  std::vector<Hull> hulls;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) hulls.push_back(hull_of(world, b));
  double most = -infinity;
  for (std::size_t a = 0; a < hulls.size(); ++a) {
    if (!world.bodies[a].outlined) continue;
    for (std::size_t b = a + 1; b < hulls.size(); ++b) {
      if (!world.bodies[b].outlined || may_overlap(scene, world, a, b)) continue;
      most = std::max(most, overlap_of(hulls[a], hulls[b]));
    }
    if (is_static(world.bodies[a])) continue;
    for (const Wall& wall : scene.walls) {
      most = std::max(most, overlap_of(hulls[a], {{wall.a, wall.b}, 0.0}));
    }
  }
  return most;
}

/// What a run has come to.
struct Overlaps {
  double largest = -infinity;          // m
  double gained = 0.0, at_play = 0.0;  // J
  World end;
};

inline Overlaps run_overlaps(const Scene& scene, double seconds) {
  Overlaps run;
  World world = make_world(scene, measured());
  Workspace work;
  double start = 0.0;
  for (int i = 0; i < seconds * 60 * scene.steps_per_frame; ++i) {
    EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    if (!world.failure.empty()) break;
    run.largest = std::max(run.largest, largest_overlap(scene, world));
    if (i == 0) start = world.diagnostics.energy;
    run.gained = std::max(run.gained, world.diagnostics.energy - start);
    run.at_play = std::max(run.at_play, start - world.diagnostics.energy);
  }
  run.end = world;
  return run;
}

/// Of 3 to 6 corners on a circle, in no regular places; their plate's centre is moved to the
/// origin.
inline void make_random_polygon(Random& random, double radius, bool sharp, Body& b) {
  const int corners = 3 + random.below(4);
  std::vector<Vec2> points;
  const double first = random.uniform(0.0, 6.0);
  for (int k = 0; k < corners; ++k) {
    const double angle = first + 2.0 * 3.14159265358979 * (k + random.uniform(-0.3, 0.3)) / corners;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  const double rounding = sharp || random.below(2) == 0 ? 0.0 : random.uniform(0.01, 0.05);
  const Vec2 centre = plate_of(points, rounding).centre;
  for (Vec2& point : points) point -= centre;
  make_polygon(b, std::move(points), rounding);
}

}  // namespace pinchlab::testing
