// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/population_scenes.h"

#include <fmt/format.h>
#include <gsl/gsl_rng.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "base/at.h"
#include "demos/scenes/shape_scenes.h"
#include "sim/compound.h"
#include "sim/make_world.h"
#include "sim/nodes.h"
#include "sim/outline.h"
#include "sim/scene_error.h"
#include "sim/tangent.h"

namespace pinchlab::experiments {

namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) { gsl_rng_set(rng_.get(), static_cast<unsigned long>(seed)); }
  double uniform(double low, double high) {
    return low + (high - low) * gsl_rng_uniform(rng_.get());
  }
  double decades(double low, double high) { return std::pow(10.0, uniform(low, high)); }
  int below(int n) {
    return static_cast<int>(gsl_rng_uniform_int(rng_.get(), static_cast<unsigned long>(n)));
  }
  bool one_in(int n) { return below(n) == 0; }

 private:
  std::unique_ptr<gsl_rng, decltype(&gsl_rng_free)> rng_{gsl_rng_alloc(gsl_rng_mt19937),
                                                         &gsl_rng_free};
};

/// What all surfaces of a scene have in common.
struct Surfaces {
  bool slip, bounce;
  double contact_friction;

  explicit Surfaces(Random& random)
      : slip(random.one_in(2)),
        bounce(random.one_in(2)),
        contact_friction(random.one_in(2) ? 0.5 : 0.0) {}

  void finish(Random& random, Body& body) const {
    const double mu = random.one_in(4) ? 0.0 : random.uniform(0.02, 1.0);
    body.cable_friction = slip ? mu : infinity;
    body.contact_friction = contact_friction;
    constexpr double restitutions[] = {0.0, 0.5, 1.0};
    body.restitution = bounce ? restitutions[random.below(3)] : 0.0;
  }
};

/// A weight on a cable's end, or the end held by the world.
Attachment make_end(Random& random, const Surfaces& surfaces, Scene& scene, const Vec2& place) {
  if (random.one_in(3)) return {-1, place};
  Body weight;
  weight.name = fmt::format("weight {}", scene.bodies.size());
  weight.radius = 0.1;
  weight.mass = random.decades(-0.5, 1.0);
  weight.position = place;
  surfaces.finish(random, weight);
  scene.bodies.push_back(weight);
  return {static_cast<int>(scene.bodies.size()) - 1, Vec2::Zero()};
}

void add_cable(Random& random, const Surfaces& surfaces, int pulleys, Scene& scene) {
  Cable cable;
  cable.name = fmt::format("cable {}", scene.cables.size());
  cable.half_width = random.one_in(2) ? 0.03 : random.uniform(0.015, 0.045);
  cable.slack = random.one_in(2) ? 0.0 : random.uniform(0.0, 0.4);
  cable.closed = random.one_in(5);
  const int first = random.below(cable.closed ? pulleys - 1 : pulleys);
  const int last = cable.closed ? first + 1 : first + random.below(pulleys - first);
  for (int p = first; p <= last; ++p) cable.wraps.push_back({p, -1, 0});
  if (!cable.closed) {
    const double low = -2.2 - 0.5 * static_cast<double>(scene.cables.size());
    const Body left = at(scene.bodies, first);
    const Body right = at(scene.bodies, last);
    cable.start = make_end(random, surfaces, scene,
                           {left.position.x() - left.radius - random.uniform(0.0, 0.3), low});
    cable.end = make_end(random, surfaces, scene,
                         {right.position.x() + right.radius + random.uniform(0.0, 0.3), low});
  }
  scene.cables.push_back(cable);
}

