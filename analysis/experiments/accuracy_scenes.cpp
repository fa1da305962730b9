// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/accuracy_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "analysis/experiments/references.h"
#include "demos/scenes/build.h"
#include "demos/scenes/shape_scenes.h"
#include "sim/nodes.h"

namespace pinchlab::experiments {

namespace {

constexpr double g = 9.81;  // m/s^2
using build::body;
using build::cable;
using build::load_chain;
using build::pulley_radius;
constexpr double half_width = build::cable_half_width;  // m
constexpr double R = pulley_radius + half_width;        // m, to the cable's centre line

/// I/R^2 (kg) of a disc that carries a cable.
double pulley_share(const Body& pulley) {
  return inertia_of(pulley) / (R * R);
}

/// Fills `exact` with what `place` says of the time (s) and the body's index.
void set_exact(Problem& problem, const std::function<Place(double, std::size_t)>& place) {
  for (int frame = 0; frame <= problem.frames; ++frame) {
    std::vector<Place>& places = problem.exact.emplace_back();
    for (const std::size_t b : problem.watched) {
      places.push_back(place(static_cast<double>(frame) / problem.scene.frames_per_second, b));
    }
  }
}

/// Loads 0 and 1 of `scene` in uniform acceleration a (m/s^2), load 1 downwards.
Problem uniformly_accelerated(const std::string& name, const std::string& title, Scene scene,
                              double a) {
  Problem problem;
  problem.name = name;
  problem.title = title;
  problem.scene = std::move(scene);
  problem.watched = {0, 1};
  problem.reference = "closed form";
  set_exact(problem, [&](double t, std::size_t b) {
    const double down = (b == 1 ? 0.5 : -0.5) * a * t * t;
    return Place{problem.scene.bodies[b].position - Vec2(0.0, down), 0.0};
  });
  problem.length_m = reach(problem.exact, false);
  problem.length = "the way of the loads";
  return problem;
}

/// Everything stays where it is.
void stay(Problem& problem) {
  set_exact(problem, [&](double, std::size_t b) {
    return Place{problem.scene.bodies[b].position, 0.0};
  });
  problem.reference = "closed form: nothing moves";
}

}  // namespace

Problem atwood() {
  const Scene scene = load_chain(1, 1.0, 3.0, 2.0);
  return uniformly_accelerated("atwood", "Atwood machine", scene,
                               atwood_acceleration(1.0, 3.0, pulley_share(scene.bodies[2]), g));
}

Problem slipping_atwood() {
  constexpr double mu = 0.05;
  Scene scene = load_chain(1, 1.0, 3.0, 2.0);
  scene.bodies[2].cable_friction = mu;
  const double k = std::exp(mu * std::numbers::pi);
  return uniformly_accelerated("slipping-atwood", "Slipping Atwood machine", scene,
                               slipping_atwood_acceleration(1.0, 3.0, k, g));
}

Problem pulley_chain() {
  constexpr int pulleys = 81;
  const Scene scene = load_chain(pulleys, 1000.0, 999.0, 0.1);
  const double share = pulleys * pulley_share(scene.bodies[2]);
  return uniformly_accelerated("pulley-chain", "1000 and 999 kg over 81 light pulleys", scene,
                               atwood_acceleration(1000.0, 999.0, share, g));
}

Problem swinging_load() {
  Problem problem;
  problem.name = "swinging-load";
  problem.title = "Swinging load over two heavy pulleys";
  problem.frames = 120;
  problem.watched = {0, 1};
  const SwingingLoad swing{R, 1.0, 1.2, 0.0, g};
  const State start{0.6, 0.0, 2.5 - R * 0.6, 0.0};  // theta, theta', q = l - R theta, q'
  Scene& scene = problem.scene;
  Vec2 bob;
  swing.place(start, bob.x(), bob.y());
  constexpr double spacing = 3.0, hanging = -2.5;
  scene.bodies.push_back(body("bob", BodyKind::free, bob, 0.1, swing.mass));
  scene.bodies.push_back(body("load", BodyKind::free, {spacing + R, hanging}, 0.1, swing.load));
  for (const double x : {0.0, spacing}) {
    scene.bodies.push_back(body(x > 0.0 ? "second pulley" : "first pulley", BodyKind::fixed_axle,
                                {x, 0.0}, pulley_radius, 4.0));
  }
  scene.cables.push_back(cable(build::on(0), {{2, -1, 0}, {3, -1, 0}}, build::on(1)));
  SwingingLoad with_pulleys = swing;
  with_pulleys.pulleys = pulley_share(scene.bodies[2]) + pulley_share(scene.bodies[3]);
  const std::vector<State> states =
      integrate([&](const State& y) { return with_pulleys.derivative(y); }, start,
                1.0 / scene.frames_per_second, problem.frames);
  for (const State& y : states) {
    with_pulleys.place(y, bob.x(), bob.y());
    // What comes over the pulleys on one side goes on the other.
    problem.exact.push_back(
        {Place{bob, 0.0}, Place{Vec2(spacing + R, hanging + (y[2] - start[2])), 0.0}});
  }
  problem.reference = "two equations of motion, integrated by GSL to 1e-13 a step";
  problem.doubt_m = 1e-11;
  problem.length_m = reach(problem.exact, false);
  problem.length = "the farthest that a load gets from its start";
  return problem;
}

Problem roller_on_drum() {
  constexpr double roller_radius = 0.25, start = 0.05, push = 0.8;  // m, rad, rad/s
  constexpr double D = pulley_radius + roller_radius + 2.0 * half_width;
  constexpr double R2 = roller_radius + half_width;
  const RollerOnDrum roller{D, 0.5 * roller_radius * roller_radius / (R2 * R2), g};
  Problem problem;
  problem.name = "roller-on-drum";
  problem.title = "Roller over a wrapped drum, pinched throughout";
  problem.frames = 30;
  problem.watched = {1};
  Scene& scene = problem.scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed, Vec2::Zero(), pulley_radius, 1.0));
  Body b = body("roller", BodyKind::free, D * Vec2(-std::sin(start), std::cos(start)),
                roller_radius, 1.0);
  b.velocity = D * push * Vec2(std::cos(start), std::sin(start));
  b.angular_velocity = -D * push / R2;
  scene.bodies.push_back(b);
  scene.cables.push_back(cable(build::at(-2.0, -1.0), {{0, -1, 0}}, build::at(2.0, -1.0)));
  for (const State& y : integrate([&](const State& s) { return roller.derivative(s); },
                                  {-start, push}, 1.0 / scene.frames_per_second, problem.frames)) {
    problem.exact.push_back({Place{D * Vec2(std::sin(y[0]), std::cos(y[0])), 0.0}});
  }
  problem.reference = "the equation of motion, integrated by GSL to 1e-13 a step";
  problem.doubt_m = 1e-12;
  problem.length_m = reach(problem.exact, false);
  problem.length = "the farthest that the roller gets from its start";
  return problem;
}

