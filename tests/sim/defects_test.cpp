// SPDX-License-Identifier: GPL-3.0-or-later
// Small scenes that once went wrong, one a cause.

#include "demos/scenes/scene_json.h"
#include "sim/diagnostics.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

Scene read(const std::string& name) {
  return read_scene_file(PINCHLAB_SOURCE_DIR "/tests/sim/defects/" + name + ".json").scene;
}

// A slack group's slack row lies between the peg and the world and cannot give way; the weight can.
TEST(Defects, ASlackCableOverASmoothPegIsPulledTaut) {
  const Scene scene = read("01-slack-over-smooth-peg");
  World world = make_world(scene, measured());
  play(scene, world, 1.0);
  EXPECT_NEAR(world.position[1].y(), scene.bodies[1].position.y() - scene.cables[0].slack, 1e-9);
  EXPECT_NEAR(world.cables[0].segments.back().tension, g, 1e-9);
}

// The weight holds the span that it is over: whether the gap to its pulley had to be 0 or the
// cable's width was up to round-off.
TEST(Defects, AWeightAtItsOwnPulleyIsNotKickedOff) {
  const Scene scene = read("02-weight-at-its-pulley");
  for (const int steps : {1, 2, 4, 8, 16}) {
    Scene stepped = scene;
    stepped.steps_per_frame = steps;
    World world = make_world(stepped, measured());
    const Extremes most = play(stepped, world, 1.5);
    EXPECT_LE(most.energy_gain, 1e-9 * most.kinetic) << steps;
    EXPECT_LT(most.gap_violation, 1e-9) << steps;
  }
}

// The tangents of the neighbours turn when a link is put in beside a pulley: the material of both
// parts is what lies between the new ones.
TEST(Defects, APartOfASpanHitBesideAPulleyIsNotBornTooShort) {
  const Scene scene = read("06-ball-on-a-slack-span-beside-a-pulley");
  World world = make_world(scene, measured());
  const Extremes most = play(scene, world, 0.6);
  EXPECT_LT(most.stretch, 1e-5);
  EXPECT_LT(most.energy_gain, 1e-3 * most.kinetic);
}

// The distance (m) from y(t) = -L - A cos(omega t), omega^2 = EA / (m l), over two seconds.
double error_of_oscillation(Scene scene, int steps_per_frame) {
  scene.steps_per_frame = steps_per_frame;
  World world = make_world(scene, measured());
  const double rest = 1.0, omega = std::sqrt(scene.cables[0].axial_stiffness / rest);
  const double middle = rest * (1.0 + g / scene.cables[0].axial_stiffness);
  const double amplitude = -scene.bodies[0].position.y() - middle;
  double largest = 0.0;
  for (int frame = 1; frame <= 120; ++frame) {
    run(scene, world, steps_per_frame);
    const double exact = -middle - amplitude * std::cos(omega * world.time());
    largest = std::max(largest, std::abs(world.position[0].y() - exact));
  }
  return largest;
}

TEST(Defects, AnElasticCableIsNotDamped) {
  Scene scene = read("05-elastic-cable-is-damped");
  constexpr double less = 0.01;  // m of amplitude, so that the cable never gets slack
  scene.bodies[0].position.y() += less;
  scene.cables[0].slack += less;
  double before = error_of_oscillation(scene, 1);
  for (int steps = 2; steps <= 64; steps *= 2) {
    const double error = error_of_oscillation(scene, steps);
    EXPECT_GT(std::log2(before / error), 1.9) << steps;
    before = error;
  }
  EXPECT_LT(before, 1e-5);
}

// What vibrates faster than steps can follow comes to rest instead of ringing on.
TEST(Defects, AVeryStiffCableIsLikeAnInextensibleOne) {
  Scene scene = read("05-elastic-cable-is-damped");
  scene.bodies[0].position = {0.0, -1.0};
  scene.bodies[0].velocity = {2.0, 0.0};
  scene.cables[0].slack = 0.0;
  scene.cables[0].axial_stiffness = infinity;
  World stiffest = make_world(scene, measured());
  run(scene, stiffest, 240);
  for (const double stiffness : {1e7, 1e9, 1e12}) {
    scene.cables[0].axial_stiffness = stiffness;
    World world = make_world(scene, measured());
    run(scene, world, 240);
    const double stretch = 20.0 / stiffness;  // m, at most: by weight and m v^2 / l
    EXPECT_LT((world.position[0] - stiffest.position[0]).norm(), 1e-9 + 10.0 * stretch)
        << stiffness;
  }
}

// Links of a closed cable are counted round its end, and it never lies on one body only; what was
// counted wrongly lost cable, or links.
TEST(Defects, ClosedCablesStayWithinBounds) {
  for (const char* name : {"10-open-and-closed-cable", "12-closed-cable-out-of-bounds"}) {
    const Scene scene = read(name);
    World world = make_world(scene, measured());
    Workspace work;
    while (world.time() < 1.0) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      ASSERT_LT(world.diagnostics.cable_length_error, 1e-9) << name << ", t = " << world.time();
      for (const CableState& cable : world.cables) {
        ASSERT_EQ(cable.segments.size(), cable.links.size());
        ASSERT_GE(cable.links.size(), 2U) << name << ", t = " << world.time();
      }
    }
  }
}

}  // namespace
}  // namespace pinchlab::testing