Scene draw_scene(Random& random) {
  Scene scene;
  const Surfaces surfaces(random);
  const int pulleys = 2 + random.below(4), discs = 1 + random.below(6);
  const bool axles = random.one_in(2), drag = random.one_in(4), drive = random.one_in(4);
  for (int i = 0; i < pulleys; ++i) {
    Body pulley;
    pulley.name = fmt::format("pulley {}", i);
    pulley.kind = axles ? BodyKind::fixed_axle : BodyKind::fixed;
    pulley.radius = random.uniform(0.2, 0.45);
    pulley.mass = random.decades(-1.0, 1.0);
    pulley.position = {1.45 * i, random.uniform(-0.4, 0.4)};
    surfaces.finish(random, pulley);
    scene.bodies.push_back(pulley);
  }
  if (drive && axles) scene.bodies[0].driven_angular_velocity = random.uniform(-8.0, 8.0);
  const int cables = 1 + random.below(4);
  for (int c = 0; c < cables; ++c) add_cable(random, surfaces, pulleys, scene);
  for (int i = 0; i < discs; ++i) {
    Body disc;
    disc.name = fmt::format("disc {}", i);
    disc.radius = random.uniform(0.08, 0.4);
    disc.mass = random.decades(-2.0, 2.0);
    disc.position = {random.uniform(-0.6, 1.45 * (pulleys - 1) + 0.6), 1.4 + 0.9 * i};
    disc.velocity = {random.uniform(-2.0, 2.0), random.uniform(-3.0, 1.0)};
    disc.angular_velocity = random.one_in(2) ? 0.0 : random.uniform(-10.0, 10.0);
    if (drag) disc.linear_drag = random.uniform(0.0, 1.0);
    surfaces.finish(random, disc);
    scene.bodies.push_back(disc);
  }
  scene.walls.push_back({Vec2(-20.0, -5.0), Vec2(30.0, -5.0), 0.5, 0.0});
  return scene;
}

