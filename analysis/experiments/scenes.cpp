// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/scenes.h"

#include <fmt/format.h>

namespace pinchlab::experiments {

namespace {

constexpr double pulley_radius = 0.5, half_width = 0.05;  // m

Scene named(const std::string& name) {
  Scene scene;
  scene.name = name;
  return scene;
}

/// Adds a body and returns its index. Its mass is 1 kg, as in the thesis' scenes.
int add_body(Scene& scene, const char* what, BodyKind kind, double x, double y, double radius) {
  Body body;
  body.name = fmt::format("{} {}", what, scene.bodies.size());
  body.kind = kind;
  body.position = {x, y};
  body.radius = radius;
  scene.bodies.push_back(body);
  return static_cast<int>(scene.bodies.size()) - 1;
}

Cable cable_between(const Attachment& start, const Attachment& end) {
  Cable cable;
  cable.name = "cable";
  cable.half_width = half_width;
  cable.start = start;
  cable.end = end;
  return cable;
}

/// Length of the cable's free spans, m, as make_world lays them.
double free_length(const Scene& scene) {
  const World world = make_world(scene, Method::pinch);
  double sum = 0.0;
  const CableState& cable = world.cables.front();
  for (std::size_t s = 1; s < cable.segments.size(); ++s) sum += cable.segments[s].length;
  return sum;
}

}  // namespace

Scene stress_scene(int load, double spacing) {
  Scene scene = named("stress");
  const double a = spacing;
  Cable cable = cable_between({-1, {0.0, 0.0}}, {-1, {2.0 * a * load, 0.0}});
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
  cable.axial_stiffness = stress_stiffness;
  scene.cables.push_back(cable);
  // What lies on the pulleys is not stretched (no slip): only free spans pull.
  scene.cables.front().slack = -stress_strain / (1.0 + stress_strain) * free_length(scene);
  return scene;
}

Scene pinch_detection_scene(int load, bool pinching, bool other) {
  Scene scene = named("pinch-detection");
  constexpr double a = 1.2, small_radius = 0.25;
  Cable cable = cable_between({-1, {0.0, 0.0}}, {-1, {a * (2 * load + 1), 0.0}});
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
  return scene;
}

Scene chain_scene(int pulleys) {
  Scene scene = named("chain");
  const double reach = pulley_radius + half_width, spacing = 1.5;
  const int left = add_body(scene, "weight", BodyKind::free, -reach, -3.0, 0.2);
  const int right =
      add_body(scene, "weight", BodyKind::free, spacing * (pulleys - 1) + reach, -3.0, 0.2);
  scene.bodies[static_cast<std::size_t>(left)].mass = 1000.0;
  scene.bodies[static_cast<std::size_t>(right)].mass = 999.0;
  Cable cable = cable_between({left, {0.0, 0.0}}, {right, {0.0, 0.0}});
  for (int i = 0; i < pulleys; ++i) {
    const int pulley =
        add_body(scene, "pulley", BodyKind::fixed_axle, spacing * i, 0.0, pulley_radius);
    scene.bodies[static_cast<std::size_t>(pulley)].mass = 0.1;
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
    Cable cable = cable_between({-1, {x - 1.5, 0.0}}, {weight, {0.0, 0.0}});
    cable.name = fmt::format("cable {}", i);
    cable.wraps.push_back({pulley, -1, 0});
    scene.cables.push_back(cable);
  }
  return scene;
}

ElementCounts count_elements(const World& world) {
  ElementCounts counts;
  counts.bodies = world.position.size();
  for (const Contact& contact : world.contacts) counts.contacts += contact.pinch_points > 0;
  for (const CableState& cable : world.cables) {
    counts.joints += cable.links.size();
    counts.segments += cable.links.size() - (cable.closed ? 0 : 1);
    for (std::size_t i = cable.closed ? 0 : 1; i < cable.links.size(); ++i) {
      const std::size_t before = i > 0 ? i - 1 : cable.links.size() - 1;
      const bool middle = cable.links[i].pinch_middle;
      counts.non_transitional += middle;
      counts.transitional +=
          cable.segments[i].pinched && !middle && !cable.links[before].pinch_middle;
    }
  }
  return counts;
}

}  // namespace pinchlab::experiments
