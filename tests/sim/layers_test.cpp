// SPDX-License-Identifier: GPL-3.0-or-later
// Drums that fill in layers, by the area law.

#include <numbers>

#include "demos/scenes/shape_scenes.h"
#include "sim/cable/cable.h"
#include "tests/sim/course.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using build::layered_hoist;

constexpr double pi = std::numbers::pi;

// Lengths of r0 th + w th^2 / 2 pi for r0 = 0.2, w = 0.01 after 1, 5 and 20 turns (outside case).
TEST(Layers, LengthsAreThoseOfTheSpiral) {
  const Layers layers{1, 0.2, 0.01 / pi, 0.0};
  EXPECT_NEAR(layers.length(2.0 * pi), 1.319469, 5e-7);
  EXPECT_NEAR(layers.length(10.0 * pi), 7.853982, 5e-7);
  EXPECT_NEAR(layers.length(40.0 * pi), 50.265482, 5e-7);
  for (const double turned : {0.1, 3.0, 50.0}) {
    const double l = layers.length(turned), r = layers.radius(turned);
    EXPECT_NEAR(r * r, 0.2 * 0.2 + 2.0 * 0.01 * l / pi, 1e-14 * r * r);
  }
}

/// What is wound, plus what hangs free, is the cable.
double length_of(const World& world) {
  const CableState& cable = world.cables[0];
  double length = 0.0;
  for (const Link& link : cable.links) length += stored_length(link);
  for (const Segment& segment : cable.segments) length += segment.length;
  return length;
}

TEST(Layers, AreRoundTheDrumFromItsRimOn) {
  for (const bool from_start : {true, false}) {
    const Scene scene = layered_hoist(5, 0.02, 1, from_start);
    const World world = make_world(scene, Method::pinch);
    const Link& drum = world.cables[0].links[1];
    EXPECT_GT(drum.wrap, 10.0 * pi);
    EXPECT_NEAR(drum.radius, 0.22 + 0.02 * drum.wrap / pi, 1e-15);
    EXPECT_NEAR(length_of(world), world.cables[0].length, 1e-13);
    // The span is a tangent of the outermost turn.
    const Segment& span = world.cables[0].segments[from_start ? 2 : 1];
    const Vec2& foot = from_start ? span.tail : span.head;
    EXPECT_NEAR(foot.norm(), drum.radius, 1e-15);
    EXPECT_NEAR(foot.dot(span.direction), 0.0, 1e-15);
  }
}

// The span between two reels is the tangent of both outermost turns, whichever is listed first:
// each depends on the other.
TEST(Layers, TwoReelsAreTangentToOneSpan) {
  for (const bool from_left : {true, false}) {
    Scene scene;
    for (const double x : {0.0, 1.5}) {
      scene.bodies.push_back(body(x == 0.0 ? "left" : "right", BodyKind::fixed_axle, x, 0.0, 0.1));
    }
    const int first = from_left ? 0 : 1;
    const Attachment start{first, {0.0, 0.12}, true}, end{1 - first, {0.0, 0.12}, true};
    const int way = from_left ? -1 : 1;
    scene.cables.push_back(cable(
        start, {{first, way, from_left ? 1 : 6}, {1 - first, way, from_left ? 6 : 1}}, end, 0.02));
    const World world = make_world(scene, Method::pinch);
    const CableState& rope = world.cables[0];
    for (const int reel : {1, 2}) {
      const Link& link = at(rope.links, reel);
      EXPECT_NEAR(link.radius, 0.12 + 0.02 * link.wrap / pi, 1e-15) << from_left << reel;
    }
    const double steeper = rope.links[2].radius - rope.links[1].radius;
    EXPECT_NEAR(rope.segments[2].length, std::sqrt(1.5 * 1.5 - steeper * steeper), 1e-15);
    EXPECT_NEAR(length_of(world), rope.length, 1e-13);
  }
}

/// A load at (x, -3) on a rope that is wound on a drum, whose rim with the rope's half width is of
/// 0.3 m, from its right side on, twice and what that place asks for.
World wound_twice(double x, bool from_start) {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed, 0.0, 0.0, 0.28));
  scene.bodies.push_back(body("load", BodyKind::free, x, -3.0, 0.1, 3.0));
  const Attachment rim{0, {0.3, 0.0}, true};
  scene.cables.push_back(from_start ? cable(rim, {{0, -1, 2}}, on(1), 0.02)
                                    : cable(on(1), {{0, 1, 2}}, rim, 0.02));
  return make_world(scene, Method::pinch);
}