/// Three to six corners near a circle, about their centre of mass; a third of them rounded.
void make_polygon(Random& random, double radius, BodyProperties& body) {
  const int count = 3 + random.below(4);
  const double first = random.uniform(0.0, 2.0 * std::numbers::pi);
  std::vector<Vec2> corners;
  for (int k = 0; k < count; ++k) {
    const double angle = first + 2.0 * std::numbers::pi * (k + random.uniform(-0.3, 0.3)) / count;
    corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  const double rounding = random.one_in(3) ? random.uniform(0.01, 0.05) : 0.0;
  const Vec2 centre = plate_of(corners, rounding).centre;
  for (Vec2& corner : corners) corner -= centre;
  pinchlab::make_polygon(body, corners, rounding);
}

/// A box, polygon or disc that lies flat on the line y = 0, at that x (m).
Body lying_flat(Random& random, const Surfaces& surfaces, int number, double x) {
  Body body;
  body.name = fmt::format("thrown {}", number);
  body.radius = random.uniform(0.1, 0.25);
  body.mass = random.decades(-0.5, 0.5);
  double height = body.radius;
  if (const int kind = random.below(4); kind > 0) {
    const double a = body.radius, b = a * random.uniform(0.3, 1.0);
    if (kind == 1) {
      make_polygon(random, a, body);
    } else {
      pinchlab::make_polygon(body, build::box_corners(2.0 * a, 2.0 * b), 0.0);
    }
    const auto side = index(random.below(static_cast<int>(body.corners.size())));
    const Vec2& from = body.corners[side];
    const Vec2 way = body.corners[(side + 1) % body.corners.size()] - from;
    body.angle = -std::atan2(way.y(), way.x());
    height = cross(from, way) / way.norm() + body.corner_radius;
  }
  body.position = {x, height};
  surfaces.finish(random, body);
  return body;
}

/// Two to four discs and boxes about their common centre of mass.
std::vector<Shape> draw_shapes(Random& random, double size) {
  std::vector<Shape> shapes;
  const int count = 2 + random.below(3);
  for (int k = 0; k < count; ++k) {
    Shape shape;
    shape.place = {size * random.uniform(-1.0, 1.0), size * random.uniform(-1.0, 1.0)};
    shape.angle = random.uniform(0.0, std::numbers::pi);
    if (random.one_in(2)) {
      shape.properties.radius = size * random.uniform(0.3, 0.6);
    } else {
      const double a = 0.5 * size * random.uniform(0.4, 1.2);
      const double b = 0.5 * size * random.uniform(0.4, 1.2);
      pinchlab::make_polygon(shape.properties, build::box_corners(2.0 * a, 2.0 * b), 0.0);
    }
    shapes.push_back(shape);
  }
  const Vec2 centre = plate_of(shapes).centre;
  for (Shape& shape : shapes) shape.place -= centre;
  return shapes;
}

/// Two or three discs and polygons, with axles or fixed.
void add_pulleys(Random& random, const Surfaces& surfaces, int count, ShapelyScene& drawn) {
  for (int i = 0; i < count; ++i) {
    Body pulley;
    pulley.name = fmt::format("pulley {}", i);
    pulley.kind = random.one_in(2) ? BodyKind::fixed_axle : BodyKind::fixed;
    pulley.radius = random.uniform(0.25, 0.45);
    pulley.mass = random.decades(-0.5, 0.5);
    pulley.position = {1.5 * i, random.uniform(-0.2, 0.2)};
    const bool polygon = random.one_in(2);
    if (polygon) make_polygon(random, pulley.radius, pulley);
    surfaces.finish(random, pulley);
    drawn.has.polygons = drawn.has.polygons || polygon;
    drawn.scene.bodies.push_back(pulley);
  }
}

void add_falling(Random& random, const Surfaces& surfaces, int number, double width,
                 ShapelyScene& drawn) {
  Scene& scene = drawn.scene;
  Body falling;
  falling.name = fmt::format("falling {}", number);
  falling.radius = random.uniform(0.15, 0.35);
  falling.mass = random.decades(-1.0, 1.0);
  falling.position = {random.uniform(-0.3, width + 0.3), 1.5 + 1.1 * number};
  falling.velocity = {random.uniform(-1.0, 1.0), random.uniform(-2.0, 1.0)};
  falling.angular_velocity = random.uniform(-5.0, 5.0);
  surfaces.finish(random, falling);
  const int shape = random.below(3);
  if (shape == 1) {
    make_polygon(random, falling.radius, falling);
    drawn.has.polygons = true;
  }
  scene.bodies.push_back(falling);
  if (shape != 2) return;
  const std::size_t first = scene.bodies.size();
  add_shapes(scene, static_cast<int>(first) - 1, draw_shapes(random, 0.7 * falling.radius));
  for (std::size_t b = first; b < scene.bodies.size(); ++b) {
    scene.bodies[b].cable_friction = falling.cable_friction;
    scene.bodies[b].contact_friction = falling.contact_friction;
    scene.bodies[b].restitution = falling.restitution;
  }
  drawn.has.compounds = true;
}

ShapelyScene draw_shapely(Random& random, bool hangs) {
  ShapelyScene drawn;
  Scene& scene = drawn.scene;
  const Surfaces surfaces(random);
  const int pulleys = 2 + random.below(2);
  const double width = 1.5 * (pulleys - 1);
  drawn.has.ropes = random.one_in(3) || hangs;
  drawn.has.chains = random.one_in(2);
  add_pulleys(random, surfaces, pulleys, drawn);
  Cable cable;
  cable.name = "over";
  cable.half_width = random.uniform(0.01, 0.04);
  for (int p = 0; p < pulleys; ++p) cable.wraps.push_back({p, -1, 0});
  cable.start = {-1, {-1.0, -1.5}};
  cable.end = {-1, {width + 1.0, -1.5}};
  if (drawn.has.ropes) {
    cable.mass_per_metre = random.decades(-1.0, 0.5);
    Body weight;
    weight.name = "weight";
    weight.radius = 0.1;
    weight.mass = random.decades(0.7, 1.3);
    weight.position = {width + 0.45, -1.0};
    surfaces.finish(random, weight);
    weight.cable_friction = infinity;
    cable.end = {pulleys, Vec2::Zero()};
    scene.bodies.push_back(weight);
  } else {
    cable.slack = random.one_in(2) ? 0.0 : random.uniform(0.0, 0.4);
  }
  scene.cables.push_back(cable);
  const int count = 1 + random.below(4);
  for (int i = 0; i < count; ++i) add_falling(random, surfaces, i, width, drawn);
  scene.walls.push_back({Vec2(-20.0, -2.5), Vec2(30.0, -2.5), 0.5, 0.0});
  drawn.bodies = scene.bodies.size();
  if (drawn.has.chains) {
    Cable chain;
    chain.name = "below";
    chain.half_width = random.uniform(0.004, 0.01);
    chain.start = {-1, {-0.8, -1.2}};
    chain.end = {-1, {width + 0.8, random.uniform(-1.4, -1.0)}};
    chain.slack = random.uniform(0.05, 0.5);
    chain.mass_per_metre = random.decades(-1.0, 0.5);
    chain.nodes = 7 + random.below(24);
    scene.cables.push_back(chain);
  }
  if (hangs) {
    scene.cables[0].nodes = 5 + random.below(30);
    scene.cables[0].slack = random.one_in(3) ? 0.0 : random.uniform(0.02, 0.4);
  }
  spread_nodes(scene);
  return drawn;
}

constexpr std::uint64_t tries = 1000;  // a draw whose cables do not fit is drawn again

/// The first scene that `draw` draws for the seed and that can be made.
auto first_that_fits(std::uint64_t seed, auto draw, auto scene_of) {
  for (std::uint64_t k = 0; k < tries; ++k) {
    Random random(seed * tries + k + 1);
    try {
      auto drawn = draw(random);
      scene_of(drawn).name = fmt::format("population-{}", seed);
      make_world(scene_of(drawn), Method::pinch);
      return drawn;
    } catch (const SceneError&) {
      continue;
    }
  }
  throw std::runtime_error(fmt::format("no scene for seed {}", seed));
}

}  // namespace

