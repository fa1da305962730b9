// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/event_scenes.h"

#include <cmath>
#include <functional>

#include "analysis/experiments/accuracy_scenes.h"
#include "demos/scenes/build.h"

namespace pinchlab::experiments {

namespace {

using build::body;

constexpr double g = 9.81;  // m/s^2

/// A scene whose bodies are all watched, `place` (m) telling where body b is at time t (s).
Problem known(const std::string& name, const std::string& title, Scene scene, int frames,
              const std::function<Vec2(double, std::size_t)>& place) {
  Problem problem;
  problem.name = name;
  problem.title = title;
  problem.scene = std::move(scene);
  problem.frames = frames;
  for (std::size_t b = 0; b < problem.scene.bodies.size(); ++b) problem.watched.push_back(b);
  for (int frame = 0; frame <= frames; ++frame) {
    std::vector<Place>& places = problem.exact.emplace_back();
    const double t = static_cast<double>(frame) / problem.scene.frames_per_second;
    for (const std::size_t b : problem.watched) places.push_back({place(t, b), 0.0});
  }
  problem.length = "a metre";
  problem.reference = "closed form";
  return problem;
}

Wall wall(const Vec2& a, const Vec2& b, double restitution) {
  return {a, b, 0.0, restitution};
}

}  // namespace

// From height h above rest: t_0 = sqrt(2h/g), then flights of 2 e^k v/g from bounce to bounce.
Problem bouncing_ball() {
  constexpr double h = 1.0, radius = 0.1, e = 0.8;
  Scene scene;
  scene.bodies.push_back(body("ball", BodyKind::free, 0.0, radius + h, radius));
  scene.walls.push_back(wall({-2.0, 0.0}, {2.0, 0.0}, e));
  return known(
      "bouncing-ball", "Ten bounces of restitution 0.8", scene, 210, [&](double t, std::size_t) {
        double since = t, speed = 0.0, y = h;  // of the flight: time, start's speed, height
        double flight = std::sqrt(2.0 * h / g), impact = g * flight;
        while (since > flight) {
          since -= flight;
          speed = e * impact;
          impact = speed;
          y = 0.0;
          flight = 2.0 * speed / g;
        }
        return Vec2(0.0, radius + y + speed * since - 0.5 * g * since * since);
      });
}

Problem ball_between_walls() {
  constexpr double radius = 0.1, half = 1.0, speed = 7.3;
  Scene scene;
  scene.gravity = Vec2::Zero();
  scene.bodies.push_back(body("ball", BodyKind::free, 0.0, 0.0, radius));
  scene.bodies[0].velocity = {speed, 0.4};
  for (const double side : {-1.0, 1.0}) {
    const double x = side * (half + radius);
    scene.walls.push_back(wall({x, -2.0}, {x, 2.0}, 1.0));
  }
  return known("between-walls", "A ball between two walls, restitution 1", scene, 120,
               [&](double t, std::size_t) {
                 const double way = std::fmod(speed * t + half, 4.0 * half);
                 return Vec2(way < 2.0 * half ? way - half : 3.0 * half - way, 0.4 * t);
               });
}

Problem caught_load() {
  constexpr double slack = 0.5;
  Scene scene;
  scene.bodies.push_back(body("load", BodyKind::free, 0.0, -1.0, 0.1, 2.0));
  scene.cables.push_back(build::cable(build::at(0.0, 0.0), {}, build::on(0)));
  scene.cables[0].slack = slack;
  return known(
      "caught-load", "A falling load, stopped dead by its cable", scene, 60,
      [&](double t, std::size_t) { return Vec2(0.0, -1.0 - std::min(slack, 0.5 * g * t * t)); });
}

// Both fall freely for t_0 = sqrt(slack / g), when g t_0^2 of slack is used up. The cable's impulse
// p on either makes their speeds opposite: p (1/m_1 + 1/m_2) = 2 g t_0. Then an Atwood machine.
Problem caught_over_a_peg() {
  constexpr double slack = 0.3, m1 = 1.0, m2 = 3.0, R = 0.3 + build::cable_half_width;
  Scene scene;
  scene.bodies.push_back(body("light", BodyKind::free, -R, -1.0, 0.1, m1));
  scene.bodies.push_back(body("heavy", BodyKind::free, R, -1.0, 0.1, m2));
  scene.bodies.push_back(body("peg", BodyKind::fixed, 0.0, 0.0, 0.3));
  scene.bodies[2].cable_friction = 0.0;
  scene.cables.push_back(build::cable(build::on(0), {{2, -1, 0}}, build::on(1)));
  scene.cables[0].slack = slack;
  const double t0 = std::sqrt(slack / g), v0 = g * t0;
  const double v = v0 - 2.0 * v0 * m1 / (m1 + m2);  // of the heavy one, downwards, after the catch
  const double a = (m2 - m1) / (m1 + m2) * g;
  return known("caught-over-a-peg", "1 and 3 kg caught by slack cable over a frictionless peg",
               scene, 30, [&](double t, std::size_t b) -> Vec2 {
                 if (b == 2) return Vec2::Zero();
                 const double side = b == 1 ? 1.0 : -1.0;
                 const double before = std::min(t, t0), after = t - before;
                 const double down =
                     0.5 * g * before * before + side * (v * after + 0.5 * a * after * after);
                 return {side * R, -1.0 - down};
               });
}

Problem two_on_slack_cable() {
  constexpr double slack = 0.6, m1 = 1.0, m2 = 3.0, v1 = -1.0, v2 = 2.0, gap = 0.5;
  Scene scene;
  scene.gravity = Vec2::Zero();
  scene.bodies.push_back(body("left", BodyKind::free, 0.0, 0.0, 0.1, m1));
  scene.bodies.push_back(body("right", BodyKind::free, gap, 0.0, 0.1, m2));
  scene.bodies[0].velocity = {v1, 0.0};
  scene.bodies[1].velocity = {v2, 0.0};
  scene.cables.push_back(build::cable(build::on(0), {}, build::on(1)));
  scene.cables[0].slack = slack;
  const double t0 = slack / (v2 - v1), together = (m1 * v1 + m2 * v2) / (m1 + m2);
  return known("two-on-slack-cable", "Two bodies that fly apart until their cable is taut", scene,
               60, [&](double t, std::size_t b) {
                 const double before = std::min(t, t0);
                 return Vec2(
                     (b == 0 ? 0.0 : gap) + (b == 0 ? v1 : v2) * before + together * (t - before),
                     0.0);
               });
}

Problem galileos_peg() {
  Scene scene;
  scene.bodies.push_back(body("bob", BodyKind::free, -0.8, -0.6, 0.08));
  scene.bodies.push_back(body("peg", BodyKind::fixed, 0.0, -0.5, 0.02));
  scene.cables.push_back(build::cable(build::at(0.0, 0.0), {}, build::on(0), 0.01));
  Problem problem = own_solution("galileos-peg", scene, 1.5, 2048);
  problem.title = "Galileo's peg: a pendulum whose cable meets a peg";
  problem.length_m = 1.0;
  problem.length = "a metre";
  return problem;
}

std::vector<Problem> event_problems() {
  return {bouncing_ball(),     ball_between_walls(), caught_load(),
          caught_over_a_peg(), two_on_slack_cable(), galileos_peg()};
}

}  // namespace pinchlab::experiments