Problem resting_stack() {
  constexpr double big = 0.32767, small = 0.163835, x = 47.703;  // m; thesis Figure 3.2
  const Vec2 axle(47.7, 9.096);
  Problem problem;
  problem.name = "resting-stack";
  problem.title = "Four pinched pulleys on a wrapped one, at rest";
  problem.frames = 120;
  Scene& scene = problem.scene;
  scene.bodies.push_back(
      body("weight", BodyKind::free, axle + Vec2(-big - half_width, -1.0), 0.2, 1.0));
  scene.bodies.push_back(body("big", BodyKind::fixed_axle, axle, big, 10.0));
  std::vector<Wrap> wraps{{1, -1, 0}};
  const double touching = big + small + 2.0 * half_width;
  double y = axle.y() + std::sqrt(touching * touching - (x - axle.x()) * (x - axle.x()));
  for (int i = 0; i < 4; ++i) {
    scene.bodies.push_back(
        body(fmt::format("small {}", i + 1), BodyKind::rail, {x, y}, small, 1.0));
    wraps.push_back({2 + i, i % 2 == 0 ? 1 : -1, 0});
    y += 2.0 * small + 2.0 * half_width;
  }
  scene.cables.push_back(cable(build::on(0), wraps, build::at(49.9, 10.505)));
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) problem.watched.push_back(b);
  stay(problem);
  problem.length_m = half_width;
  problem.length = "the cable's half width";
  return problem;
}

