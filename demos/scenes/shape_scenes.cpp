// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/shape_scenes.h"

#include <cmath>
#include <numbers>

#include "demos/scenes/build.h"
#include "sim/nodes.h"
#include "sim/outline.h"

namespace pinchlab::build {

namespace {

constexpr double g = 9.81;  // m/s^2, the default gravity

/// Of the bob's angle and its speed, by one step of Runge and Kutta's method on either side of 0,
/// also where the step goes beyond it.
struct Swing {
  double angle = 0.0, speed = 0.0;  // rad, rad/s

  void advance(double h, double free_at_0, double w) {
    const auto acceleration = [&](double th, double omega) {
      return -(w * omega * omega + g * std::sin(th)) / (free_at_0 + w * th);
    };
    const double k1 = acceleration(angle, speed), v1 = speed;
    const double v2 = speed + 0.5 * h * k1, k2 = acceleration(angle + 0.5 * h * v1, v2);
    const double v3 = speed + 0.5 * h * k2, k3 = acceleration(angle + 0.5 * h * v2, v3);
    const double v4 = speed + h * k3, k4 = acceleration(angle + h * v3, v4);
    angle += h / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
    speed += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
};

}  // namespace

std::vector<Vec2> regular_corners(int count, double radius, double first) {
  std::vector<Vec2> corners;
  for (int k = 0; k < count; ++k) {
    const double angle = first + 2.0 * std::numbers::pi * k / count;
    corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return corners;
}

std::vector<Vec2> box_corners(double width, double height) {
  const double x = 0.5 * width, y = 0.5 * height;
  return {{-x, -y}, {x, -y}, {x, y}, {-x, y}};
}

Vec2 SquareDrum::place(double th) const {
  const double length = free + half_width * (th - start) + (th > 0.0 ? 2.0 * half : 0.0);
  return Vec2(half, th > 0.0 ? half : -half) + half_width * Vec2(std::cos(th), std::sin(th)) +
         length * Vec2(std::sin(th), -std::cos(th));
}

Scene SquareDrum::scene(int steps_per_frame) const {
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  Body drum = body("drum", BodyKind::fixed, Vec2::Zero(), 1.0);
  make_polygon(drum, box_corners(2.0 * half, 2.0 * half), 0.0);
  scene.bodies.push_back(drum);
  scene.bodies.push_back(body("bob", BodyKind::free, place(start), 0.02, 1.0));
  scene.cables.push_back(cable({0, {0.0, half + half_width}}, {{0, -1, 0}}, on(1), half_width));
  return scene;
}

Vec2 SquareDrum::bob_after(double seconds) const {
  constexpr int steps = 200'000;
  const double h = seconds / steps, inner = free - half_width * start, outer = inner + 2.0 * half;
  Swing swing{start, 0.0};
  for (int i = 0; i < steps; ++i) {
    const bool out = swing.angle > 0.0;
    Swing next = swing;
    next.advance(h, out ? outer : inner, half_width);
    if ((next.angle > 0.0) != out) {
      double low = 0.0, high = h;  // s, into the step, about when it passes 0
      for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (low + high);
        next = swing;
        next.advance(middle, out ? outer : inner, half_width);
        ((next.angle > 0.0) == out ? low : high) = middle;
      }
      next = swing;
      next.advance(high, out ? outer : inner, half_width);
      next.speed *= out ? outer / inner : inner / outer;
      next.advance(h - high, out ? inner : outer, half_width);
    }
    swing = next;
  }
  return place(swing.angle);
}

namespace {

Scene with_bob(const Body& drum, const Attachment& start, int steps_per_frame) {
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  scene.bodies.push_back(drum);
  scene.bodies.push_back(body("bob", BodyKind::free, 0.75, -1.2, 0.02, 1.0));
  scene.cables.push_back(cable(start, {{0, -1, 0}}, on(1)));
  return scene;
}

Body drum_of(double radius, double speed) {
  Body drum = body("drum", BodyKind::fixed_axle, Vec2::Zero(), radius, 10.0);
  drum.inertia = 2.0;
  drum.angular_velocity = speed;
  return drum;
}

}  // namespace

Scene turning_drum(const std::vector<Vec2>& corners, double speed, int steps_per_frame) {
  Body drum = drum_of(1.0, speed);
  make_polygon(drum, corners, 0.0);
  double left = 0.0;  // of a side that is upright there
  for (const Vec2& corner : corners) left = std::min(left, corner.x());
  return with_bob(drum, {0, {left - cable_half_width, 0.0}}, steps_per_frame);
}

Scene turning_drum(double radius, double speed, int steps_per_frame) {
  return with_bob(drum_of(radius, speed), {0, {-radius - cable_half_width, 0.0}}, steps_per_frame);
}

Scene disc_on_plank(int steps_per_frame) {
  constexpr double thick = 0.2, radius = 0.2;
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  scene.bodies.push_back(body("plank", BodyKind::fixed_axle, 0.0, 0.0, 1.0, 5.0));
  make_polygon(scene.bodies[0], box_corners(3.0, thick), 0.0);
  scene.bodies.push_back(body("disc", BodyKind::free, 0.4, 0.5 * thick + radius, radius, 1.0));
  for (Body& b : scene.bodies) b.contact_friction = 2.0;
  return scene;
}

Scene box_on_disc(int steps_per_frame) {
  constexpr double radius = 0.6, half_height = 0.1, leans = 0.4;
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  scene.bodies.push_back(body("disc", BodyKind::fixed, 0.0, 0.0, radius, 1.0));
  const Vec2 out(std::sin(leans), std::cos(leans)), along(std::cos(leans), -std::sin(leans));
  const Vec2 place = (radius + half_height) * out - radius * leans * along;
  scene.bodies.push_back(body("box", BodyKind::free, place.x(), place.y(), 1.0, 2.0));
  make_polygon(scene.bodies[1], box_corners(1.2, 2.0 * half_height), 0.0);
  scene.bodies[1].angle = -leans;
  for (Body& b : scene.bodies) b.contact_friction = 2.0;
  return scene;
}

Scene pressed_drum(int steps_per_frame) {
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 1.0, 3.0));
  make_polygon(scene.bodies[0], regular_corners(6, 0.5), 0.02);
  scene.bodies.push_back(body("heavy", BodyKind::free, 0.6, -2.0, 0.1, 5.0));
  scene.bodies.push_back(body("light", BodyKind::free, -0.6, -3.0, 0.1, 2.0));
  scene.bodies.push_back(body("roller", BodyKind::rail, 0.05, 0.9, 0.2, 1.0));
  scene.bodies[0].cable_friction = 0.3;
  scene.bodies[3].cable_friction = 0.2;
  scene.cables.push_back(cable(on(2), {{0, -1, 0}}, on(1), 0.03));
  return scene;
}