// Beside two turns a rope 0.04 m thick is 0.38 m out; the load hangs there, or at the bare rim, or
// as far out again, by two turns and the little that its place asks for, which it asks smoothly.
TEST(Layers, ALoadBesideThemHangsFromWholeTurns) {
  for (const bool from_start : {true, false}) {
    const auto wrap_at = [from_start](double x) {
      return wound_twice(x, from_start).cables[0].links[1].wrap;
    };
    const World world = wound_twice(0.38, from_start);
    const CableState& cable = world.cables[0];
    EXPECT_NEAR(cable.links[1].wrap, 4.0 * pi, 1e-14);
    EXPECT_NEAR(cable.links[1].radius, 0.38, 1e-15);
    EXPECT_NEAR(cable.segments[from_start ? 2 : 1].length, 3.0, 1e-15);
    EXPECT_NEAR(length_of(world), cable.length, 1e-13);
    double before = wrap_at(0.28);
    for (double x = 0.281; x < 0.45; x += 1e-3) {
      const double wrap = wrap_at(x);
      EXPECT_NEAR(before - wrap, 1e-3 / 3.0, 1e-5) << x;
      before = wrap;
    }
    EXPECT_NEAR(wrap_at(0.38 - 1e-6) - wrap_at(0.38 + 1e-6), 2e-6 / 3.0, 1e-8);
    EXPECT_GT(wrap_at(0.5), 5.9 * pi);  // nearly once more round
  }
}

TEST(Layers, EnergyIsKeptAndTheOrderIsTwo) {
  for (const bool from_start : {true, false}) {
    double before = 0.0, last = 0.0;
    std::vector<double> ends;
    for (int n = 1; n <= 64; n *= 2) {
      const Scene scene = layered_hoist(8, 0.02, n, from_start);
      World world = make_world(scene, measured());
      const double length = world.cables[0].length;
      const double drift = energy_drift(scene, world, 60 * n, [&world, length] {
        ASSERT_LT(world.diagnostics.cable_length_error, 1e-12);
        ASSERT_LT(std::abs(length_of(world) - length), 1e-10);
      });
      EXPECT_LT(world.cables[0].links[1].wrap, 15.0 * pi);  // some of it has come off
      EXPECT_LT(drift, 2e-3 / (n * n));
      ends.push_back(world.position[1].y());
      if (ends.size() > 2) {
        const double now = std::abs(ends[ends.size() - 1] - ends[ends.size() - 2]);
        before = std::abs(ends[ends.size() - 2] - ends[ends.size() - 3]);
        EXPECT_GT(std::log2(before / now), 1.9) << n;
        last = now;
      }
    }
    EXPECT_LT(last, 1e-6);
  }
}

// Wound on and off again, the drum is as it was, the rope having mass or none.
TEST(Layers, WindOnAsTheyWindOff) {
  for (const double density : {0.0, 2.0}) {
    Scene scene = layered_hoist(2, 0.03, 4);
    scene.cables[0].mass_per_metre = density;
    scene.bodies[0].driven_angular_velocity = 0.0;
    scene.bodies[0].motor = {{0.0, 0.0}, {0.5, -3.0}, {1.5, -3.0}, {2.0, 0.0},
                             {2.5, 3.0}, {3.5, 3.0},  {4.0, 0.0}};
    World world = make_world(scene, Method::pinch);
    const Vec2 place = world.position[1];
    const double radius = world.cables[0].links[1].radius;
    run(scene, world, 480);
    EXPECT_NEAR(std::abs(world.angle[0]), 4.5, 1e-12);
    EXPECT_GT(std::abs(world.cables[0].links[1].radius - radius), 0.02);
    run(scene, world, 480);
    EXPECT_NEAR(world.angle[0], 0.0, 1e-12);
    EXPECT_LT((world.position[1] - place).norm(), 1e-9);
    EXPECT_NEAR(world.cables[0].links[1].radius, radius, 1e-12);
  }
}

TEST(Layers, AClearedWorkspaceChangesNoBit) {
  for (const bool from_start : {true, false}) {
    EXPECT_TRUE(is_all_state(layered_hoist(5, 0.02, 4, from_start), Method::pinch, 400));
  }
}