Problem hanging_load() {
  constexpr double length = 2.0;
  Problem problem;
  problem.name = "hanging-load";
  problem.title = "100 kg on a cable, at rest";
  problem.frames = 120;
  problem.watched = {0};
  problem.scene.bodies.push_back(body("load", BodyKind::free, {0.0, -length}, 0.2, 100.0));
  problem.scene.cables.push_back(cable(build::at(0.0, 0.0), {}, build::on(0)));
  stay(problem);
  problem.length_m = length;
  problem.length = "the cable's length";
  return problem;
}

Problem rope_atwood() {
  Problem problem;
  problem.name = "rope-atwood";
  problem.title = "Atwood's machine with a heavy rope";
  problem.scene = build::rope_atwood(4);
  problem.watched = {0, 1};
  problem.reference = "closed form";
  const double k = std::sqrt(0.8 * g / 4.35);  // 1/s
  set_exact(problem, [&](double t, std::size_t b) {
    const double down = (b == 1 ? 0.625 : -0.625) * (std::cosh(k * t) - 1.0);
    return Place{problem.scene.bodies[b].position - Vec2(0.0, down), 0.0};
  });
  problem.length_m = reach(problem.exact, false);
  problem.length = "the way of the weights";
  return problem;
}

Problem square_unwinding() {
  const build::SquareDrum drum;
  Problem problem;
  problem.name = "square-unwinding";
  problem.title = "A bob whose cable unwinds from a square";
  problem.scene = drum.scene(4);
  problem.frames = 72;
  problem.watched = {1};
  problem.reference = "independent equations of motion, Runge and Kutta's method";
  set_exact(problem, [&](double t, std::size_t) { return Place{drum.bob_after(t), 0.0}; });
  problem.length_m = reach(problem.exact, false);
  problem.length = "the farthest that the bob gets from its start";
  return problem;
}

Problem hanging_cable() {
  Problem problem;
  problem.name = "hanging-cable";
  problem.title = "A cable with mass that hangs at rest";
  problem.scene = build::catenary(50, 4);
  spread_nodes(problem.scene);
  for (std::size_t b = 0; b < problem.scene.bodies.size(); ++b) problem.watched.push_back(b);
  problem.length_m = 2.0;
  problem.length = "the cable's length";
  stay(problem);
  return problem;
}

std::vector<Problem> known_problems() {
  return {atwood(),        slipping_atwood(), pulley_chain(), swinging_load(),    roller_on_drum(),
          resting_stack(), hanging_load(),    rope_atwood(),  square_unwinding(), hanging_cable()};
}

std::vector<Problem> finely_solved_problems(int steps_per_frame) {
  const auto solved = [=](const char* name, const char* title, Scene scene, double seconds) {
    scene.title = title;
    return own_solution(name, scene, seconds, steps_per_frame);
  };
  const std::vector<Vec2> square = build::box_corners(0.6, 0.6);
  return {
      solved("square-turning", "A square drum turns under a bob",
             build::turning_drum(square, 2.5, 4), 1.6),
      solved("layered-drum", "A load on a drum in layers", build::layered_hoist(8, 0.02, 4), 1.0),
      solved("heavy-tackle", "A tackle with a heavy rope swings", build::heavy_tackle(4), 0.4),
      solved("creeping-belt", "A belt creeps over its pulleys",
             build::belt_drive(0.35, 150.0, 101.0, 4), 1.0),
      solved("folded-chain", "A folded chain of 20 pieces is let go", build::folded_chain(20, 4),
             0.3),
      // As few pieces as bend no faster than one step a frame follows.
      solved("flexible-pendulum", "A flexible pendulum of 6 pieces is let go level",
             build::flexible_pendulum(6, 1), 1.0)};
}

Problem own_solution(const std::string& name, const Scene& scene, double seconds,
                     int steps_per_frame, const std::function<void(const World&)>& on_steps) {
  Problem problem;
  problem.on_steps = on_steps;
  problem.name = name;
  problem.title = scene.title.empty() ? name : scene.title;
  problem.scene = scene;
  problem.frames = std::max(1, static_cast<int>(std::lround(seconds * scene.frames_per_second)));
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) problem.watched.push_back(b);
  problem.rims = true;
  solve_finely(problem, steps_per_frame);
  problem.reference =
      fmt::format("the scene's own solution (pinch direct) at {} steps a frame", steps_per_frame);
  problem.length_m = reach(problem.exact, true);
  problem.length = "the farthest that a centre or rim gets from its start";
  return problem;
}

}  // namespace pinchlab::experiments
