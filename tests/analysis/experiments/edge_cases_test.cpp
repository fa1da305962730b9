// SPDX-License-Identifier: GPL-3.0-or-later
// Corner cases of events, each at three lengths of the step: nothing explodes, makes energy, comes
// too near, gets longer than it is or prefers a side, and shorter steps change little.

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "analysis/experiments/population.h"
#include "analysis/experiments/population_scenes.h"
#include "demos/scenes/build.h"
#include "sim/mirror.h"

namespace pinchlab::experiments {
namespace {

using build::at;
using build::cable;
using build::on;

constexpr double w = 0.03;  // m, half width of all cables here

Wall floor_at(double y, double restitution) {
  Wall wall;
  wall.a = Vec2(-3.0, y);
  wall.b = Vec2(3.0, y);
  wall.restitution = restitution;
  return wall;
}

Body disc(BodyKind kind, double radius, double mass, double x, double y) {
  return build::body("", kind, x, y, radius, mass);
}

/// A span from (-1, 0) to (1, 0), with slack.
Scene span(double slack) {
  Scene scene;
  scene.cables = {cable(at(-1.0, 0.0), {}, at(1.0, 0.0), w)};
  scene.cables[0].slack = slack;
  return scene;
}

/// Weights of so many kg either side of a pulley that turns, on one cable.
Scene atwood(double left_kg, double right_kg, double slack) {
  Scene scene;
  scene.bodies = {disc(BodyKind::fixed_axle, 0.3, 1.0, 0.0, 0.0),
                  disc(BodyKind::free, 0.1, left_kg, -0.3 - w, -1.5),
                  disc(BodyKind::free, 0.1, right_kg, 0.3 + w, -1.5)};
  scene.cables = {cable(on(1), {{0, -1, 0}}, on(2), w)};
  scene.cables[0].slack = slack;
  return scene;
}

Scene in_touch_with_a_span() {
  Scene scene = span(0.02);
  scene.bodies = {disc(BodyKind::free, 0.2, 1.0, 0.1, 0.2 + w)};
  scene.bodies[0].velocity = Vec2(0.3, 0.0);
  return scene;
}

Scene either_side_of_a_span() {
  Scene scene = span(0.2);
  scene.bodies = {disc(BodyKind::free, 0.2, 1.0, 0.0, 0.6),
                  disc(BodyKind::free, 0.2, 1.0, 0.0, -0.6)};
  scene.bodies[0].velocity = Vec2(0.0, -2.0);
  scene.bodies[1].velocity = Vec2(0.0, 4.0);
  return scene;
}

Scene leaves_and_lands() {
  Scene scene = span(0.3);
  scene.bodies = {disc(BodyKind::free, 0.2, 1.0, 0.05, 0.25 + w)};
  scene.bodies[0].velocity = Vec2(0.0, -0.02);
  scene.bodies[0].restitution = 1.0;
  scene.walls = {floor_at(-0.45, 1.0)};  // throws it back up through its span
  return scene;
}

Scene light_between_heavy() {
  Scene scene = span(0.1);
  scene.bodies = {disc(BodyKind::free, 0.2, 10.0, 0.0, 0.9),
                  disc(BodyKind::free, 0.1, 1e-3, 0.02, 0.3),
                  disc(BodyKind::free, 0.2, 10.0, -0.03, -0.9)};
  scene.bodies[2].velocity = Vec2(0.0, 5.0);
  return scene;
}

Scene caught_while_pinched() {
  Scene scene = atwood(1.0, 2.0, 0.2);
  scene.bodies.push_back(disc(BodyKind::rail, 0.2, 2.0, 0.0, 0.5 + 2.0 * w));
  scene.bodies[3].rail_axis = Vec2(0.0, 1.0);
  return scene;
}

Scene rolls_on_to_a_slack_span() {
  Scene scene;
  scene.bodies = {disc(BodyKind::fixed_axle, 0.3, 1.0, 0.0, 0.0),
                  disc(BodyKind::free, 0.15, 1.0, -0.05, 0.45 + 2.0 * w)};
  scene.bodies[1].position = (0.45 + 2.0 * w) * Vec2(std::sin(0.1), std::cos(0.1));
  scene.cables = {cable(at(-1.5, -0.6), {{0, -1, 0}}, at(1.5, -0.6), w)};
  scene.cables[0].slack = 0.1;
  return scene;
}

Scene ten_land_at_once() {
  Scene scene;
  for (int i = 0; i < 10; ++i) {
    const double x = 0.7 * i;
    scene.bodies.push_back(disc(BodyKind::free, 0.2, 1.0, x, 1.0));
    scene.bodies.back().restitution = 0.1 * i;
    scene.cables.push_back(cable(at(x - 0.3, 0.0), {}, at(x + 0.3, 0.0), w));
    scene.cables.back().slack = 0.05;
  }
  return scene;
}

Scene loop_that_tightens() {
  Scene scene;
  scene.bodies = {disc(BodyKind::fixed_axle, 0.3, 1.0, 0.0, 0.0),
                  disc(BodyKind::free, 0.2, 2.0, 0.1, -1.0)};
  Cable loop;
  loop.half_width = w;
  loop.closed = true;
  loop.wraps = {{0, -1, 0}, {1, -1, 0}};
  loop.slack = 0.6;
  scene.cables = {loop};
  return scene;
}

Scene smallest_bounce() {
  Scene scene = atwood(1.0, 1.0, 0.0);
  scene.bodies.push_back(disc(BodyKind::free, 0.1, 1.0, 1.0, 0.1 + 1e-9));
  scene.bodies[3].restitution = 0.9;
  scene.walls = {floor_at(0.0, 0.9)};
  scene.walls[0].a.x() = 0.7;
  return scene;
}

Scene between_wall_and_span() {
  Scene scene = span(0.05);
  scene.bodies = {disc(BodyKind::free, 0.2, 1.0, 0.05, 0.5)};
  scene.bodies[0].restitution = 1.0;
  scene.bodies[0].velocity = Vec2(0.0, 3.0);
  scene.walls = {floor_at(0.9, 1.0)};
  return scene;
}

Scene driven_on_to_moving_cable() {
  Scene scene = atwood(1.0, 1.5, 0.0);
  scene.bodies.push_back(disc(BodyKind::rail, 0.15, 1.0, 0.0, 0.7));
  scene.bodies[3].rail_axis = Vec2(0.0, 1.0);
  scene.bodies[3].driven_angular_velocity = 6.0;
  for (Body& b : scene.bodies) b.cable_friction = 0.2;
  return scene;
}

struct EdgeCase {
  const char* name;
  std::function<Scene()> scene;
  /// Of the most kinetic energy, that a leapfrog's energy swings by on curved ways, times the
  /// square of the steps a frame.
  double swing = 0.0;
  int followed_from = 1;    ///< steps a frame; a body may be too light for fewer (sim/README.md)
  double asymmetry = 1e-9;  ///< m, that round-off grows to in a second
};

void PrintTo(const EdgeCase& edge, std::ostream* out) {
  *out << edge.name;
}

class EdgeCases : public ::testing::TestWithParam<EdgeCase> {};

TEST_P(EdgeCases, StaySound) {
  Scene scene = GetParam().scene();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) scene.bodies[b].name = std::to_string(b);
  for (std::size_t c = 0; c < scene.cables.size(); ++c) scene.cables[c].name = std::to_string(c);
  Configuration watched = Method::pinch;
  watched.diagnostics = true;
  const EdgeCase& edge = GetParam();
  Soundness early[3];
  for (int k = 0; k < 3; ++k) {
    const int steps = k == 0 ? 1 : k == 1 ? 4 : 16;
    early[k] = run_scene(scene, watched, steps, 30);
    const Soundness run = run_scene(scene, watched, steps, 60);
    EXPECT_TRUE(run.finite) << steps;
    EXPECT_TRUE(run.driven || run.energy_gain <= 1e-9 + edge.swing / (steps * steps))
        << steps << ": " << run.energy_gain;
    EXPECT_LE(run.length_error, 1e-12) << steps;
    EXPECT_LE(run.loose_span, 1e-9) << steps;
    EXPECT_EQ(run.unsettled, 0) << steps;
    if (steps < edge.followed_from) continue;
    EXPECT_LE(run.gap_violation, 1e-6) << steps;
    EXPECT_LE(run.depth, 1e-6) << steps;
    const Soundness image = run_scene(mirrored(scene), watched, steps, 60);
    EXPECT_LE(end_distance(run, image, true), edge.asymmetry) << steps;
  }
  EXPECT_LE(end_distance(early[1], early[2], false), 1e-3);
}

// At 15 frames a second and one step a frame nothing is followed well, and still all is sound.
TEST_P(EdgeCases, StaySoundAtFifteenStepsASecond) {
  Scene scene = GetParam().scene();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) scene.bodies[b].name = std::to_string(b);
  for (std::size_t c = 0; c < scene.cables.size(); ++c) scene.cables[c].name = std::to_string(c);
  scene.frames_per_second = 15;
  Configuration watched = Method::pinch;
  watched.diagnostics = true;
  const Soundness run = run_scene(scene, watched, 1, 15);
  EXPECT_TRUE(run.finite);
  EXPECT_LE(run.gap_violation, 1e-6);
  EXPECT_LE(run.length_error, 1e-12);
  EXPECT_LE(run.loose_span, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(
    All, EdgeCases,
    ::testing::Values(EdgeCase{"InTouchWithASpan", in_touch_with_a_span},
                      EdgeCase{"EitherSideOfASpan", either_side_of_a_span},
                      EdgeCase{"LeavesAndLands", leaves_and_lands},
                      EdgeCase{"LightBetweenHeavy", light_between_heavy, 0.0, 4, 1e-8},
                      EdgeCase{"CaughtWhilePinched", caught_while_pinched},
                      EdgeCase{"RollsOnToASlackSpan", rolls_on_to_a_slack_span, 5e-5},
                      EdgeCase{"TenLandAtOnce", ten_land_at_once},
                      EdgeCase{"LoopThatTightens", loop_that_tightens},
                      EdgeCase{"SmallestBounce", smallest_bounce},
                      EdgeCase{"BetweenWallAndSpan", between_wall_and_span},
                      EdgeCase{"DrivenOnToMovingCable", driven_on_to_moving_cable}),
    [](const ::testing::TestParamInfo<EdgeCase>& edge) { return std::string(edge.param.name); });

}  // namespace
}  // namespace pinchlab::experiments