Scene layered_hoist(int turns, double half_width, int steps_per_frame, bool begins_there) {
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.2, 3.0));
  scene.bodies.push_back(body("load", BodyKind::rail, 0.3, -8.0, 0.1, 2.0));
  const Attachment rim{0, {-0.2 - half_width, 0.0}, true};
  const std::vector<Wrap> wraps = {{0, begins_there ? -1 : 1, turns}};
  scene.cables.push_back(begins_there ? cable(rim, wraps, on(1), half_width)
                                      : cable(on(1), wraps, rim, half_width));
  return scene;
}

Scene heavy_hoist(int steps_per_frame, bool begins_there) {
  Scene scene = layered_hoist(8, 0.02, steps_per_frame, begins_there);
  scene.cables[0].mass_per_metre = 2.0;
  Body& load = scene.bodies[1];
  load.kind = BodyKind::free;
  load.position = {2.0, -3.0};
  load.mass = 20.0;
  return scene;
}

Scene belt_drive(double radius, double tension, double difference, int steps_per_frame) {
  constexpr double speed = 6.0, first = 0.2, inertia = 0.05, apart = 1.0;
  Scene scene;
  scene.gravity = Vec2::Zero();
  scene.steps_per_frame = steps_per_frame;
  scene.bodies.push_back(body("driver", BodyKind::fixed_axle, 0.0, 0.0, first, 1.0));
  scene.bodies.push_back(body("driven", BodyKind::fixed_axle, apart, 0.0, radius, 4.0));
  const double r1 = first + belt_half_width, r2 = radius + belt_half_width, more = r2 - r1;
  scene.bodies[0].driven_angular_velocity = speed;
  Body& driven = scene.bodies[1];
  driven.angular_velocity = speed * r1 / r2;
  driven.inertia = inertia;
  driven.angular_drag = difference * r2 / (inertia * driven.angular_velocity);
  Cable belt;
  belt.name = "belt";
  belt.closed = true;
  belt.half_width = belt_half_width;
  belt.wraps = {{0, 1, 0}, {1, 1, 0}};
  belt.axial_stiffness = belt_stiffness;
  const double length = 2.0 * std::sqrt(apart * apart - more * more) +
                        std::numbers::pi * (r1 + r2) + 2.0 * more * std::asin(more / apart);
  const double strain = tension / belt_stiffness;
  belt.slack = -length * strain / (1.0 + strain);
  scene.cables.push_back(belt);
  return scene;
}