/// A load of 2 kg on a rail beside a drum of 0.2 m, driven at 3 rad/s, that winds the load up on
/// three turns in layers.
Scene driven_hoist() {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.2, 3.0));
  scene.bodies[0].driven_angular_velocity = -3.0;
  scene.bodies.push_back(body("load", BodyKind::rail, -0.3, -8.0, 0.1, 2.0));
  scene.cables.push_back(cable(on(1), {{0, -1, 3}}, {0, {0.22, 0.0}, true}, 0.02));
  return scene;
}

/// A roller of 0.1 m on the top of the drum's layers; its body comes last.
Body& add_roller(Scene& scene, double mass) {
  const World world = make_world(scene, Method::pinch);
  for (const Link& link : world.cables[0].links) {
    if (link.layers.way == 0 || link.orientation == 0) continue;
    const double height = link.radius + scene.cables[0].half_width + 0.1;
    scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, height, 0.1, mass));
  }
  return scene.bodies.back();
}

// It rolls on the outermost layer, omega (r + w) = Omega R, with its centre (r + w) + R from the
// drum's, or is dragged along by mu N.
TEST(Layers, WhatIsPressedOnThemRollsOnTheOutermost) {
  for (const double friction : {infinity, 0.1}) {
    for (const Method method : {Method::pinch, Method::pinch_no_contact}) {
      Scene scene = driven_hoist();
      Body& roller = add_roller(scene, 1.0);
      roller.cable_friction = friction;
      const double thick = roller.position.y() - 0.1;
      World world = make_world(scene, method);
      run(scene, world, 240);
      const double outer = world.cables[0].links[1].radius;
      EXPECT_GT(outer, thick - 0.02 + 0.015);
      if (method == Method::pinch_no_contact) {
        EXPECT_NEAR(world.position[2].y(), 0.3, 1e-9);  // down to the drum itself
        continue;
      }
      EXPECT_NEAR(world.position[2].y(), outer + 0.12, 1e-9) << friction;
      // It goes up by the layers' growth, so slowly that its weight is what presses.
      const double torque = friction * 1.0 * g * (0.1 + 0.02) / (0.5 * 0.1 * 0.1);
      const double turning = friction < infinity
                                 ? std::min(torque * world.time(), 3.0 * outer / 0.12)
                                 : 3.0 * outer / 0.12;
      EXPECT_NEAR(world.angular_velocity[2], turning, 1e-3 * turning) << friction;
    }
  }
}

// The roller's angle is the integral of Omega R / (r + w). The drum winds th = Omega t + alpha; of
// the span, from (-0.3, y), the length L is what is not wound, so that -R sin alpha - L cos alpha =
// -0.3 gives alpha. With the lever of the interval's start the angle would be off by 4e-3 rad.
TEST(Layers, WhatRollsOnThemRollsByTheRadiusInMidInterval) {
  constexpr double speed = 3.0, seconds = 1.0, x = -0.3, lever = 0.1 + 0.02;
  const Scene scene = driven_hoist();
  const World start = make_world(scene, Method::pinch);
  const Link& drum = start.cables[0].links[1];
  const auto slope = [&start](double radius, double length) {  // alpha, rad
    return pi - std::asin(-x / std::hypot(radius, length)) - std::atan2(length, radius);
  };
  double th = drum.wrap, turned = 0.0;
  const double whole = drum.layers.length(th) + start.cables[0].segments[1].length;
  const double first = slope(drum.radius, start.cables[0].segments[1].length);
  constexpr int parts = 1000;  // of Simpson's rule
  for (int i = 0; i <= parts; ++i) {
    for (int k = 0; k < 20; ++k) {
      const double now = slope(drum.layers.radius(th), whole - drum.layers.length(th));
      th = drum.wrap + speed * seconds * i / parts + now - first;
    }
    const double weight = i == 0 || i == parts ? 1.0 : 2.0 + 2.0 * (i % 2);
    turned += weight * speed * drum.layers.radius(th) / lever * seconds / (3.0 * parts);
  }
  for (const int steps_per_frame : {1, 2, 4}) {
    Scene rolling = driven_hoist();
    rolling.steps_per_frame = steps_per_frame;
    add_roller(rolling, 1.0).angular_velocity = speed * drum.radius / lever;
    World world = make_world(rolling, measured());
    run(rolling, world, 60 * steps_per_frame);
    EXPECT_NEAR(world.angle[2], turned, 2e-8 / (steps_per_frame * steps_per_frame));
  }
}

