// SPDX-License-Identifier: GPL-3.0-or-later
// Cables with mass that slip on the bodies that they run over.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "demos/scenes/shape_scenes.h"
#include "sim/cable/mass.h"
#include "sim/diagnostics.h"
#include "sim/make_world.h"
#include "sim/outline.h"
#include "tests/sim/course.h"
#include "tests/sim/other_end.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"
#include "tests/sim/sliding.h"

namespace pinchlab::testing {
namespace {

using std::numbers::pi;

constexpr double rope_radius = 0.2, rope_density = 0.8;  // m, of the centre line on the peg; kg/m

/// Two weights on a rope over a peg: the left one hangs by `left` m of rope, the right one by
/// `right`.
Scene rope_over_peg(int steps, double mu, double left, double right, double m_left, double m_right,
                    BodyKind kind = BodyKind::fixed) {
  Scene scene;
  scene.steps_per_frame = steps;
  scene.bodies.push_back(body("left", BodyKind::free, -rope_radius, -left, 0.05, m_left));
  scene.bodies.push_back(body("right", BodyKind::free, rope_radius, -right, 0.05, m_right));
  scene.bodies.push_back(body("peg", kind, 0.0, 0.0, rope_radius - 0.01));
  scene.bodies[2].cable_friction = mu;
  scene.cables.push_back(cable(on(0), {{2, -1, 0}}, on(1), 0.01));
  scene.cables[0].mass_per_metre = rope_density;
  return scene;
}

// x'' = k^2 x, for x = half the difference of the ends: (rho L + m1 + m2) x'' = 2 rho g x. What is
// left is Numerov's error, as of the rope of Mass.ARopeOverAPulleyFallsAsItsWeightMovesOver.
TEST(MassSlip, ARopeSlidesOffASmoothPeg) {
  for (const BodyKind kind : {BodyKind::fixed, BodyKind::fixed_axle}) {
    for (const int steps : {1, 2, 4, 8, 16}) {
      const double m = 1e-6, l = 2.0 + pi * rope_radius;
      const Scene scene = rope_over_peg(steps, 0.0, 0.9, 1.1, m, m, kind);
      World world = make_world(scene, measured());
      const double k = std::sqrt(2.0 * rope_density * g / (rope_density * l + 2.0 * m));
      run(scene, world, 30 * steps);
      const double t = world.time(), kh = k / (60.0 * steps);
      const double own = 0.1 * std::sinh(k * t) * k * t * std::pow(kh, 4) / 480.0;
      const double fallen = -1.0 - world.position[1].y();
      EXPECT_NEAR(fallen, 0.1 * std::cosh(k * t), 1.1 * own + 1e-12) << steps;
      EXPECT_EQ(world.angle[2], 0.0);
    }
  }
}

/// Independent of the solver: acceleration of the rope over the peg, from its elements on the rim.
/// Slips to the right at w, with a of span on the left and b on the right.
struct PegRope {
  double mu, m_left, m_right, rho = rope_density, radius = rope_radius;

