// SPDX-License-Identifier: GPL-3.0-or-later
// Cables with mass: chains of nodes.

#include "sim/nodes.h"

#include <array>
#include <cmath>
#include <numbers>

#include "base/at.h"
#include "demos/scenes/shape_scenes.h"
#include "sim/scene_error.h"
#include "tests/sim/random.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using build::catenary;
using build::folded_chain;

double sag_of(const World& world) {
  double lowest = 0.0;
  for (const Vec2& position : world.position) lowest = std::min(lowest, position.y());
  return -lowest;
}

// Sags of the lumped chain of N pieces; the catenary's is 0.7963884, its tension at the end
// 1.0260286 rho g. The first piece bears all of that but for half a piece's weight.
TEST(Nodes, StartWhereTheChainHangs) {
  for (const auto& [pieces, sag] : {std::pair(20, 0.798273), {50, 0.796685}, {100, 0.796462}}) {
    Scene scene = catenary(pieces, 1);
    spread_nodes(scene);
    EXPECT_EQ(scene.bodies.size(), static_cast<std::size_t>(pieces) - 1);
    World world = make_world(scene, measured());
    EXPECT_NEAR(sag_of(world), sag, 1e-6) << pieces;
    const std::vector<Vec2> start = world.position;
    run(scene, world, 60);
    for (std::size_t b = 0; b < start.size(); ++b) {
      EXPECT_LT((world.position[b] - start[b]).norm(), 1e-7) << b;
    }
    const Segment& first = world.cables[0].segments[1];
    const Vec2 end = first.tension * -first.direction + Vec2(0.0, g / pieces);
    EXPECT_NEAR(end.norm() / g, 1.0260286, 0.5 / (pieces * pieces));
  }
}

TEST(Nodes, AreAsManyAsStepsCanFollow) {
  for (const int steps : {1, 2, 4, 8, 16}) {
    Scene scene = catenary(0, steps);
    const std::vector<NodedCable> made = spread_nodes(scene);
    ASSERT_EQ(made.size(), 1U);
    // A piece no shorter than h sqrt(2 T / rho), of the tension with which the catenary hangs; an
    // even number of them, so that the lowest place is a node.
    const int most = static_cast<int>(2.0 * (60.0 * steps) / std::sqrt(2.0 * 1.0260286 * g));
    const int n = made[0].bodies + 1;
    EXPECT_EQ(n, std::min(most, most_nodes_chosen + 1) / 2 * 2) << steps;
    // Of a chain of n pieces the sag is 0.74 / n^2 more: within 1e-4 of it from 4 steps a frame on.
    World world = make_world(scene, measured());
    const double sag = sag_of(world);
    EXPECT_NEAR(sag, 0.7963884 + 0.74 / (n * n), 8.0 / std::pow(n, 4) + 1e-7) << steps;
    if (steps >= 4) {
      EXPECT_NEAR(sag, 0.7963884, 1e-4 * 0.7963884) << steps;
    }
    run(scene, world, 20 * steps);  // and none is divided, before they fall asleep
    EXPECT_NEAR(sag_of(world), sag, 1e-7) << steps;
    EXPECT_EQ(world.diagnostics.intervals, 20 * steps);
  }
}

/// A chain of 1 m and 1 kg that hangs from one end, of N equal pieces with equal masses. Small
/// swings have omega^2 = g / l times the zeros x of the Laguerre polynomial L_N, and along the k-th
/// mass from the free end the shape L_k(x).
struct SwingingChain {
  static constexpr int pieces = 10;
  static constexpr double amplitude = 1e-6;  // m, whose square shifts frequencies
  Scene scene;
  std::vector<double> mode{1.0};  // from the free end
  double omega = 0.0;             // rad/s