Scene rope_atwood(int steps_per_frame) {
  constexpr double radius = 0.2, half_width = 0.01;  // m, of the rope on the pulley
  const double span = 0.5 * (4.0 - radius * std::numbers::pi);
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  scene.bodies.push_back(body("light", BodyKind::free, -radius, -span, 0.05));
  scene.bodies.push_back(body("heavy", BodyKind::free, radius, -span, 0.05, 1.5));
  scene.bodies.push_back(body("pulley", BodyKind::fixed_axle, 0.0, 0.0, radius - half_width));
  scene.bodies[2].inertia = 0.25 * radius * radius;
  scene.cables.push_back(cable(on(0), {{2, -1, 0}}, on(1), half_width));
  scene.cables[0].mass_per_metre = 0.4;
  return scene;
}

Scene rope_over_peg(double mu, int steps_per_frame) {
  constexpr double radius = 0.2, half_width = 0.01;  // m, of the rope on the peg
  const double span = 0.5 * (4.0 - radius * std::numbers::pi);
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  scene.bodies.push_back(body("left", BodyKind::free, -radius, 0.1 - span, 0.05, 0.1));
  scene.bodies.push_back(body("right", BodyKind::free, radius, -0.1 - span, 0.05, 0.1));
  scene.bodies.push_back(body("peg", BodyKind::fixed, 0.0, 0.0, radius - half_width));
  scene.bodies[2].cable_friction = mu;
  scene.cables.push_back(cable(on(0), {{2, -1, 0}}, on(1), half_width));
  scene.cables[0].mass_per_metre = 0.4;
  return scene;
}

Scene heavy_tackle(int steps_per_frame) {
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  scene.bodies.push_back(body("block", BodyKind::free, 0.05, -1.0, 0.19));
  scene.bodies.push_back(body("weight", BodyKind::free, 0.62, -0.8, 0.1, 0.7));
  scene.bodies.push_back(body("pulley", BodyKind::fixed_axle, 0.45, 0.0, 0.14));
  const Attachment hook{1, {0.005, 0.05}};
  scene.cables.push_back(cable(at(-0.3, 0.3), {{0, 1, 0}, {2, -1, 0}}, hook, 0.01));
  scene.cables[0].mass_per_metre = 0.8;
  return scene;
}

Scene sagging_hoist(int nodes, int steps_per_frame) {
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  for (const double side : {-1.0, 1.0}) {
    scene.bodies.push_back(body(side < 0.0 ? "light" : "heavy", BodyKind::free, 2.32 * side, -1.5,
                                0.15, 6.5 + 0.5 * side));
  }
  for (const double side : {-1.0, 1.0}) {
    scene.bodies.push_back(
        body(side < 0.0 ? "left" : "right", BodyKind::fixed_axle, 2.0 * side, 0.0, 0.3, 1.0));
  }
  scene.cables.push_back(cable(Attachment{0, {0.0, 0.12}}, {{2, -1, 0}, {3, -1, 0}},
                               Attachment{1, {0.0, 0.12}}, 0.02));
  scene.cables[0].mass_per_metre = 1.5;
  scene.cables[0].nodes = nodes;
  spread_nodes(scene);
  return scene;
}

Scene catenary(int pieces, int steps_per_frame) {
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  scene.cables.push_back(cable(at(0.0, 0.0), {}, at(1.0, 0.0), 0.002));
  scene.cables[0].slack = 1.0;
  scene.cables[0].mass_per_metre = 1.0;
  scene.cables[0].nodes = pieces > 0 ? pieces - 1 : 0;
  return scene;
}

