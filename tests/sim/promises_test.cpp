// SPDX-License-Identifier: GPL-3.0-or-later
// The watch over what is promised: silent where all is well, exact where something is not.
#include "sim/promises.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/compound.h"
#include "sim/joints.h"
#include "sim/nodes.h"
#include "sim/outline.h"
#include "tests/sim/random_scene.h"

namespace pinchlab::testing {
namespace {

/// Two loads on a wheel, run for `steps`; what is then wrong is for a test to bring in.
struct Watched {
  explicit Watched(Scene s, const Configuration& configuration = {}, int steps = 10)
      : scene(std::move(s)), world(make_world(scene, configuration)), promises(scene, world) {
    for (int i = 0; i < steps; ++i) go();
  }
  void go() {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    promises.note(scene, world);
  }
  [[nodiscard]] std::vector<std::string> broken() const { return promises.broken(scene, world); }

  Scene scene;
  World world;
  Workspace work;
  Promises promises;
};

Scene loads() {
  return load_chain(1, 3.0, 2.0, 1.0);
}

/// A roller that rests on a wrapped wheel between the two loads' cable.
Scene roller_on_wheel() {
  Scene scene = load_chain(1, 2.0, 2.0, 1.0);
  scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, 0.85, 0.25, 1.0));
  return scene;
}

void expect_one(const std::vector<std::string>& lines, const std::string& begin) {
  ASSERT_EQ(lines.size(), 1u) << fmt::format("{}", fmt::join(lines, "\n"));
  EXPECT_TRUE(lines[0].starts_with(begin)) << lines[0];
}

TEST(Promises, AreSilentWhereAllIsWell) {
  for (const int pulleys : {1, 21}) {
    Watched watched(load_chain(pulleys, 3.0, 2.0, 1.0), {}, 240);
    EXPECT_EQ(watched.broken(), std::vector<std::string>());
  }
  Watched slipping(load_chain(3, 3.0, 2.0, 1.0, 0.05), {}, 240);
  EXPECT_EQ(slipping.broken(), std::vector<std::string>());
  Watched pinched(roller_on_wheel(), {}, 240);
  EXPECT_EQ(pinched.broken(), std::vector<std::string>());
}

/// Loads on a cable with mass over a wheel: a square, a pair of discs in one body, or a disc.
Scene massed(int kind) {
  Scene scene;
  const double reach = kind == 1 ? 0.32 : 0.27;
  for (const double side : {-1.0, 1.0}) {
    scene.bodies.push_back(body("load", BodyKind::free, side * reach, -1.0, 0.1, 10.0));
  }
  scene.bodies.push_back(body("wheel", BodyKind::fixed_axle, 0.0, 0.0, 0.25, 2.0));
  if (kind == 0) {
    make_polygon(scene.bodies[2], {{-0.25, -0.25}, {0.25, -0.25}, {0.25, 0.25}, {-0.25, 0.25}},
                 0.0);
  }
  std::vector<Wrap> wraps = {{2, -1, 0}};
  if (kind == 1) {
    std::array<Shape, 2> discs;
    for (Shape& disc : discs) disc.properties.radius = 0.1;
    discs[0].place = {-0.22, 0.0};
    discs[1].place = {0.22, 0.0};
    add_shapes(scene, 2, discs);
    wraps = {{3, -1, 0}, {4, -1, 0}};
  }
  Attachment left = on(0), right = on(1);
  left.point = right.point = {0.0, 0.1};
  scene.cables.push_back(cable(left, wraps, right, 0.02));
  scene.cables[0].mass_per_metre = 0.1;
  return scene;
}

// Sides of polygons are rigid, and what is within one body is as tight as beside it.
TEST(Promises, NothingSagsThatIsHeldWithinABody) {
  for (const int kind : {0, 1, 2}) {
    Watched watched(massed(kind), {}, 60);
    EXPECT_EQ(watched.broken(), std::vector<std::string>()) << kind;
  }
}