  SwingingChain(double zero, int steps_per_frame) : omega(std::sqrt(g * pieces * zero)) {
    mode.push_back(1.0 - zero);
    for (int k = 1; k + 1 <= pieces; ++k) {
      mode.push_back(((2.0 * k + 1.0 - zero) * mode[index(k)] - k * mode[index(k - 1)]) /
                     (k + 1.0));
    }
    scene.steps_per_frame = steps_per_frame;
    scene.bodies.push_back(body("tip", BodyKind::free, 0.0, -1.0, 0.002, 0.1));
    scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0), 0.002));
    scene.cables[0].mass_per_metre = 1.0;
    scene.cables[0].nodes = pieces - 1;
    spread_nodes(scene);
    for (int k = 0; k < pieces; ++k) {
      Body& b = scene.bodies[index(body_of(k))];
      b.mass = 0.1;
      b.position = {amplitude * mode[index(k)], -1.0 * (pieces - k) / pieces};
    }
  }

  /// Of the k-th mass: the tip, then the nodes from the top down.
  static int body_of(int k) { return k == 0 ? 0 : pieces - k; }

  /// How much of the shape there is.
  double swing(const World& world) const {
    double sum = 0.0, square = 0.0;
    for (int k = 0; k < pieces; ++k) {
      sum += mode[index(k)] * world.position[index(body_of(k))].x();
      square += mode[index(k)] * mode[index(k)];
    }
    return sum / (square * amplitude);
  }
};

// Leapfrog swings with sin(omega' h / 2) = omega h / 2. Its q(n + m) + q(n - m) = 2 cos(m omega' h)
// q(n) tells the frequency, as a mean over n and with m of some ten periods.
TEST(Nodes, HangingChainSwingsAsItShould) {
  for (const double zero : {0.137793470540, 0.729454549503, 1.808342901740}) {
    for (const int steps_per_frame : {4, 16}) {
      const SwingingChain chain(zero, steps_per_frame);
      World world = make_world(chain.scene, Method::pinch);
      const double h = world.step_length;
      const double expected = 2.0 * std::asin(0.5 * chain.omega * h) / h;
      const int apart =
          static_cast<int>(std::lround(10.25 * 2.0 * std::numbers::pi / expected / h));
      std::vector<double> swings{chain.swing(world)};
      for (int i = 0; i < 3 * apart; ++i) {
        run(chain.scene, world, 1);
        swings.push_back(chain.swing(world));
      }
      double product = 0.0, square = 0.0;
      for (int n = apart; n + apart <= 3 * apart; ++n) {
        product += swings[index(n)] * (swings[index(n + apart)] + swings[index(n - apart)]);
        square += 2.0 * swings[index(n)] * swings[index(n)];
      }
      // The angle is near 10.25 turns, where its cosine is near 0 and falls.
      const double angle = 10.25 * 2.0 * std::numbers::pi + std::asin(-product / square);
      EXPECT_NEAR(angle / (apart * h), expected, 1e-8 * expected) << zero << ' ' << steps_per_frame;
    }
  }
}

// It falls faster than freely: in 0.847213 sqrt(2 L / g) if no energy is lost (Calkin & March
// 1989). The lumped chain differs from that as 1 / N.
TEST(Nodes, FoldedChainFallsFasterThanFreely) {
  const double unit = std::sqrt(2.0 / g);
  for (const int pieces : {20, 50, 100}) {
    const Scene scene = folded_chain(pieces, 64);
    World world = make_world(scene, measured());
    Workspace work;
    double start = 0.0, most = 0.0;
    for (int i = 0; world.step == 0 || world.velocity[0].y() < 0.0; ++i) {
      ASSERT_LT(i, 64 * 60);
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      if (i == 0) start = world.diagnostics.energy;
      most = std::max(most, world.diagnostics.energy - start);
      EXPECT_LT(world.diagnostics.largest_stretch, 1e-10);
    }
    EXPECT_NEAR(world.time() / unit, 0.847213 + 3.6 / pieces, 0.5 / pieces) << pieces;
    EXPECT_LT(most, 1e-6);
    EXPECT_EQ(world.diagnostics.fallbacks, 0);
  }
}

// A cable that is let go at one end falls over a post and on to the floor, and keeps out of both.
TEST(Nodes, LieOnFloorsAndBodies) {
  Scene scene;
  scene.bodies.push_back(body("post", BodyKind::fixed, 0.0, 0.0, 0.3));
  scene.bodies.push_back(body("tip", BodyKind::free, 0.9, 0.45, 0.03, 0.05));
  scene.cables.push_back(cable(at(-0.6, 0.45), {}, on(1), 0.02));
  scene.cables[0].mass_per_metre = 0.5;
  scene.walls.push_back({{-3.0, -0.5}, {3.0, -0.5}, 0.5, 0.0});
  scene.error = 1e-3;
  spread_nodes(scene);
  World world = make_world(scene, measured());
  Workspace work;
  double start = 0.0;
  for (int i = 0; i < 60 * scene.steps_per_frame * 4; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    const Diagnostics& d = world.diagnostics;
    if (i == 0) start = d.energy;
    ASSERT_LT(d.energy, start + 1e-4);
    ASSERT_LT(d.largest_stretch, 1e-6);
    ASSERT_LT(d.largest_gap_violation, 1e-6);
  }
  EXPECT_LT(world.position[1].y(), -0.3);
}

