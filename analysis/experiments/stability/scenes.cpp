// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/stability/scenes.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace pinchlab::experiments::stability {

namespace {

using build::at;
using build::body;
using build::on;

constexpr double R = pulley_radius + cable_half_width;

void add_cable(Scene& scene, const Attachment& start, std::vector<Wrap> wraps,
               const Attachment& end, double half_width = cable_half_width) {
  scene.cables.push_back(build::cable(start, std::move(wraps), end, half_width));
  scene.cables.back().name = fmt::format("cable {}", scene.cables.size() - 1);
}

}  // namespace

Scene hanging_pair(double ratio) {
  Scene scene;
  scene.bodies.push_back(body("light", BodyKind::free, 1e-3, -1.0, 0.1, 1.0));
  scene.bodies.push_back(body("heavy", BodyKind::free, 0.0, -2.0, 0.2, ratio));
  for (Body& b : scene.bodies) b.linear_drag = b.angular_drag = 4.0;
  add_cable(scene, at(0.0, 0.0), {}, on(0));
  add_cable(scene, on(0), {}, on(1));
  return scene;
}

Scene heavy_on_light(double ratio) {
  const double w = cable_half_width, r = 0.25;
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, pulley_radius, 10.0));
  const double low = pulley_radius + r + 2.0 * w + 0.05;
  scene.bodies.push_back(body("light", BodyKind::rail, 0.0, low, r, 1.0));
  scene.bodies.push_back(body("heavy", BodyKind::rail, 0.0, low + 2.0 * r + 0.05, r, ratio));
  add_cable(scene, at(-1.0, -2.0), {{0, -1, 0}}, at(1.0, -2.0));
  return scene;
}

Scene caught_load(double height) {
  Scene scene = build::load_chain(5, 10.0, 1.0, 0.1);
  scene.bodies.erase(scene.bodies.begin() + 1);
  Cable& cable = scene.cables[0];
  for (Wrap& wrap : cable.wraps) --wrap.body;
  cable.end = at(1.5 * 4 + R, -3.0);
  cable.slack = height;
  return scene;
}

Scene roller_on_drum(int extra_turns, int cables, double half_width) {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, pulley_radius, 10.0));
  const double y = pulley_radius + 0.25 + 2.0 * half_width + 0.05;
  scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, y, 0.25, 1.0));
  for (int c = 0; c < cables; ++c) {
    add_cable(scene, at(-1.0, -2.0), {{0, -1, extra_turns}}, at(1.0, -2.0), half_width);
  }
  return scene;
}

Scene roller_jerked_at_drum(double mass) {
  const double w = cable_half_width, r = 0.25;
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, pulley_radius, 10.0));
  scene.bodies.push_back(
      body("roller", BodyKind::rail, 0.0, -(pulley_radius + r + 2.0 * w + 0.01), r, 1.0));
  scene.bodies.push_back(body("pulley", BodyKind::fixed_axle, 2.0, 0.0, 0.3, 1.0));
  scene.bodies.push_back(body("weight", BodyKind::rail, 2.35, -2.0, 0.2, mass));
  add_cable(scene, at(-2.0, 2.0), {{0, 1, 0}}, at(2.0, 2.5));
  add_cable(scene, {1, {r, 0.0}}, {{2, -1, 0}}, on(3));
  scene.cables[1].slack = 5.0;
  return scene;
}

Scene slipping_winding(int extra_turns) {
  Scene scene = roller_on_drum(extra_turns);
  scene.bodies[0].kind = BodyKind::fixed;
  scene.bodies.push_back(body("left", BodyKind::free, -R, -3.0, 0.2, 1.0));
  scene.bodies.push_back(body("right", BodyKind::free, R, -3.0, 0.2, 2.0));
  for (Body& b : scene.bodies) b.cable_friction = 0.02;
  scene.cables[0].start = on(2);
  scene.cables[0].end = on(3);
  return scene;
}

Scene zigzag_stack(int count, double half_width) {
  const double w = half_width, r = 0.25, apart = 0.05;
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, pulley_radius, 10.0));
  std::vector<Wrap> wraps{{0, -1, 0}};
  for (int i = 0; i < count; ++i) {
    const double y = pulley_radius + r + 2.0 * w + apart + i * (2.0 * (r + w) + apart);
    scene.bodies.push_back(body(fmt::format("roller {}", i), BodyKind::rail, 0.0, y, r, 1.0));
    wraps.push_back({1 + i, i % 2 == 0 ? 1 : -1, 0});
  }
  const double end_x = count % 2 == 1 ? -3.0 : 3.0, end_y = scene.bodies.back().position.y();
  scene.bodies.push_back(body("weight", BodyKind::free, -(pulley_radius + w), -3.0, 0.2, 1.0));
  scene.bodies.back().linear_drag = scene.bodies.back().angular_drag = 5.0;
  add_cable(scene, on(count + 1), wraps, at(end_x, end_y), w);
  return scene;
}

Scene driven_loop(int wheels, bool roller) {
  constexpr double turn = 2.0 * std::numbers::pi;
  Scene scene;
  const double ring = std::max(1.0, 0.2 * wheels);  // where all rims lie, m
  Cable loop;
  loop.name = "loop";
  loop.closed = true;
  loop.half_width = 0.02;
  for (int i = 0; i < wheels; ++i) {
    const double angle = turn * (0.25 + static_cast<double>(i) / wheels);
    const double radius = i % 2 == 0 ? 0.3 : 0.2, out = ring - radius;
    scene.bodies.push_back(body(fmt::format("wheel {}", i), BodyKind::fixed_axle,
                                out * std::cos(angle), out * std::sin(angle), radius, 1.0));
    loop.wraps.push_back({i, 1, 0});
  }
  scene.bodies[0].driven_angular_velocity = 5.0;
  if (roller) {
    const double y = ring + 0.25 + 2.0 * loop.half_width;
    scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, y, 0.25, 1.0));
  }
  scene.cables.push_back(loop);
  return scene;
}

