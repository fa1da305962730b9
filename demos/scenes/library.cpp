// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/library.h"

#include <fmt/format.h>

#include "demos/scenes/build.h"
#include "sim/make_world.h"

namespace pinchlab {

namespace {

using build::pulley_radius;
constexpr double half_width = build::cable_half_width;  // m

Scene named(const std::string& name) {
  Scene scene;
  scene.name = name;
  return scene;
}

/// Adds a body and returns its index. Its mass is 1 kg, as in the thesis' scenes.
int add_body(Scene& scene, const char* what, BodyKind kind, double x, double y, double radius) {
  const auto index = static_cast<int>(scene.bodies.size());
  scene.bodies.push_back(build::body(fmt::format("{} {}", what, index), kind, x, y, radius));
  return index;
}

/// Makes the scene's cable elastic and puts it under tension. What lies on pulleys is not stretched
/// (creep = false, as in the thesis): only free spans, as long as make_world lays them, pull.
void string_cable(Scene& scene) {
  double free_length = 0.0;  // m
  const World world = make_world(scene, Method::pinch);
  const CableState& cable = world.cables.front();
  for (std::size_t s = 1; s < cable.segments.size(); ++s) free_length += cable.segments[s].length;
  scene.cables.front().axial_stiffness = stress_stiffness;
  scene.cables.front().creep = false;
  scene.cables.front().slack = -stress_strain / (1.0 + stress_strain) * free_length;
}

}  // namespace

Scene slack_stress_scene(int load, double spacing) {
  Scene scene = named("stress");
  const double a = spacing;
  Cable cable = build::cable({-1, {0.0, 0.0}}, {}, {-1, {2.0 * a * load, 0.0}});
  constexpr int clockwise = -1, counter_clockwise = 1;
  for (int i = 0; i < load; ++i) {
    const double x1 = a * (2.0 * i + 0.5), x2 = a * (2.0 * i + 1.5);
    const double upper = -0.5 * a, lower = -1.5 * a;
    const auto pulley = [&](double x, double y) {
      return add_body(scene, "pulley", BodyKind::fixed_axle, x, y, pulley_radius);
    };
    cable.wraps.push_back({pulley(x1, upper), clockwise, 0});
    cable.wraps.push_back({pulley(x1, lower), counter_clockwise, 0});
    cable.wraps.push_back({pulley(x2, lower), counter_clockwise, 0});
    cable.wraps.push_back({pulley(x2, upper), clockwise, 0});
  }
  scene.cables.push_back(cable);
  return scene;
}

Scene stress_scene(int load, double spacing) {
  Scene scene = slack_stress_scene(load, spacing);
  string_cable(scene);
  return scene;
}

Scene pinch_detection_scene(int load, bool pinching, bool other) {
  Scene scene = named("pinch-detection");
  constexpr double a = 1.2, small_radius = 0.25;
  Cable cable = build::cable({-1, {0.0, 0.0}}, {}, {-1, {a * (2 * load + 1), 0.0}});
  for (int i = 0; i < 2 * load; ++i) {
    const bool over = i % 2 == 0;
    const double x = a * (i + 1);
    const int pulley = add_body(scene, "pulley", BodyKind::fixed_axle, x, 0.0, pulley_radius);
    cable.wraps.push_back({pulley, over ? -1 : 1, 0});
  }
  for (int i = 0; i < 2 * load; ++i) {
    const bool over = i % 2 == 0;
    if (!(over ? pinching : other)) continue;
    const double height = pulley_radius + small_radius + (over ? 2.0 * half_width : 0.0);
    add_body(scene, "small pulley", BodyKind::rail, a * (i + 1), height, small_radius);
  }
  scene.cables.push_back(cable);
  string_cable(scene);
  return scene;
}

Scene chain_scene(int pulleys) {
  Scene scene = build::load_chain(pulleys, 1000.0, 999.0, 0.1);
  scene.name = "chain";
  return scene;
}

Scene swinging_scene(int pulleys) {
  Scene scene = named("swinging");
  const double reach = pulley_radius + half_width, spacing = 1.5;
  const int weight =
      add_body(scene, "weight", BodyKind::free, spacing * (pulleys - 1) + reach, -3.0, 0.2);
  scene.bodies.back().velocity = {0.5, 0.0};
  Cable cable = build::cable({-1, {-reach, -3.0}}, {}, {weight, {0.0, 0.0}});
  for (int i = 0; i < pulleys; ++i) {
    const int pulley =
        add_body(scene, "pulley", BodyKind::fixed_axle, spacing * i, 0.0, pulley_radius);
    cable.wraps.push_back({pulley, i % 2 == 0 ? -1 : 1, 0});
  }
  scene.cables.push_back(cable);
  return scene;
}

Scene disconnected_scene(int count, int moving) {
  Scene scene = named("disconnected");
  constexpr double spacing = 4.0, swing_speed = 0.5;  // m, m/s
  for (int i = 0; i < count; ++i) {
    const double x = spacing * i;
    const int pulley = add_body(scene, "pulley", BodyKind::fixed_axle, x, 0.0, pulley_radius);
    const int weight =
        add_body(scene, "weight", BodyKind::free, x + pulley_radius + half_width, -1.5, 0.2);
    if (i < moving) scene.bodies.back().velocity = {swing_speed, 0.0};
    Cable cable = build::cable({-1, {x - 1.5, 0.0}}, {}, {weight, {0.0, 0.0}});
    cable.name = fmt::format("cable {}", i);
    cable.wraps.push_back({pulley, -1, 0});
    scene.cables.push_back(cable);
  }
  return scene;
}

}  // namespace pinchlab