/// Its tip after each of the times (s), and what its energy has changed by at most: on ways that
/// turn leapfrog's falls by the square of the step, of rods that do not stretch as of these, and
/// comes back.
std::vector<Vec2> swing_flexibly(int pieces, int steps, std::vector<double> times,
                                 double& energy_change) {
  const Scene scene = build::flexible_pendulum(pieces, steps);
  World world = make_world(scene, measured());
  Workspace work;
  std::vector<Vec2> tips;
  double first = 0.0;
  energy_change = 0.0;
  for (const double time : times) {
    while (world.time() < time - 0.5 * world.step_length) {
      EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      if (world.step == 1) first = world.diagnostics.energy;
      EXPECT_LT(world.diagnostics.energy, first + 1e-9);
      energy_change = std::max(energy_change, std::abs(world.diagnostics.energy - first));
    }
    tips.push_back(world.position[0]);
  }
  return tips;
}

// Another program's rod of so many pieces, by Runge and Kutta's method, and the authors' own finite
// elements (Westin and Irani's code, 10 elements), which rods tend to.
TEST(Nodes, AFlexiblePendulumSwingsAsOthersDo) {
  double change = 0.0;
  const Vec2 twenty = swing_flexibly(20, 64, {1.0}, change)[0];
  EXPECT_LT((twenty - Vec2(-0.99252, 0.04257)).norm(), 1e-5);
  const Vec2 forty = swing_flexibly(40, 64, {1.0}, change)[0];
  EXPECT_LT((forty - Vec2(-0.99371, 0.03954)).norm(), 1e-5);
  EXPECT_LT(change, 1e-6);
  const std::vector<double> times{0.25, 0.5, 0.75, 1.0, 1.5};
  const std::vector<Vec2> elements{{0.911077, -0.364540},
                                   {-0.100075, -0.997990},
                                   {-0.944466, -0.283652},
                                   {-0.994295, 0.037633},
                                   {0.260361, -0.966032}};
  const std::vector<Vec2> tips = swing_flexibly(80, 192, times, change);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_LT((tips[i] - elements[i]).cwiseAbs().maxCoeff(), 1e-3) << times[i];
  }
}

// Second order in the step, at one number of pieces. (At 8 steps a frame these vibrate faster than
// steps can follow; that is damped, and the error is less than its order says.)
TEST(Nodes, BendingIsOfSecondOrder) {
  double change = 0.0;
  const Vec2 exact = swing_flexibly(12, 512, {1.0}, change)[0];
  double last = 0.0, last_change = 0.0;
  for (const int steps : {16, 32, 64, 128}) {
    const double error = (swing_flexibly(12, steps, {1.0}, change)[0] - exact).norm();
    if (last > 0.0) {
      EXPECT_GT(last / error, 3.5) << steps;
      EXPECT_GT(last_change / change, 3.5) << steps;
    }
    last = error;
    last_change = change;
  }
}

TEST(Nodes, RefuseWhatCannotBe) {
  const auto refusal = [](auto change) -> std::string {
    Scene scene = catenary(0, 1);
    change(scene);
    return message_of<SceneError>([&scene] {
      spread_nodes(scene);
      make_world(scene, Method::pinch);
    });
  };
  EXPECT_EQ(refusal([](Scene&) {}), "");
  EXPECT_NE(refusal([](Scene& s) { s.cables[0].nodes = 1000; }).find("at most 499 nodes fit"),
            std::string::npos);
  EXPECT_NE(refusal([](Scene& s) { s.cables[0].mass_per_metre = infinity; }).find("finite"),
            std::string::npos);
  const std::string stiff = refusal([](Scene& s) {
    s.cables[0].bending_stiffness = 10.0;
    s.cables[0].nodes = 100;
  });
  EXPECT_NE(stiff.find("more steps a frame"), std::string::npos) << stiff;
  Scene scene = catenary(0, 1);
  EXPECT_THROW(make_world(scene, Method::pinch), SceneError);  // its nodes were forgotten
}