Scene flexible_pendulum(int pieces, int steps_per_frame) {
  constexpr double density = 0.39269908;  // kg/m
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  const double half_piece = 0.5 * density / pieces;  // kg
  scene.bodies.push_back(body("tip", BodyKind::free, 1.0, 0.0, 0.001, half_piece));
  scene.bodies[0].node = true;
  scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0), 0.001));
  Cable& whole = scene.cables[0];
  whole.mass_per_metre = density;
  whole.nodes = pieces - 1;
  whole.axial_stiffness = 1570.7963;
  whole.bending_stiffness = 0.2;
  spread_nodes(scene);
  scene.bodies.back().mass -= half_piece;  // which is the tip's
  return scene;
}

Scene folded_chain(int pieces, int steps_per_frame, double tolerance) {
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  const double piece = 1.0 / pieces;
  const double tip = tolerance > 0.0 ? 1e-6 * piece : 0.5 * piece;  // kg
  scene.bodies.push_back(body("tip", BodyKind::free, 0.5 * piece, 0.0, 0.002, tip));
  scene.bodies[0].node = true;  // its half piece, which meets no other node
  scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0), 0.002));
  scene.cables[0].slack = 1.0 - 0.5 * piece;
  scene.cables[0].mass_per_metre = 1.0;
  scene.cables[0].nodes = pieces - 1;
  scene.cables[0].node_tolerance = tolerance;
  spread_nodes(scene);
  return scene;
}

Scene drawn_taut(int nodes, int steps_per_frame, double tolerance) {
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  scene.bodies.push_back(body("ring", BodyKind::free, 1.0, 0.0, 0.01, 0.2));
  scene.bodies[0].node = true;  // which no node of the cable meets
  scene.bodies[0].linear_drag = 0.5;
  scene.bodies.push_back(body("winch", BodyKind::fixed_axle, 2.0, -0.15, 0.15, 5.0));
  Body& winch = scene.bodies[1];
  winch.driven_angular_velocity = 0.0;
  winch.torque_limit = 300.0;
  winch.motor = {{0.2, 0.0}, {0.5, -2.0}, {2.5, -2.0}, {2.8, 1.5}, {4.0, 1.5}, {4.1, 0.0}};
  scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0), 0.003));
  Cable& hanging = scene.cables[0];
  hanging.slack = 0.25;
  hanging.mass_per_metre = 0.8;
  hanging.nodes = nodes;
  hanging.node_tolerance = tolerance;
  hanging.linear_drag = 0.8;
  Attachment rim = on(1);
  rim.point = {winch.radius + 0.003, 0.0};
  scene.cables.push_back(cable(on(0), {{1, -1, 1}}, rim, 0.003));
  spread_nodes(scene);
  return scene;
}

Scene crane(int nodes, int steps_per_frame, double tolerance) {
  constexpr double half_width = 0.005, drum = 0.15;  // m
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  scene.bodies.push_back(body("load", BodyKind::free, 2.1 + half_width, 1.2, 0.2, 50.0));
  scene.bodies.push_back(body("sheave", BodyKind::fixed_axle, 2.0, 3.0, 0.1, 2.0));
  scene.bodies.push_back(body("winch", BodyKind::fixed_axle, 0.0, 0.0, drum, 5.0));
  Body& winch = scene.bodies[2];
  winch.driven_angular_velocity = 0.0;
  winch.torque_limit = 300.0;
  winch.motor = {{0.2, 0.0}, {0.4, -6.0}, {1.8, -6.0}, {2.0, 0.0},
                 {2.5, 0.0}, {2.8, 6.0},  {4.3, 6.0},  {4.6, 0.0}};
  Attachment rim = on(2);
  rim.point = {-drum - half_width, 0.0};
  scene.cables.push_back(cable(Attachment{0, {0.0, 0.2}}, {{1, 1, 0}, {2, 1, 2}}, rim, half_width));
  Cable& rope = scene.cables[0];
  rope.mass_per_metre = 0.8;
  rope.nodes = nodes;
  rope.node_tolerance = tolerance;
  rope.linear_drag = 0.8;
  scene.walls.push_back({Vec2(1.0, 0.0), Vec2(4.0, 0.0), 0.5, 0.0});
  spread_nodes(scene);
  return scene;
}

}  // namespace pinchlab::build