  double acceleration(double a, double b, double w) const {
    // T_right = k T_left + c0 + c1 w' over half a turn, by Simpson's rule.
    constexpr int count = 2000;
    const double k = std::exp(mu * pi);
    double c0 = 0.0, c1 = 0.0;
    for (int i = 0; i <= count; ++i) {
      const double th = pi * i / count, weight = (i == 0 || i == count ? 1.0 : i % 2 ? 4.0 : 2.0);
      const double share = weight * pi / count / 3.0 * std::exp(mu * (pi - th));
      // Up on the left, over the top, down on the right: direction (sin th, cos th), to the centre
      // (cos th, -sin th).
      const double along = rho * radius * g * std::cos(th),
                   pressing = rho * radius * g * std::sin(th);
      c0 += share * (along + mu * (pressing - rho * w * w));
      c1 += share * rho * radius;
    }
    // (m_r + rho b) (g - w') = k (m_l + rho a) (g + w') + c0 + c1 w'
    const double right = m_right + rho * b, left = m_left + rho * a;
    return (right * g - k * left * g - c0) / (right + k * left + c1);
  }
};

TEST(MassSlip, ARopeRubsOnAPegAsItsElementsDo) {
  for (const double mu : {0.0, 0.05, 0.2}) {
    const double m_left = 0.3, m_right = 4.0;
    expect_slides_as(PegRope{mu, m_left, m_right}, [&](int steps) {
      return rope_over_peg(steps, mu, 0.9, 0.4, m_left, m_right);
    });
  }
}

/// A bob of 0.5 kg on a rope that a drum winds up as it swings: the rope lies over it, with a
/// weight beyond.
Scene swinging_over_drum(int steps, double mu) {
  Scene scene;
  scene.steps_per_frame = steps;
  scene.bodies.push_back(body("bob", BodyKind::free, 1.0, -0.6, 0.05, 0.5));
  scene.bodies.push_back(body("weight", BodyKind::free, -0.3, -0.8, 0.05, 0.9));
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.19));
  scene.bodies[2].inertia = 0.2;
  scene.bodies[2].cable_friction = mu;
  scene.cables.push_back(cable(on(1), {{2, -1, 0}}, on(0), 0.01));
  scene.cables[0].mass_per_metre = 0.5;
  return scene;
}

/// A block that a rope carries, over a pulley to a weight: the block's sleeve moves.
Scene slipping_tackle(int steps, double mu) {
  Scene scene = build::heavy_tackle(steps);
  scene.bodies[0].cable_friction = scene.bodies[2].cable_friction = mu;
  return scene;
}

// With friction that it never comes to the end of, the rope moves as one that cannot slip.
TEST(MassSlip, WhatSticksMovesAsIfItCouldNotSlip) {
  for (const auto make : {swinging_over_drum, slipping_tackle}) {
    const Course fast = run_measured(make(4, infinity), 0.5);
    const Course sticking = run_measured(make(4, 30.0), 0.5);
    EXPECT_LT(largest_difference(fast.end, sticking.end), 1e-10);
  }
}

// Where it stretches it creeps alike, too, but for what slides in part: exp(-mu phi) at the middle
// of a 24th of the rim (partial_slip.h), 4e-6 at least.
TEST(MassSlip, WhatSticksCreepsAsIfItCouldNotSlip) {
  const auto run_of = [](double mu, bool creep) {
    Scene scene = swinging_over_drum(4, mu);
    scene.cables[0].axial_stiffness = 600.0;
    scene.cables[0].creep = creep;
    return run_measured(scene, 0.5);
  };
  const Course fast = run_of(infinity, true);
  EXPECT_LT(largest_difference(fast.end, run_of(1e5, true).end), 1e-5);
  EXPECT_GT(largest_difference(fast.end, run_of(1e5, false).end), 1e-3);
}

// Motion, and energy where there is no friction, against a much shorter step and against the start.
TEST(MassSlip, SwingsOnSecondOrder) {
  for (const auto make : {swinging_over_drum, slipping_tackle}) {
    for (const double mu : {0.0, 0.1}) {
      const Course exact = run_measured(make(128, mu), 0.4);
      double first = 0.0, last = 0.0, energy = 0.0;
      for (const int steps : {2, 4, 8, 16}) {
        const Course course = run_measured(make(steps, mu), 0.4);
        last = largest_difference(course.end, exact.end);
        if (steps == 2) first = last;
        if (mu == 0.0 && energy > 0.0) {
          EXPECT_GT(energy / course.energy, 3.8) << steps;
        }
        energy = course.energy;
        EXPECT_LT(course.gained, 1.5e-4 / (steps * steps)) << steps;
      }
      EXPECT_GT(first / last, 50.0) << mu;  // of 64
      EXPECT_LT(last, 2.5e-6);
    }
  }
}