// But of a compound's free span the whole is told, once: s / l = rho g l / 8 T, T = (m + rho h) g.
TEST(Promises, WhatSagsBetweenTheShapesOfABodyIsTold) {
  Scene scene;
  for (const double side : {-1.0, 1.0}) {
    scene.bodies.push_back(body("load", BodyKind::free, side * 1.12, -1.0, 0.1, 0.5));
  }
  scene.bodies.push_back(body("wheel", BodyKind::fixed, 0.0, 0.0, 0.25, 2.0));
  std::array<Shape, 2> discs;
  for (Shape& disc : discs) disc.properties.radius = 0.1;
  discs[0].place = {-1.0, 0.0};
  discs[1].place = {1.0, 0.0};
  add_shapes(scene, 2, discs);
  Attachment left = on(0), right = on(1);
  left.point = right.point = {0.0, 0.1};
  scene.cables.push_back(cable(left, {{3, -1, 0}, {4, -1, 0}}, right, 0.02));
  scene.cables[0].mass_per_metre = 1.0;
  const Watched watched(scene, {}, 60);
  const double share = 2.0 / (8.0 * (0.5 + 0.9 / 2.0));
  expect_one(watched.broken(),
             fmt::format("cable 'cable', whose spans have mass and are straight, would have hung "
                         "by {:.1f} % of one's length",
                         100.0 * share));
}

// What a slack span has to spare is what it hangs by: 8 s^2 / 3 l for a sag s.
TEST(Promises, SlackSpansSagByWhatTheyHaveToSpare) {
  Watched watched(massed(2));
  Segment& span = watched.world.cables[0].segments[1];
  span.tension = 0.0;
  span.direction = Vec2(1.0, 0.0);
  const double taut = watched.world.cables[0].length;
  const auto note = [&](double sag) {
    const double spare = span.length * 8.0 / 3.0 * sag * sag;
    span.rest_length = span.length + spare;
    watched.world.cables[0].length = taut + spare;
    watched.promises.note(watched.scene, watched.world);
    return watched.broken();
  };
  EXPECT_EQ(note(0.12), std::vector<std::string>());
  expect_one(note(0.2),
             "cable 'cable', whose spans have mass and are straight, would have hung by 20 %");
}

// At rest without gravity round-off is all the energy that there is.
TEST(Promises, RoundOffIsNoEnergyFromNowhere) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  scene.bodies.push_back(body("load", BodyKind::free, 1.0, 0.0, 0.03, 0.2));
  scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0), 0.01));
  scene.cables[0].slack = 0.3;
  scene.cables[0].mass_per_metre = 1.0;
  scene.cables[0].nodes = 11;
  spread_nodes(scene);
  Watched watched(scene, {}, 240);
  EXPECT_EQ(watched.broken(), std::vector<std::string>());
}

/// Bodies at rest on a rope whose nodes hang, without gravity.
Scene strung_at_rest() {
  Scene scene;
  scene.gravity = Vec2::Zero();
  scene.bodies = {body("a", BodyKind::free, -0.7, 0.0, 0.1),
                  body("b", BodyKind::free, 0.7, 0.0, 0.1),
                  body("c", BodyKind::free, 0.0, 0.8, 0.2)};
  scene.cables.push_back(cable(on(0), {{2, -1, 0}}, on(1), 0.01));
  scene.cables[0].mass_per_metre = 0.4;
  scene.cables[0].nodes = 7;
  spread_nodes(scene);
  return scene;
}

// Lengths are right to 1e-12 of the extent, and light nodes fast by that.
TEST(Promises, NodesAtRestHaveNoEnergyFromNowhere) {
  Watched watched(strung_at_rest(), {}, 120);
  EXPECT_EQ(watched.broken(), std::vector<std::string>());
}

// Steps that events divide end with velocities of another time than the rest: a body that falls
// past one that bounces has gained nothing, be it alone or in one part with the other, by a cable
// that is never taut.
TEST(Promises, AreSilentBesideEvents) {
  for (const bool tied : {false, true}) {
    for (const int steps : {1, 2, 4}) {
      Scene scene;
      scene.bodies = {body("bounces", BodyKind::free, 0.0, 0.2, 0.1, 1e-3),
                      body("falls", BodyKind::free, 1.0, 5.0, 0.1)};
      scene.bodies[0].restitution = 1.0;
      scene.walls.resize(1);
      scene.walls[0].a = Vec2(-0.5, 0.0);
      scene.walls[0].b = Vec2(0.5, 0.0);
      if (tied) {
        scene.cables.push_back(cable(on(0), {}, on(1), 0.01));
        scene.cables[0].slack = 60.0;
      }
      scene.frames_per_second = 30;
      scene.steps_per_frame = steps;
      Watched watched(scene, {}, 60 * steps);
      EXPECT_EQ(watched.broken(), std::vector<std::string>()) << tied << ' ' << steps;
      EXPECT_GT(watched.world.diagnostics.events, 4);
    }
  }
}