Scene bob_at_peg(double amplitude_rad) {
  const double w = 1e-3, peg = 4e-3, length = 0.05;
  Scene scene;
  scene.bodies.push_back(body("bob", BodyKind::free, length * std::sin(amplitude_rad),
                              -length * std::cos(amplitude_rad), 5e-3, 0.1));
  scene.bodies.push_back(body("peg", BodyKind::fixed, -(peg + w), -0.5 * length, peg, 1.0));
  add_cable(scene, at(0.0, 0.0), {}, on(0), w);
  return scene;
}

Scene trampoline(double height) {
  const double w = 0.02, r = 0.2, half = 1.5;
  Scene scene;
  scene.bodies.push_back(body("ball", BodyKind::free, 0.0, r + w + 0.15 + w + height, r, 1.0));
  for (const double side : {-1.0, 1.0}) {
    scene.bodies.push_back(body(side < 0.0 ? "left pulley" : "right pulley", BodyKind::fixed_axle,
                                side * half, 0.0, 0.15, 1.0));
    scene.bodies.push_back(body(side < 0.0 ? "left weight" : "right weight", BodyKind::rail,
                                side * (half + 0.15 + w), -2.5, 0.2, 3.0));
  }
  add_cable(scene, on(2), {{1, -1, 0}, {3, -1, 0}}, on(4), w);
  return scene;
}

Scene ball_at_span(double speed, double slack) {
  const double r = 0.1, w = 0.02;
  Scene scene;
  scene.bodies.push_back(body("ball", BodyKind::free, 0.1, 0.0, r, 1.0));
  scene.bodies[0].position.y() = r + w + 2.5 * speed * step_length(scene);
  scene.bodies[0].velocity = {0.0, -speed};
  add_cable(scene, at(-2.0, 0.0), {}, at(2.0, 0.0), w);
  scene.cables[0].slack = slack;
  return scene;
}

Scene unwinding_pendulum() {
  const double w = 0.02, r = 0.2, angle = std::numbers::pi / 3.0, length = 1.5;
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed, 0.0, 0.0, r, 1.0));
  // From the drum's right side, down and to the right; the cable starts left of the drum.
  const Vec2 along(std::sin(angle), -std::cos(angle));
  const Vec2 leaves = (r + w) * Vec2(std::cos(angle), std::sin(angle));
  const Vec2 bob = leaves + length * along;
  scene.bodies.push_back(body("load", BodyKind::free, bob.x(), bob.y(), 0.1, 1.0));
  add_cable(scene, at(-(r + w), -1.0), {{0, -1, 0}}, on(1), w);
  return scene;
}

Scene roller_in_bight() {
  const double w = 0.02, r = 0.2;
  Scene scene;
  scene.bodies.push_back(body("roller", BodyKind::free, -0.6, -0.9, r, 1.0));
  add_cable(scene, at(-2.0, 0.0), {{0, 1, 0}}, at(2.0, 0.0), w);
  return scene;
}

Scene roll_over() {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.33, 10.0));
  scene.bodies.push_back(body("roller", BodyKind::free, -1.7, 0.8, 0.164, 1.0));
  add_cable(scene, at(-2.1, 0.95), {{1, 1, 0}, {0, -1, 0}}, at(2.0, -1.1));
  return scene;
}

Scene two_on_span(double other, bool slack) {
  Scene scene = trampoline(0.4);
  const double height = scene.bodies[0].position.y();
  if (slack) {
    scene = {};
    add_cable(scene, at(-1.5, 0.0), {}, at(1.5, 0.0), 0.02);
    scene.cables[0].slack = 0.2;
  } else {
    scene.bodies.erase(scene.bodies.begin());
    Cable& cable = scene.cables[0];
    for (Wrap& wrap : cable.wraps) --wrap.body;
    --cable.start.body;
    --cable.end.body;
  }
  for (const double side : {-1.0, 1.0}) {
    scene.bodies.push_back(body(side < 0.0 ? "left disc" : "right disc", BodyKind::free, 0.3 * side,
                                height, 0.2, side < 0.0 ? 1.0 : other));
  }
  return scene;
}

Scene load_into_cables() {
  Scene scene;
  scene.bodies.push_back(body("load", BodyKind::free, 0.0, -1.0, 0.1, 2.0));
  scene.bodies[0].velocity = {0.5, 0.0};
  for (const double x : {-0.8, 0.1, 0.9}) {
    add_cable(scene, at(x, 0.0), {}, on(0));
    scene.cables.back().slack = 0.3 + 0.05 * x;
  }
  return scene;
}

Scene newtons_cradle() {
  constexpr double length = 1.0, radius = 0.1, aside = 0.5;
  Scene scene;
  for (int i = 0; i < 5; ++i) {
    const double x = 2.0 * radius * i, angle = i == 0 ? aside : 0.0;
    Body ball = body(fmt::format("ball {}", i), BodyKind::free, x - length * std::sin(angle),
                     -length * std::cos(angle), radius, 1.0);
    ball.restitution = 1.0;
    ball.contact_friction = 0.0;
    scene.bodies.push_back(ball);
    add_cable(scene, at(x, 0.0), {}, on(i), 0.01);
  }
  return scene;
}

}  // namespace pinchlab::experiments::stability