// A rope stretched by some percent slides from where it is under more tension to where it is
// under less: what energy that frees is motion's. (Where what stretches comes to rest on a body is
// not located, as it does again and again in the tackle.)
TEST(MassSlip, AStretchedRopeSwingsOnSecondOrder) {
  using Made = std::pair<Scene (*)(int, double), double>;
  for (const auto& [make, mu] :
       {Made{swinging_over_drum, 0.0}, {swinging_over_drum, 0.1}, {slipping_tackle, 0.0}}) {
    const auto run_of = [make = make, mu = mu](int steps) {
      Scene scene = make(steps, mu);
      scene.cables[0].axial_stiffness = 600.0;
      return run_measured(scene, 0.4);
    };
    const Course exact = run_of(128), coarse = run_of(4), fine = run_of(16);
    const double error = largest_difference(fine.end, exact.end);
    EXPECT_GT(largest_difference(coarse.end, exact.end), 15.0 * error);
    EXPECT_LT(error, 1e-5);
    EXPECT_EQ(fine.gained, 0.0);
    if (mu > 0.0) continue;
    EXPECT_NEAR(coarse.energy / fine.energy, 16.0, 0.5);
    EXPECT_LT(fine.energy, 2e-4 * fine.at_play);
  }
}

// A drum that turns fast drags a belt round, and a second one that the belt turns along on a rail,
// which gravity pulls away from the first. With T the tension at the tangents of drum 2, strand 1
// going to the first:
//     (I / R^2 + rho pi R) w' = T1 - T2,   T1 + T2 = (m + rho pi R) g + 2 rho w^2.
TEST(MassSlip, ABeltIsDraggedAlongAtSpeed) {
  constexpr double mu = 0.25, rho = 0.7, radius = 0.15, apart = 1.1, mass = 2.0, inertia = 0.02;
  const auto faster = [](double w) {
    constexpr int count = 2000;
    const double k = std::exp(-mu * pi);
    double c0 = 0.0, c1 = 0.0;  // X_out = k X_in + c0 + c1 w'
    for (int i = 0; i <= count; ++i) {
      const double th = pi * i / count, weight = (i == 0 || i == count ? 1.0 : i % 2 ? 4.0 : 2.0);
      const double share = weight * pi / count / 3.0 * std::exp(-mu * (pi - th));
      // Gravity is along x: direction (-cos th, ..), to the centre (sin th, ..).
      c0 += share * rho * radius * (g * std::cos(th) - mu * g * std::sin(th));
      c1 += share * rho * radius;
    }
    // X1 + rho d (g + w') k ... solved for w' with T1 = (sum + m' w') / 2, T2 = (sum - m' w') / 2
    const double sum = (mass + rho * pi * radius) * g + 2.0 * rho * w * w;
    const double m = inertia / (radius * radius) + rho * pi * radius, d = rho * apart;
    // (sum - m w') / 2 + d (g - w') - rho w^2 = k ((sum + m w') / 2 + d (g + w') - rho w^2) + c0 +
    // c1 w'
    const double left = 0.5 * sum + d * g - rho * w * w, right = k * left + c0;
    return (left - right) / (0.5 * m + d + k * (0.5 * m + d) + c1);
  };
  for (const int steps : {4, 16}) {
    Scene scene;
    scene.steps_per_frame = steps;
    scene.gravity = {g, 0.0};
    scene.bodies.push_back(body("driver", BodyKind::fixed_axle, 0.0, 0.0, radius - 0.01));
    scene.bodies.push_back(body("driven", BodyKind::rail, apart, 0.0, radius - 0.01, mass));
    scene.bodies[0].cable_friction = mu;
    scene.bodies[0].driven_angular_velocity = 200.0;
    scene.bodies[1].rail_axis = {1.0, 0.0};
    scene.bodies[1].inertia = inertia;
    Cable belt = cable({}, {{0, 1, 0}, {1, 1, 0}}, {}, 0.01);
    belt.closed = true;
    belt.mass_per_metre = rho;
    scene.cables.push_back(belt);
    World world = make_world(scene, Method::pinch);
    run(scene, world, 60 * steps);
    double w = 0.0, x = 0.0;
    constexpr int count = 1000;
    for (int i = 0; i < count; ++i) {
      const double h = 1.0 / count, k1 = faster(w), k2 = faster(w + 0.5 * h * k1);
      x += h * w + 0.5 * h * h * k1;
      w += h * k2;
    }
    EXPECT_NEAR(world.angle[1], x / radius, 1e-8 * x / radius);
  }
}