TEST(Promises, DoNotChangeTheWorld) {
  const Scene scene = random_scene(6);
  World alone = make_world(scene, Method::pinch);
  run(scene, alone, 300);
  const Watched watched(scene, {}, 300);
  EXPECT_EQ(alone.position, watched.world.position);
  EXPECT_EQ(alone.angle, watched.world.angle);
}

TEST(Promises, NameTheCableThatIsStretched) {
  Watched watched(loads());
  const double too_much = 0.02 * watched.world.cables[0].length;
  watched.world.cables[0].segments[1].length += too_much;
  watched.promises.note(watched.scene, watched.world);
  expect_one(
      watched.broken(),
      "cable 'cable' was stretched by 2 % of its length (limit 0.1 %): first in step 10 (t = "
      "0.0416667 s), in 1 of 10 steps");
  watched.world.cables[0].segments[1].length -= too_much;
  watched.world.stamp = 0;  // changed by hand
  watched.go();
  EXPECT_EQ(watched.broken().size(), 1u);
}

TEST(Promises, TellTheFirstAndTheWorst) {
  Watched watched(loads());
  Segment& segment = watched.world.cables[0].segments[1];
  const double length = segment.length;
  for (const double strain : {0.01, 0.05, 0.0, 0.03}) {
    ++watched.world.step;
    segment.length = length + strain * watched.world.cables[0].length;
    watched.promises.note(watched.scene, watched.world);
  }
  expect_one(
      watched.broken(),
      "cable 'cable' was stretched by 5 % of its length (limit 0.1 %): first in step 11 (t = "
      "0.0458333 s), in 3 of 14 steps, most at t = 0.05 s");
}

TEST(Promises, NameTheCableThatLosesLength) {
  Watched watched(loads());
  watched.world.cables[0].length *= 1.01;
  watched.promises.note(watched.scene, watched.world);
  expect_one(watched.broken(),
             "cable 'cable' lost or gained 0.99 % of its length (limit 0.0001 %)");
}

TEST(Promises, NameTheBodiesThatSqueezeACable) {
  Watched watched(roller_on_wheel(), {}, 60);
  ASSERT_EQ(watched.world.contacts.size(), 1u);
  watched.world.contacts[0].gap -= 0.5 * watched.world.contacts[0].target;
  watched.promises.note(watched.scene, watched.world);
  expect_one(watched.broken(), "body 'pulley 0' and body 'roller' came too near by 50 %");
  // Without contact rows, bodies are free to.
  Watched free(roller_on_wheel(), Method::pinch_no_contact, 60);
  for (Contact& contact : free.world.contacts) contact.gap -= 1.0;
  free.promises.note(free.scene, free.world);
  EXPECT_EQ(free.broken(), std::vector<std::string>());
}

TEST(Promises, NoticeEnergyFromNowhere) {
  const auto broken_after_a_kick = [](const Scene& scene) {
    Watched watched(scene, {}, 60);
    for (Vec2& velocity : watched.world.velocity) velocity *= 1.5;
    watched.world.angular_velocity[2] *= 1.5;
    watched.world.stamp = 0;  // changed by hand
    watched.go();
    watched.go();
    return watched.broken();
  };
  expect_one(broken_after_a_kick(loads()), "body 'left' and what has acted on it gained ");
  Scene driven = loads();
  driven.bodies[2].torque = 1e-9;
  EXPECT_EQ(broken_after_a_kick(driven), std::vector<std::string>());
}