/// A weight on a cable of 0.5 kg/m from [0, 1], let go at [0.8, 0] with its cable straight.
Scene let_go(double mass, double radius, int nodes, int steps_per_frame) {
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  scene.bodies.push_back(body("bob", BodyKind::free, 0.8, 0.0, radius, mass));
  Attachment rim = on(0);
  rim.point = radius * Vec2(-0.8, 1.0).normalized();
  scene.cables.push_back(cable(at(0.0, 1.0), {}, rim, 0.005));
  scene.cables[0].mass_per_metre = 0.5;
  scene.cables[0].nodes = nodes;
  spread_nodes(scene);
  return scene;
}

// As many nodes as steps can follow under what hangs at the cable: a swing of 2 s by the steps that
// scenes have is that by fine ones, and keeps its energy.
TEST(Nodes, AreAsManyAsStepsCanFollowUnderALoad) {
  for (const auto& [mass, radius] :
       {std::pair(0.5, 0.05), std::pair(2.0, 0.1), {20.0, 0.1}, {200.0, 0.1}}) {
    const Scene fine = let_go(mass, radius, 24, 64);
    World reference = make_world(fine, measured());
    run(fine, reference, 120 * 64);
    const Scene scene = let_go(mass, radius, 0, 4);
    World world = make_world(scene, measured());
    Workspace work;
    double first = 0.0;
    for (int i = 0; i < 120 * 4; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok);
      if (i == 0) first = world.diagnostics.energy;
      ASSERT_LT(std::abs(world.diagnostics.energy - first), 1e-3 * mass) << mass << ", step " << i;
    }
    EXPECT_EQ(world.diagnostics.fallbacks, 0);
    EXPECT_LT((world.position[0] - reference.position[0]).norm(), 6e-3) << mass;
  }
}

// Twice the wave's way in a step, at three times the weight: l = 2 h sqrt(3 (m + rho L) g / rho);
// what hangs below counts, and what the other end would let go of does not.
TEST(Nodes, AreChosenByWhatHangsAtTheCable) {
  const auto pieces = [](Scene scene) { return spread_nodes(scene)[0].pieces + 1; };
  Scene scene;
  scene.bodies.push_back(body("bob", BodyKind::free, 1.5, 0.0, 0.1, 2.0));
  scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0), 0.005));
  scene.cables[0].mass_per_metre = 0.5;
  const auto expected = [](double mass) {
    return static_cast<int>(1.5 / (2.0 / 240.0 * std::sqrt(3.0 * (mass + 0.75) * g / 0.5))) / 2 * 2;
  };
  EXPECT_EQ(pieces(scene), expected(2.0));
  scene.bodies.push_back(body("below", BodyKind::free, 1.5, -1.0, 0.1, 5.0));
  scene.cables.push_back(cable(on(0), {}, on(1), 0.005));
  EXPECT_EQ(pieces(scene), expected(7.0));
  scene.bodies.push_back(body("above", BodyKind::free, 0.0, 0.0, 0.1, 1.0));
  scene.cables[0].start = on(2);  // nothing holds it up
  EXPECT_EQ(pieces(scene), expected(1.0));
}

// Asked for all at once, each cable holds what it holds when it alone is asked for: in nets with
// and without rings, hung up and not.
TEST(Nodes, AreChosenForAllCablesAtOnceAsForEach) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    Random random(seed);
    Scene scene;
    const int count = 2 + random.below(10);
    for (int b = 0; b < count; ++b) {
      const BodyKind kind = random.below(4) > 0 ? BodyKind::free : BodyKind::fixed_axle;
      scene.bodies.push_back(body("", kind, random.uniform(0.0, 9.0), random.uniform(0.0, 9.0), 0.1,
                                  random.uniform(0.1, 100.0)));
    }
    std::vector<std::size_t> all;
    for (int c = random.below(2 * count); c >= 0; --c) {
      const int from = random.below(count), to = random.below(count + 1) - 1;
      if (from == to) continue;
      const Attachment end = to < 0 ? at(0.0, 10.0) : on(to);
      scene.cables.push_back(cable(on(from), {}, end, 0.01));
      if (random.below(3) == 0) continue;
      scene.cables.back().mass_per_metre = random.uniform(0.1, 10.0);
      all.push_back(scene.cables.size() - 1);
    }
    const std::vector<Expected> expected = expected_of(scene, all);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double alone = expected_of(scene, std::array{all[i]}).front().tension;
      EXPECT_NEAR(expected[i].tension, alone, 1e-12 * alone) << seed;
    }
  }
}

