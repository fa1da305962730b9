// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/population_scenes.h"

#include <fmt/format.h>
#include <gsl/gsl_rng.h>

#include <cmath>
#include <memory>
#include <stdexcept>

#include "sim/make_world.h"
#include "sim/scene_error.h"

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
    const Body left = scene.bodies[static_cast<std::size_t>(first)];
    const Body right = scene.bodies[static_cast<std::size_t>(last)];
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

}  // namespace

Scene dropped_discs(std::uint64_t seed) {
  constexpr std::uint64_t tries = 1000;  // a draw whose cables do not fit is drawn again
  for (std::uint64_t k = 0; k < tries; ++k) {
    Random random(seed * tries + k + 1);
    Scene scene = draw_scene(random);
    scene.name = fmt::format("population-{}", seed);
    try {
      make_world(scene, Method::pinch);
    } catch (const SceneError&) {
      continue;
    }
    return scene;
  }
  throw std::runtime_error(fmt::format("no scene for seed {}", seed));
}

}  // namespace pinchlab::experiments