TEST(Promises, NoticeEnergyThatGoesNowhere) {
  const auto broken_when_braked = [](const Scene& scene) {
    Watched watched(scene, {}, 200);
    for (Vec2& velocity : watched.world.velocity) velocity *= 0.1;
    watched.world.angular_velocity[2] *= 0.1;
    watched.world.stamp = 0;  // changed by hand
    watched.go();
    watched.go();
    return watched.broken();
  };
  expect_one(broken_when_braked(loads()), "body 'left' and what has acted on it lost ");
  // It may be where something takes energy.
  Scene dragged = loads();
  dragged.bodies[0].linear_drag = 1e-9;
  EXPECT_EQ(broken_when_braked(dragged), std::vector<std::string>());
  Scene slipping = loads();
  slipping.bodies[2].cable_friction = 0.01;
  EXPECT_EQ(broken_when_braked(slipping), std::vector<std::string>());
  slipping.bodies[2].cable_friction = 0.0;  // smooth
  expect_one(broken_when_braked(slipping), "body 'left' and what has acted on it lost ");
}

// A rod that whips a crank which is nearly without inertia through its dead centre, in next to no
// time: at one step a frame more than half of the energy is lost on the way.
TEST(Promises, NoticeALightCranksLossAtItsDeadCentre) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  const double angle = 0.5, pin = 0.3, rod = 1.0, turning = 5.0;
  const Vec2 at_pin = pin * Vec2(std::cos(angle), std::sin(angle));
  const double x = at_pin.x() + std::sqrt(rod * rod - at_pin.y() * at_pin.y());
  scene.bodies.push_back(body("crank", BodyKind::fixed_axle, 0.0, 0.0, 0.02, 1.0));
  scene.bodies.push_back(body("slider", BodyKind::rail, x, 0.0, 0.01, 2.0));
  scene.bodies[0].angular_velocity = turning;
  scene.bodies[1].rail_axis = Vec2(1.0, 0.0);
  scene.bodies[1].velocity.x() = -turning * x * at_pin.y() / (x - at_pin.x());
  add_bar(scene, "rod", {0, at_pin}, {1, Vec2::Zero()});
  for (const int steps : {1, 16}) {
    scene.steps_per_frame = steps;
    Watched watched(scene, {}, 60 * steps);
    if (steps == 1) {
      expect_one(watched.broken(), "body 'crank' and what has acted on it lost ");
    } else {
      EXPECT_EQ(watched.broken(), std::vector<std::string>());
    }
  }
}

// What has never acted on others does not hide what these gain, whether much is at play in it or
// something drives it, nor whether it divides steps by bouncing.
TEST(Promises, EnergyIsWatchedByWhatActsOnOneAnother) {
  Scene scene = loads();
  const auto own = scene.bodies.size();
  scene.bodies.push_back(body("heavy", BodyKind::free, 50.0, 0.0, 1.0, 1e6));
  scene.bodies.push_back(body("driven", BodyKind::fixed_axle, 60.0, 0.0, 1.0));
  scene.bodies.back().torque = 1.0;
  scene.bodies.push_back(body("bounces", BodyKind::free, 70.0, 0.11, 0.1));
  scene.bodies.back().restitution = 1.0;
  scene.walls = {{Vec2(69.0, 0.0), Vec2(71.0, 0.0), 0.0, 1.0}};
  Watched watched(scene, {}, 60);
  EXPECT_EQ(watched.broken(), std::vector<std::string>());
  for (std::size_t b = 0; b < own; ++b) {
    watched.world.velocity[b] *= 1.5;
    watched.world.angular_velocity[b] *= 1.5;
  }
  watched.world.stamp = 0;  // changed by hand
  for (int i = 0; i < 2; ++i) watched.go();
  expect_one(watched.broken(), "body 'left' and what has acted on it gained ");
}