/// Two weights that fly apart, on a rope over two that turn, of which one may be a pentagon.
Scene thrown_apart(bool pentagon) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  scene.bodies.push_back(body("a", BodyKind::free, -0.8, 0.0, 0.2, 1.0));
  scene.bodies.push_back(body("b", BodyKind::free, 0.8, 0.1, 0.3, 2.0));
  scene.bodies.push_back(body("c", BodyKind::free, -0.3, 1.0, 0.25, 1.5));
  scene.bodies.push_back(body("d", BodyKind::free, 0.4, 1.1, 0.15, 0.5));
  if (pentagon) make_polygon(scene.bodies[2], build::regular_corners(5, 0.25), 0.02);
  for (const std::size_t i : {2U, 3U}) scene.bodies[i].cable_friction = 0.2;
  scene.bodies[0].velocity = {0.3, -1.5};
  scene.bodies[1].velocity = {0.0, -2.0};
  scene.bodies[2].angular_velocity = -3.0;
  scene.cables.push_back(cable(on(0), {{2, -1, 0}, {3, -1, 0}}, on(1), 0.03));
  scene.cables[0].mass_per_metre = 0.4;
  return scene;
}

/// A belt on two discs, of which one turns.
Scene spun_belt() {
  Scene scene;
  scene.gravity = Vec2::Zero();
  scene.bodies.push_back(body("a", BodyKind::fixed_axle, 0.0, 0.0, 0.3, 1.0));
  scene.bodies.push_back(body("b", BodyKind::fixed_axle, 1.2, 0.1, 0.2, 1.0));
  for (Body& b : scene.bodies) b.cable_friction = 0.2;
  scene.bodies[0].angular_velocity = 5.0;
  scene.cables.push_back(cable({}, {{0, 1, 0}, {1, 1, 0}}, {}, 0.02));
  scene.cables[0].closed = true;
  scene.cables[0].mass_per_metre = 0.3;
  return scene;
}

// Ends that move apart stretch a rope evenly, or catch it; a belt on discs of which one turns
// begins between their speeds. Which end comes first is no matter.
TEST(MassSlip, TheStartIsTheSameFromEitherEnd) {
  for (const double stiffness : {2000.0, infinity}) {
    for (Scene scene : {thrown_apart(false), thrown_apart(true), spun_belt()}) {
      scene.cables[0].axial_stiffness = stiffness;
      const World a = after(scene, 4, 0.1), b = after(from_the_other_end(scene), 4, 0.1);
      double apart = 0.0;
      for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        apart = std::max(
            {apart, (a.position[i] - b.position[i]).norm(), std::abs(a.angle[i] - b.angle[i])});
      }
      EXPECT_LT(apart, 1e-9) << stiffness;
    }
  }
}

