// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/counted_scenes.h"

#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>

#include "base/at.h"
#include "demos/scenes/build.h"
#include "demos/scenes/library.h"
#include "sim/nodes.h"
#include "sim/step.h"

namespace pinchlab::experiments {

namespace {

constexpr CountedScene counted[] = {
    {"weights over 81 light pulleys, where all moves", "pinch", 82, [] { return chain_scene(81); }},
    {"a weight that swings beside 81 pulleys", "pinch", 82, [] { return swinging_scene(81); }},
    {"81 segments over fixed pulleys, where nothing moves", "pinch", 81,
     [] { return stress_scene(20, free_spacing); }},
    {"stress scene with pinches, load 20", "pinch", 277,
     [] { return stress_scene(20, pinched_spacing); }},
    {"stress scene with pinches, load 20", "thesis", 277,
     [] { return stress_scene(20, pinched_spacing); }},
};

constexpr double disc_spacing = 4.0, disc_radius = 0.2;  // m

/// Discs in a row, each at a height (m) of its own above the line y = 0.
template <class Height>
Scene discs_in_a_row(const char* name, int count, Height height) {
  Scene scene = disconnected_scene(0, 0);
  scene.name = name;
  for (int i = 0; i < count; ++i) {
    Body disc;
    disc.name = "disc " + std::to_string(i);
    disc.radius = disc_radius;
    disc.position = {disc_spacing * i, disc_radius + height(i)};
    scene.bodies.push_back(disc);
  }
  return scene;
}

/// Discs that lie on slabs of their own.
Scene discs_on_walls(int count) {
  Scene scene = discs_in_a_row("discs-on-walls", count, [](int) { return 0.0; });
  constexpr double half_slab = 1.0;
  for (const Body& disc : scene.bodies) {
    Wall slab;
    slab.a = {disc.position.x() - half_slab, 0.0};
    slab.b = {disc.position.x() + half_slab, 0.0};
    scene.walls.push_back(slab);
  }
  return scene;
}

/// Balls that bounce for ever on one floor, from heights that are all different, so that of many
/// some land in every step.
Scene bouncing_balls(int count) {
  constexpr double golden = 0.6180339887498949;
  Scene scene = discs_in_a_row("bouncing-balls", count,
                               [](int i) { return 0.1 + std::fmod(golden * i, 1.0); });
  for (Body& ball : scene.bodies) ball.restitution = 1.0;
  Wall floor;
  floor.a = {-disc_spacing, 0.0};
  floor.b = {disc_spacing * count, 0.0};
  scene.walls.push_back(floor);
  return scene;
}

/// Discs that fall, each on a taut span of its own, from heights that are all different: for a
/// second some land in every step.
Scene discs_on_spans(int count) {
  constexpr double golden = 0.6180339887498949, half_span = 0.5, half_width = 0.02;  // m
  Scene scene = discs_in_a_row("discs-on-spans", count,
                               [](int i) { return 0.1 + 5.0 * std::fmod(golden * i, 1.0); });
  for (int i = 0; i < count; ++i) {
    const double x = disc_spacing * i;
    scene.cables.push_back(
        build::cable(build::at(x - half_span, 0.0), {}, build::at(x + half_span, 0.0), half_width));
    scene.cables.back().name = "span " + std::to_string(i);
  }
  return scene;
}

/// Cables that hang over slabs, of as many nodes as they need, a disc beside each.
Scene hanging_cables(int count) {
  constexpr double span = 1.0, half_width = 0.005;  // m
  Scene scene = discs_in_a_row("hanging-cables", count, [](int) { return span; });
  for (int i = 0; i < count; ++i) {
    const double x = disc_spacing * i;
    scene.bodies[index(i)].kind = BodyKind::fixed_axle;
    scene.cables.push_back(
        build::cable(build::at(x, 0.0), {}, build::at(x + span, 0.0), half_width));
    Cable& cable = scene.cables.back();
    cable.name = "cable " + std::to_string(i);
    cable.slack = 0.25;
    cable.mass_per_metre = 0.8;
    cable.nodes = 31;
    cable.node_tolerance = 2e-3;
    Wall slab;
    slab.a = {x, -3.0 * span};
    slab.b = {x + span, -3.0 * span};
    scene.walls.push_back(slab);
  }
  spread_nodes(scene);
  return scene;
}

Scene frictionless_chain(int pulleys) {
  Scene scene = chain_scene(pulleys);
  for (Body& body : scene.bodies) body.cable_friction = 0.0;
  return scene;
}

/// Under a rope with mass, which slips on each.
Scene heavy_chain(int pulleys) {
  Scene scene = chain_scene(pulleys);
  for (Body& body : scene.bodies) body.cable_friction = 1e-3;
  scene.cables[0].mass_per_metre = 0.1;
  return scene;
}

void step_on(const Scene& scene, const char* name, int steps) {
  Configuration configuration = *configuration_from_string(name);
  configuration.sleep = false;
  World world = make_world(scene, configuration);
  Workspace work;
  for (int i = 0; i < steps; ++i) {
    if (step(scene, world, work) != StepStatus::ok) throw std::runtime_error(world.failure);
  }
}

}  // namespace

std::span<const CountedScene> counted_scenes() {
  return counted;
}

const std::vector<GrowingScene>& growing_scenes() {
  static const std::vector<GrowingScene> scenes{
      {"swinging cables, a step",
       {100, 1000, 10000},
       [](int n) { return disconnected_scene(n, n); }},
      {"balls that bounce, each by itself, a step", {100, 1000, 10000}, bouncing_balls, 120},
      {"discs that land on spans of their own, a step", {100, 1000, 10000}, discs_on_spans, 120},
      {"discs on walls of their own, a step", {100, 1000, 10000}, discs_on_walls},
      {"pulleys without friction under one cable, a step",
       {11, 33, 101, 331, 1001},
       frictionless_chain},
      {"pulleys on which a heavy rope slips, a step", {11, 33, 101, 331, 1001}, heavy_chain},
      {"hanging cables whose nodes adapt, a step", {10, 100, 1000}, hanging_cables},
      {"swinging cables, `make_world`",
       {100, 1000, 10000},
       [](int n) { return disconnected_scene(n, n); },
       0},
      {"hanging cables whose nodes adapt, `make_world`", {10, 100, 1000}, hanging_cables, 0},
      {"pinched stress scene, `make_world`",
       {20, 200, 2000},
       [](int n) { return stress_scene(n, pinched_spacing); },
       0},
  };
  return scenes;
}

bool step_scene(int number, int steps) {
  if (number < 0 || index(number) >= std::size(counted) || steps < 0) return false;
  step_on(counted[number].scene(), counted[number].configuration, steps);
  return true;
}

bool step_growing_scene(int number, int size, int calls) {
  if (number < 0 || index(number) >= growing_scenes().size() || size < 1 || calls < 0) {
    return false;
  }
  const GrowingScene& growing = at(growing_scenes(), number);
  const Scene scene = growing.scene(size);
  if (growing.steps > 0) {
    step_on(scene, "pinch", calls);
    return true;
  }
  for (int i = 0; i < calls; ++i) make_world(scene, Method::pinch);
  return true;
}

}  // namespace pinchlab::experiments