// A body beside a cable whose links have come and gone may have met it for less than a step: what
// the cable's bodies have gained may be what that has lost.
TEST(Promises, WhatMayHaveMetWithinAStepActsOnOneAnother) {
  for (const bool is_near : {true, false}) {
    Scene scene = loads();
    const auto ball = scene.bodies.size();
    const double beside = is_near ? 0.28 : 5.0;
    const double x = scene.bodies[0].position.x() - beside;
    scene.bodies.push_back(body("ball", BodyKind::free, x, -1.0, 0.2, 3.0));
    Watched watched(scene, {}, 60);
    ASSERT_EQ(watched.world.contacts.size(), 0u);
    for (std::size_t b = 0; b < ball; ++b) {
      watched.world.velocity[b] *= 1.5;
      watched.world.angular_velocity[b] *= 1.5;
    }
    watched.world.velocity[ball] *= 0.5;
    watched.world.cables[0].changes += 2;
    watched.world.stamp = 0;  // changed by hand
    for (int i = 0; i < 2; ++i) watched.go();
    if (is_near) {
      EXPECT_EQ(watched.broken(), std::vector<std::string>());
    } else {
      expect_one(watched.broken(), "body 'left' and what has acted on it gained ");
    }
  }
}

TEST(Promises, CountFallbacks) {
  Watched watched(loads());
  watched.world.diagnostics.fallbacks += 2;  // in two parts of one step
  watched.promises.note(watched.scene, watched.world);
  watched.go();
  expect_one(
      watched.broken(),
      "the solver did not settle and took its fallback, or no repair met what was too long or "
      "too near: first in step 10");
}

TEST(Promises, NoticeWhatIsNotFinite) {
  Watched watched(loads());
  watched.world.cables[0].segments[1].length = std::nan("");
  watched.promises.note(watched.scene, watched.world);
  expect_one(watched.broken(), "cable 'cable' was stretched by nan %");
}

// Weights of 1e10 kg on a wheel of a gram, which one solution holds and sweeps let fall: whatever
// is not as it should be is told, of every method.
TEST(Promises, NothingFallsUnnoticedWhateverTheMasses) {
  const Scene scene = load_chain(1, 1e10, 1e10, 1e-3);
  for (const Configuration& method :
       {Configuration(Method::pinch), Configuration(Method::pinch_no_contact),
        Configuration(Method::cable), thesis_configuration()}) {
    Watched watched(scene, method, 240);
    const double fallen = scene.bodies[0].position.y() - watched.world.position[0].y();  // m
    EXPECT_TRUE(std::abs(fallen) < 1e-6 || !watched.broken().empty())
        << to_string(method) << " " << fallen;
  }
  Watched thesis(scene, thesis_configuration(), 240);
  expect_one(thesis.broken(), "cable 'cable' was stretched by ");
  EXPECT_NE(thesis.broken()[0].find("(limit 5 %)"), std::string::npos) << thesis.broken()[0];
}

// A ball that flies to and fro between two walls, which divides every step. What it has gained by
// another hand is told all the same.
TEST(Promises, EnergyIsWatchedThroughDividedSteps) {
  Scene scene;
  Body ball = body("ball", BodyKind::free, 0.5, 0.0, 0.1, 1.0);
  ball.velocity = {100.0, 0.0};
  ball.restitution = 1.0;
  scene.bodies.push_back(ball);
  scene.walls = {{Vec2(0.0, -9.0), Vec2(0.0, 9.0), 1.0, 0.0},
                 {Vec2(1.0, -9.0), Vec2(1.0, 9.0), 1.0, 0.0}};
  scene.steps_per_frame = 1;
  Watched watched(scene, {}, 60);
  EXPECT_GT(watched.world.diagnostics.intervals, 120);
  EXPECT_EQ(watched.broken(), std::vector<std::string>());
  watched.world.velocity[0] *= 2.0;
  for (int i = 0; i < 5; ++i) watched.go();
  expect_one(watched.broken(), "body 'ball' and what has acted on it gained ");
}

// Sweeps promise little, elastic cables may stretch.
TEST(Promises, DependOnWhatIsSimulated) {
  Scene elastic = loads();
  elastic.cables[0].axial_stiffness = 100.0;
  Watched watched(elastic, {}, 240);
  EXPECT_GT(
      watched.world.cables[0].segments[1].length - watched.world.cables[0].segments[1].rest_length,
      0.1);
  EXPECT_EQ(watched.broken(), std::vector<std::string>());
  Watched thesis(load_chain(21, 100.0, 1.0, 1.0), thesis_configuration(), 240);
  EXPECT_EQ(thesis.broken(), std::vector<std::string>());
}

}  // namespace
}  // namespace pinchlab::testing