// A stiff rope that slides fast is rubbed as one that does not stretch: rims that keep the stretch
// of what lies on them see more of what flows on to them (rubbing.h).
TEST(MassSlip, AStiffRopeIsRubbedAsOneThatDoesNotStretch) {
  for (const BodyKind kind : {BodyKind::fixed, BodyKind::fixed_axle}) {
    std::array<Vec2, 2> ends;
    for (const std::size_t stretches : {0U, 1U}) {
      Scene scene = rope_over_peg(4, 0.2, 2.0, 4.0, 8.0, 3.0, kind);
      scene.bodies[0].velocity = {0.0, -4.0};
      scene.bodies[1].velocity = {0.0, 4.0};
      if (kind == BodyKind::fixed_axle) scene.bodies[2].driven_angular_velocity = 0.0;
      scene.cables[0].mass_per_metre = 2.0;
      if (stretches == 1) scene.cables[0].axial_stiffness = 1e9;
      World world = make_world(scene, measured());
      run(scene, world, 24 * 4);
      ends[stretches] = world.position[0];
    }
    EXPECT_LT((ends[1] - ends[0]).norm(), 1e-5);
  }
}

// With the scene as a whole in uniform motion the rope moves as without: over a heavy peg, from
// which springs pull the weights away.
TEST(MassSlip, MovesAlongWithItsFrame) {
  const Vec2 speed(3.0, -2.0);
  for (const double mu : {0.0, 0.15, infinity}) {
    std::vector<double> end;
    for (const bool moves : {false, true}) {
      Scene scene = rope_over_peg(8, mu, 0.9, 0.4, 0.3, 1.0, BodyKind::free);
      scene.gravity = Vec2::Zero();
      scene.bodies[2].mass = scene.bodies[2].inertia.emplace(1e9);
      for (const int end_of : {0, 1}) {
        const double x = end_of == 0 ? -rope_radius - 0.3 : rope_radius;
        scene.cables.push_back(cable({2, {x, -3.0}}, {}, on(end_of), 0.01));
        scene.cables.back().axial_stiffness = end_of == 0 ? 10.0 : 40.0;
        scene.cables.back().slack = -1.0;
      }
      for (Body& b : scene.bodies) {
        if (moves) b.velocity += speed;
      }
      World world = make_world(scene, Method::pinch);
      run(scene, world, 160);
      for (std::size_t b = 0; b < 3; ++b) {
        const Vec2 x = world.position[b] - (moves ? world.time() : 0.0) * speed;
        end.insert(end.end(), {x.x(), x.y(), world.angle[b]});
      }
      if (mu < infinity) {
        EXPECT_GT(std::abs(world.cables[0].links[1].slip_speed), 0.1);
      }
    }
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(end[i], end[i + 9], 5e-8) << mu;
  }
}

// A disc without friction that falls on a rope takes up what moves across it only: the rope moves
// on.
TEST(MassSlip, ASmoothDiscDoesNotStopTheRopeThatItMeets) {
  Scene scene;
  scene.bodies.push_back(body("light", BodyKind::free, -0.5, -0.7, 0.05));
  scene.bodies.push_back(body("heavy", BodyKind::free, 0.5, -0.7, 0.05, 1.5));
  for (int i = 0; i < 2; ++i) {
    const double x = i == 0 ? -0.4 : 0.4;
    scene.bodies.push_back(body("peg" + std::to_string(i), BodyKind::fixed, x, 0.0, 0.09));
  }
  scene.bodies.push_back(body("disc", BodyKind::free, 0.0, 0.3, 0.09, 0.01));
  for (Body& b : scene.bodies) b.cable_friction = 0.0;
  scene.cables.push_back(cable(on(0), {{2, -1, 0}, {3, -1, 0}}, on(1), 0.01));
  scene.cables[0].mass_per_metre = 1.5;
  World world = make_world(scene, Method::pinch);
  double before = 0.0;
  for (int i = 0; i < 120 && world.cables[0].links.size() == 4; ++i) {
    before = -world.velocity[1].y();
    run(scene, world, 1);
  }
  ASSERT_EQ(world.cables[0].links.size(), 5U);
  EXPECT_GT(before, 0.1);
  EXPECT_NEAR(-world.velocity[1].y(), before, 0.03);
  EXPECT_NEAR(world.cables[0].links[2].slip_speed, before, 0.03);
}

