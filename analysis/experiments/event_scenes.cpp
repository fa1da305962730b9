// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/event_scenes.h"

#include <cmath>
#include <functional>
#include <numbers>

#include "analysis/experiments/references.h"
#include "demos/scenes/build.h"
#include "demos/scenes/shape_scenes.h"
#include "sim/outline.h"

namespace pinchlab::experiments {

namespace {

using build::body;

constexpr double g = 9.81;  // m/s^2

Problem all_watched(const std::string& name, const std::string& title, Scene scene, int frames) {
  Problem problem;
  problem.name = name;
  problem.title = title;
  problem.scene = std::move(scene);
  problem.frames = frames;
  for (std::size_t b = 0; b < problem.scene.bodies.size(); ++b) problem.watched.push_back(b);
  return problem;
}

/// Once `exact` is there.
void measure_by_reach(Problem& problem) {
  problem.length_m = reach(problem.exact, false);
  problem.length = "the farthest that a body gets from its start";
}

/// `place` (m) tells where body b is at time t (s).
Problem known(const std::string& name, const std::string& title, Scene scene, int frames,
              const std::function<Vec2(double, std::size_t)>& place) {
  Problem problem = all_watched(name, title, std::move(scene), frames);
  for (int frame = 0; frame <= frames; ++frame) {
    std::vector<Place>& places = problem.exact.emplace_back();
    const double t = static_cast<double>(frame) / problem.scene.frames_per_second;
    for (const std::size_t b : problem.watched) places.push_back({place(t, b), 0.0});
  }
  measure_by_reach(problem);
  problem.reference = "closed form";
  return problem;
}

/// `place` (m) tells where body b is at state y of `phases`.
Problem integrated(const std::string& name, const std::string& title, Scene scene, int frames,
                   const std::vector<Phase>& phases, const State& start,
                   const std::function<Vec2(const State&, std::size_t)>& place) {
  Problem problem = all_watched(name, title, std::move(scene), frames);
  for (const State& y : integrate(phases, start, 1.0 / problem.scene.frames_per_second, frames)) {
    std::vector<Place>& places = problem.exact.emplace_back();
    for (const std::size_t b : problem.watched) places.push_back({place(y, b), 0.0});
  }
  measure_by_reach(problem);
  problem.reference = "equations of motion between events, integrated by GSL to 1e-13 a step";
  problem.doubt_m = 1e-10;
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
  constexpr double peg_radius = 0.02, half_width = 0.01;
  const PegPendulum pendulum{1.0, 0.5, peg_radius + half_width, g};
  Scene scene;
  scene.bodies.push_back(body("bob", BodyKind::free, -0.8, -0.6, 0.08));
  scene.bodies.push_back(body("peg", BodyKind::fixed, 0.0, -pendulum.depth, peg_radius));
  scene.cables.push_back(build::cable(build::at(0.0, 0.0), {}, build::on(0), half_width));
  return integrated("galileos-peg", "Galileo's peg: a pendulum whose cable meets a peg", scene, 90,
                    pendulum.phases(), {-std::atan2(0.8, 0.6), 0.0},
                    [&](const State& y, std::size_t b) {
                      Vec2 place = scene.bodies[b].position;
                      if (b == 0) pendulum.place(y, place.x(), place.y());
                      return place;
                    });
}

// Spans do not run into nodes: the bob must pass the cable on which the load hangs.
Problem looping_pendulum() {
  constexpr double rod_radius = 0.04, half_width = 0.01, hanging = -0.5;
  LoopingPendulum pendulum;
  pendulum.radius = rod_radius + half_width;
  pendulum.start_angle = 0.5 * std::numbers::pi;
  pendulum.g = g;
  const State start{pendulum.start_angle, 0.0, 0.0, 0.0};
  const double R = pendulum.radius;
  Scene scene;
  scene.bodies.push_back(body("bob", BodyKind::free, -pendulum.length, R, 0.02, pendulum.bob));
  scene.bodies.push_back(body("load", BodyKind::free, R, hanging, 0.02, pendulum.load));
  for (Body& end : scene.bodies) end.node = true;
  scene.bodies.push_back(body("rod", BodyKind::fixed, 0.0, 0.0, rod_radius));
  scene.bodies[2].cable_friction = pendulum.friction;
  scene.cables.push_back(build::cable(build::on(1), {{2, 1, 0}}, build::on(0), half_width));
  return integrated("looping-pendulum", "A looping pendulum slips, sticks, slips and sticks", scene,
                    70, pendulum.phases(), start, [&](const State& y, std::size_t b) {
                      Vec2 place = scene.bodies[b].position;
                      if (b == 0) pendulum.place(y, place.x(), place.y());
                      if (b == 1) place.y() -= y[2];
                      return place;
                    });
}

// Up with v' = -g (sin th + mu cos th), down with v' = -g (sin th - mu cos th).
Problem box_on_a_slope() {
  constexpr double slope = 0.5, friction = 0.3, speed = 2.0, high = 0.2;
  const Vec2 along(std::cos(slope), std::sin(slope)), up(-along.y(), along.x());
  Scene scene;
  scene.walls.push_back({-5.0 * along, 5.0 * along, friction, 0.0});
  Body box = body("box", BodyKind::free, 0.5 * high * up, 1.0);
  make_polygon(box, build::box_corners(2.0 * high, high), 0.0);
  box.angle = slope;
  box.velocity = speed * along;
  box.contact_friction = friction;
  scene.bodies.push_back(box);
  const double braked = g * (along.y() + friction * along.x());
  const double driven = g * (along.y() - friction * along.x());
  const double rests = speed / braked;  // s
  return known("box-on-a-slope", "A box that slides up a slope and down again", scene, 54,
               [&](double t, std::size_t) -> Vec2 {
                 const double before = std::min(t, rests), after = t - before;
                 const double way =
                     speed * before - 0.5 * braked * before * before - 0.5 * driven * after * after;
                 return box.position + way * along;
               });
}

// Round the edge it would go with v^2 / R > g, and so flies off it.
Problem ball_off_a_table() {
  constexpr double R = 0.2, speed = 2.0, way = 0.513;
  Scene scene;
  Body table = body("table", BodyKind::fixed, -1.0, -0.1, 1.0);
  make_polygon(table, build::box_corners(2.0, 0.2), 0.0);
  scene.bodies.push_back(table);
  Body ball = body("ball", BodyKind::free, -way, R, R);
  ball.velocity = {speed, 0.0};
  ball.angular_velocity = -speed / R;
  scene.bodies.push_back(ball);
  return known("ball-off-a-table", "A ball that rolls off a table's edge", scene, 60,
               [&](double t, std::size_t b) -> Vec2 {
                 if (b == 0) return table.position;
                 const double falls = std::max(0.0, t - way / speed);
                 return {speed * t - way, R - 0.5 * g * falls * falls};
               });
}

Problem box_off_a_table() {
  constexpr double speed = 2.5, way = 0.713;
  TippingBox tipping;
  tipping.g = g;
  Scene scene;
  Body table = body("table", BodyKind::fixed, -1.0, -0.1, 1.0);
  make_polygon(table, build::box_corners(2.0, 0.2), 0.0);
  table.contact_friction = 0.0;
  scene.bodies.push_back(table);
  Body box = body("box", BodyKind::free, -way, tipping.half_height, 1.0, tipping.mass);
  make_polygon(box, build::box_corners(2.0 * tipping.half_length, 2.0 * tipping.half_height), 0.0);
  box.inertia = tipping.inertia;
  box.contact_friction = 0.0;
  box.velocity = {speed, 0.0};
  scene.bodies.push_back(box);
  return integrated("box-off-a-table", "A box that slides over a table's edge, tips and slides off",
                    scene, 48, tipping.phases(), {-way, tipping.half_height, 0.0, speed, 0.0, 0.0},
                    [&](const State& y, std::size_t b) -> Vec2 {
                      if (b == 0) return table.position;
                      return {y[0], y[1]};
                    });
}

// Between equal loads on a drum on which their cable slips all the time, v' = +-g (k - 1) / (k + 1)
// with k = exp(mu pi), towards the rim's speed u; that changes too fast for them to follow.
Problem slip_on_a_drum() {
  constexpr double radius = 0.5, friction = 0.2, low = -3.0;
  const double R = radius + build::cable_half_width;
  const double k = std::exp(friction * std::numbers::pi), a = g * (k - 1.0) / (k + 1.0);
  Scene scene;
  Body drum = body("drum", BodyKind::fixed_axle, 0.0, 0.0, radius);
  drum.cable_friction = friction;
  drum.motor = {{0.0, 6.0}, {0.503, -6.0}, {1.01, 6.0}, {1.497, -6.0}, {2.1, 6.0}};
  drum.driven_angular_velocity = drum.angular_velocity = drum.motor[0].value;
  scene.bodies.push_back(drum);
  for (const double side : {-1.0, 1.0}) {
    scene.bodies.push_back(body(side < 0.0 ? "left" : "right", BodyKind::rail, side * R, low, 0.1));
  }
  scene.cables.push_back(build::cable(build::on(1), {{0, -1, 0}}, build::on(2)));
  const auto raised = [&](double t) {  // m, of the right one
    double v = 0.0, way = 0.0;
    for (std::size_t i = 0; i + 1 < drum.motor.size() && drum.motor[i].time < t; ++i) {
      const MotorPoint &from = drum.motor[i], &to = drum.motor[i + 1];
      const double change = R * (to.value - from.value) / (to.time - from.time);
      double left = std::min(t, to.time) - from.time, slip = R * from.value - v;
      const double until =
          slip * change < 0.0 ? slip / ((slip > 0.0 ? a : -a) - change) : infinity;  // s, to rest
      const auto pass = [&](double time, double rate) {
        way += (v + 0.5 * rate * time) * time;
        v += rate * time;
      };
      const double first = std::min(left, until);
      pass(first, slip > 0.0 ? a : -a);
      pass(left - first, change > 0.0 ? a : -a);
    }
    return way;
  };
  return known("slip-on-a-drum", "A cable slips to and fro on a drum whose motor swings", scene,
               120, [&](double t, std::size_t b) -> Vec2 {
                 if (b == 0) return Vec2::Zero();
                 const double side = b == 1 ? -1.0 : 1.0;
                 return {side * R, low + side * raised(t)};
               });
}

std::vector<Problem> event_problems() {
  return {bouncing_ball(),      ball_between_walls(), caught_load(),      caught_over_a_peg(),
          two_on_slack_cable(), galileos_peg(),       looping_pendulum(), box_on_a_slope(),
          ball_off_a_table(),   box_off_a_table(),    slip_on_a_drum()};
}

}  // namespace pinchlab::experiments