// Where nodes adapt an end carries half of a piece at its centre, which adds to its mass, and not
// to its inertia: that of a disc would follow its mass.
TEST(Nodes, WhatAnEndCarriesLeavesItsInertia) {
  Scene scene;
  scene.bodies.push_back(body("end", BodyKind::free, 1.0, 0.0, 0.1, 0.4));
  scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0), 0.005));
  scene.cables[0].slack = 0.1;
  scene.cables[0].mass_per_metre = 2.0;
  scene.cables[0].nodes = 7;
  scene.cables[0].node_tolerance = 0.01;
  spread_nodes(scene);
  EXPECT_NEAR(scene.bodies[0].mass, 0.4 + 2.2 / 16.0, 1e-12);
  EXPECT_DOUBLE_EQ(inertia_of(scene.bodies[0]), 0.5 * 0.4 * 0.1 * 0.1);
}

// The end's default: nodes within the disc are never clear of it.
TEST(Nodes, AWeightIsHeldAtItsCentre) {
  for (const double slack : {0.0, 0.02}) {
    Scene scene;
    scene.bodies.push_back(body("bob", BodyKind::free, 0.3, 0.0, 0.1, 1.0));
    scene.cables.push_back(cable(at(0.0, 1.0), {}, on(0), 0.01));
    scene.cables[0].mass_per_metre = 1.0;
    scene.cables[0].slack = slack;
    spread_nodes(scene);
    World world = make_world(scene, measured());
    run(scene, world, 480);
    EXPECT_EQ(world.diagnostics.fallbacks, 0);
  }
}

// Nodes are in no file: what is wrong with where they start is told of their cable.
TEST(Nodes, ACableThatHangsThroughABodyIsRefusedByName) {
  const auto refused = [](Scene scene, const std::string& words) {
    spread_nodes(scene);
    try {
      make_world(scene, Method::pinch);
      ADD_FAILURE() << words;
    } catch (const SceneError& error) {
      EXPECT_EQ(error.place, "/cables/0");
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  Scene scene;
  scene.cables.push_back(cable(at(-1.0, 0.0), {}, at(1.0, 0.0), 0.01));
  scene.cables[0].mass_per_metre = 1.0;
  scene.cables[0].slack = 0.1;
  Scene wall = scene;
  scene.bodies.push_back(body("post", BodyKind::fixed, 0.0, -0.3, 0.2));
  refused(scene, "the cable runs through body 'post' (");
  wall.walls.push_back({{0.0, -1.0}, {0.013, 1.0}, 0.5, 0.0});
  refused(wall, "the cable runs through wall 0 (");
}

// Its sag would have to be 0, and rho g L^2 / 8 s its tension.
TEST(Nodes, ACableThatCannotSagIsRefused) {
  Scene scene;
  scene.cables.push_back(cable(at(-1.0, 0.0), {}, at(1.0, 0.0), 0.01));
  scene.cables[0].mass_per_metre = 1.0;
  EXPECT_THROW(spread_nodes(scene), SceneError);
  for (const auto& change : {+[](Scene& s) { s.cables[0].slack = 1e-6; },
                             +[](Scene& s) { s.cables[0].axial_stiffness = 1e4; },
                             +[](Scene& s) { s.gravity = Vec2::Zero(); },
                             +[](Scene& s) { s.gravity = Vec2(9.81, 0.0); }}) {
    Scene sags = scene;
    change(sags);
    spread_nodes(sags);
    World world = make_world(sags, measured());
    run(sags, world, 120);
    EXPECT_EQ(world.diagnostics.fallbacks, 0);
  }
}

}  // namespace
}  // namespace pinchlab::testing