// What the energy rises by is what it swings by, as of ropes that do not slip (RandomMass).
TEST(RandomMassSlip, StaysFiniteAndMakesNoEnergy) {
  int ran = 0, more = 0;
  for (unsigned seed = 0; seed < seeds_of(300U); ++seed) {
    for (const int steps : {1, 4, 16}) {
      Scene scene = slipping_rope(seed);
      scene.steps_per_frame = steps;
      const Course course = run_measured(scene, 1.5);
      if (scene.cables[0].axial_stiffness < infinity) {
        EXPECT_LE(course.gained, swing_of_heavy_ropes * course.at_play) << seed << ", " << steps;
        continue;
      }
      expect_sound(scene, course, 1e-2 / (steps * steps), seed);
      if (course.gained > swing_of_heavy_ropes / (steps * steps) * course.at_play) ++more;
      ++ran;
    }
  }
  EXPECT_GT(ran, seeds_of(500));
  EXPECT_LE(more, 3);
}

// Each span of a rope that stretches is a spring by itself, as what slides has mass. Taken together
// for one spring they were not damped where they were too fast to follow, and what was let loose in
// the short interval to an event made up to a quarter of the energy at play.
TEST(RandomMassSlip, StretchesAndMakesNoEnergy) {
  for (const unsigned seed : {127U, 693U, 1113U}) {
    Scene scene = slipping_rope(seed);
    scene.steps_per_frame = 1;
    ASSERT_LT(scene.cables[0].axial_stiffness, infinity);
    const Course course = run_measured(scene, 1.5);
    EXPECT_LE(course.gained, 1e-4 * course.at_play) << seed;
  }
}

// Rollers fall on pulleys and pinch the rope, over which it slips.
TEST(RandomMassSlip, PinchesHold) {
  int fallbacks = 0;
  for (unsigned seed = 0; seed < seeds_of(25U); ++seed) {
    Scene scene = random_scene(static_cast<int>(seed));
    scene.steps_per_frame = 4;
    Random random(seed + 5000);
    for (Cable& c : scene.cables) c.mass_per_metre = std::pow(10.0, random.uniform(-2.0, 0.5));
    for (Body& b : scene.bodies) {
      const int what = random.below(5);
      if (what == 1)
        b.cable_friction = infinity;
      else
        b.cable_friction = what == 0 ? 0.0 : random.uniform(0.02, 0.8);
    }
    World world = make_world(scene, measured());
    Workspace work;
    const double w = scene.cables[0].half_width;
    double start = 0.0, gained = 0.0, at_play = 0.0;
    for (int i = 0; i < 480; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      const Diagnostics& d = world.diagnostics;
      if (i == 0) start = d.energy;
      gained = std::max(gained, d.energy - start);
      at_play = std::max(at_play, start - potential_energy(scene, world));
      ASSERT_LE(std::max(d.largest_gap_violation, d.largest_stretch), 1e-6 * w) << seed;
    }
    EXPECT_LE(gained, 1e-3 * at_play) << seed;
    fallbacks += static_cast<int>(world.diagnostics.fallbacks);
  }
  EXPECT_LE(fallbacks, 10);
}

TEST(RandomMassSlip, AClearedWorkspaceChangesNoBit) {
  for (unsigned seed = 0; seed < seeds_of(40U); ++seed) {
    EXPECT_TRUE(is_all_state(slipping_rope(seed), Method::pinch, 200)) << seed;
  }
}

TEST(MassSlip, RefusesWhatItCannot) {
  const auto refusal = [](const Configuration& configuration) -> std::string {
    const Scene scene = slipping_tackle(4, 0.2);
    return message_of<SceneError>([&] { make_world(scene, configuration); });
  };
  EXPECT_EQ(refusal(Method::pinch), "");
  EXPECT_EQ(refusal(Method::cable), "");
  EXPECT_NE(refusal(thesis_configuration()).find("direct solver"), std::string::npos);
}

}  // namespace
}  // namespace pinchlab::testing