// A heavy smooth roller sinks as the load pulls rope off the drum: what lifts it brakes the drum
// by as much. With the sign of that turned round energy would change by 2.3 J.
TEST(Layers, WhatLiesSmoothlyOnThemGivesTheDrumItsEnergy) {
  for (const int steps_per_frame : {1, 4}) {
    Scene scene = layered_hoist(5, 0.02, steps_per_frame);
    scene.bodies[1].mass = 10.0;
    Body& roller = add_roller(scene, 5.0);
    roller.cable_friction = 0.0;
    const double height = roller.position.y();
    const Course course = run_measured(scene, 0.6);
    EXPECT_LT(course.end[7], height - 0.02);
    EXPECT_LT(course.energy, 2e-4 / (steps_per_frame * steps_per_frame));
  }
}

struct PressedHoist {
  BodyKind drum;      // turns, stands, or bounces on a spring
  bool swings;        // 10 kg that hang beside it, near
  double density;     // kg/m, of the rope
  bool begins_there;  // on the drum, or ends there
};

/// A smooth roller on the drum's layers.
Scene scene_of(const PressedHoist& with, int steps_per_frame) {
  Scene scene = layered_hoist(5, 0.02, steps_per_frame, with.begins_there);
  scene.cables[0].mass_per_metre = with.density;
  scene.bodies[0].kind = with.drum;
  Body& load = scene.bodies[1];
  load.kind = with.swings ? BodyKind::free : BodyKind::rail;
  load.position = {with.swings ? 1.2 : 0.3, -1.5};
  load.mass = 10.0;
  Body& roller = add_roller(scene, 5.0);
  roller.cable_friction = 0.0;
  if (with.drum != BodyKind::rail) return scene;
  roller.rail_axis = Vec2(-1.0, 1.0).normalized();  // beside the spring
  roller.position = roller.position.norm() * roller.rail_axis;
  scene.cables.push_back(cable(at(0.0, 3.0), {}, on(0), 0.01));
  scene.cables[1].name = "spring";
  scene.cables[1].axial_stiffness = 6000.0;  // N
  return scene;
}

/// The change of energy (J) in half a second.
double energy_error(const PressedHoist& with, int steps_per_frame) {
  const Course course = run_measured(scene_of(with, steps_per_frame), 0.5);
  EXPECT_LT(course.gap, 1e-10);
  return course.energy;
}

// The radius grows with the wrap, which grows as the drum turns and as the span does: so what lies
// on a drum pulls at the span's far end, too. Without that energy was off by up to 0.08 J however
// fine the steps, and on a drum that stands gaps were short by 1e-4 m.
TEST(Layers, WhatLiesOnThemPullsAtTheSpanThatTurns) {
  for (const BodyKind drum : {BodyKind::fixed_axle, BodyKind::fixed, BodyKind::rail}) {
    for (const bool swings : {false, true}) {
      if (drum == BodyKind::fixed && !swings) continue;  // nothing moves
      for (const double density : {0.0, 2.0}) {
        for (const bool begins_there : {false, true}) {
          const PressedHoist with{drum, swings, density, begins_there};
          const double fine = energy_error(with, 16), coarse = energy_error(with, 4);
          EXPECT_LT(fine, 1e-3) << static_cast<int>(drum) << swings << density << begins_there;
          EXPECT_GT(coarse / fine, 15.0) << static_cast<int>(drum) << swings << density;
        }
      }
    }
  }
}

// The thesis' sweeps push a row's third body as well: left out, the load falls 0.2 mm less.
TEST(Layers, WhatLiesOnThemPullsAtTheSpanBySweepsToo) {
  const Scene scene = scene_of({BodyKind::fixed_axle, false, 0.0, true}, 16);
  World direct = make_world(scene, Method::pinch),
        swept = make_world(scene, thesis_configuration());
  run(scene, direct, 480);
  run(scene, swept, 480);
  EXPECT_LT(direct.position[1].y(), -2.5);
  EXPECT_NEAR(swept.position[1].y(), direct.position[1].y(), 1e-5);
  EXPECT_NEAR(swept.position[2].y(), direct.position[2].y(), 1e-6);
}

}  // namespace
}  // namespace pinchlab::testing