Scene dropped_discs(std::uint64_t seed) {
  return first_that_fits(seed, draw_scene, [](Scene& scene) -> Scene& { return scene; });
}

Scene thrown_off_a_table(std::uint64_t seed) {
  Random random(seed);
  const Surfaces surfaces(random);
  constexpr double long_half = 1.0, high_half = 0.1;  // m, of the table
  Scene scene;
  scene.name = fmt::format("table-{}", seed);
  const int table = random.below(3);
  const double friction = surfaces.contact_friction;
  const double floor = table == 2 ? -2.0 * high_half : -1.0;
  scene.walls.push_back({Vec2(-9.0, floor), Vec2(9.0, floor), friction, 0.0});
  if (table == 0) {
    scene.walls.push_back({Vec2(-2.0 * long_half, 0.0), Vec2(0.0, 0.0), friction, 0.0});
  } else {
    Body block;
    block.name = "table";
    block.kind = table == 1 ? BodyKind::fixed : BodyKind::free;
    block.mass = 4.0;
    block.position = {-long_half, -high_half};
    pinchlab::make_polygon(block, build::box_corners(2.0 * long_half, 2.0 * high_half), 0.0);
    block.contact_friction = friction;
    scene.bodies.push_back(block);
  }
  const int count = 1 + random.below(3);
  for (int i = 0; i < count; ++i) {
    scene.bodies.push_back(lying_flat(random, surfaces, i, -0.3 - 0.6 * i));
    scene.bodies.back().velocity = {random.uniform(0.5, 3.0), 0.0};
  }
  return scene;
}

ShapelyScene dropped_shapes(std::uint64_t seed) {
  return first_that_fits(
      seed, [](Random& random) { return draw_shapely(random, false); },
      [](ShapelyScene& s) -> Scene& { return s.scene; });
}

ShapelyScene stretched_shapes(std::uint64_t seed) {
  constexpr std::uint64_t apart = 1000000;  // from the numbers that the scene itself is drawn with
  ShapelyScene drawn = dropped_shapes(seed);
  drawn.scene.cables[0].axial_stiffness = Random(seed + apart).decades(3.0, 5.0);  // N
  return drawn;
}

ShapelyScene shapes_on_hanging_rope(std::uint64_t seed) {
  constexpr double tolerance = 2e-3;  // m
  ShapelyScene drawn = first_that_fits(
      seed, [](Random& random) { return draw_shapely(random, true); },
      [](ShapelyScene& s) -> Scene& { return s.scene; });
  if (seed % 2 == 0) drawn.scene.cables[0].node_tolerance = tolerance;
  return drawn;
}

}  // namespace pinchlab::experiments
