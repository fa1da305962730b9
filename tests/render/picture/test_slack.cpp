// SPDX-License-Identifier: GPL-3.0-or-later
// How slack cable without mass is drawn where bodies come on to it.

#include <gtest/gtest.h>

#include <algorithm>

#include "demos/scenes/scene_json.h"
#include "render/picture/cable_path.h"
#include "sim/cable/cable.h"
#include "sim/step.h"

namespace pinchlab {
namespace {

/// Where material `m` (m) of a path lies.
Vec2 place_of(const std::vector<StripPoint>& points, double m) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const StripPoint &from = points[i - 1], &to = points[i];
    if (to.material < m || to.material == from.material) continue;
    const double share = (m - from.material) / (to.material - from.material);
    return from.position + share * (to.position - from.position);
  }
  return points.back().position;
}

// Balls that fall on to a slack cable meet it where the straight line is. It jumped up to them by
// twenty half widths in a frame and hung from them in garlands.
TEST(CablePath, SlackCableHangsUntilWhatFallsComesDownToIt) {
  for (const char* end : {"1.0", "1.4"}) {
    const SceneFile file = parse_scene(
        R"({"title": "hammock", "duration_s": 1, "view": "fit",
      "baseline": {"method": "cable", "reason": "none"},
      "bodies": [
        {"name": "a", "kind": "free", "radius_m": 0.15, "mass_kg": 1, "position_m": [-0.5, 0.6]},
        {"name": "b", "kind": "free", "radius_m": 0.15, "mass_kg": 1, "position_m": [0.16, 0.6]}],
      "cables": [{"name": "c", "half_width_m": 0.03, "slack_m": 0.5,
                  "start": {"world_m": [-1, 0.3]}, "end": {"world_m": [)" +
            std::string(end) + R"(, 0.3]}}]})",
        "hammock.json");
    World world = make_world(file.scene, Method::pinch);
    Workspace work;
    std::vector<StripPoint> last;
    const CableState& cable = world.cables[0];
    std::size_t most_links = 0;
    for (int frame = 0; frame < 40; ++frame) {
      std::vector<StripPoint> now;
      append_cable_path(file.scene, world, cable, 1e-4, now);
      const double fastest = std::max(world.velocity[0].norm(), world.velocity[1].norm());  // m/s
      for (double m = 0.05; !last.empty() && m < cable.length - 0.04; m += 0.05) {
        EXPECT_LT((place_of(now, m) - place_of(last, m)).norm(), 0.03 + 3.0 * fastest / 60.0)
            << "frame " << frame << ", material " << m;
      }
      for (std::size_t i = 1; i < now.size(); ++i) {
        EXPECT_GE(now[i].material, now[i - 1].material - 1e-9);
      }
      last = now;
      most_links = std::max(most_links, cable.links.size());
      for (int s = 0; s < 4; ++s) ASSERT_EQ(step(file.scene, world, work), StepStatus::ok);
    }
    EXPECT_EQ(most_links, 4U) << "both balls came on to the cable";
  }
}

/// The path of the scene's first cable.
std::vector<StripPoint> path_of(const SceneFile& file, const World& world) {
  std::vector<StripPoint> points;
  append_cable_path(file.scene, world, world.cables[0], 1e-4, points);
  return points;
}

// Once the last of its wrap had gone, rope hung straight through the drum, from one frame to the
// next by up to twenty half widths.
TEST(CablePath, SlackRopeLiesOnTheRimToWhichItIsFastened) {
  const SceneFile file = parse_scene(R"({"title": "reels", "duration_s": 2, "view": "fit",
      "baseline": {"method": "cable", "reason": "none"},
      "bodies": [{"name": "a", "kind": "fixed_axle", "radius_m": 0.2, "mass_kg": 4,
                  "position_m": [-1, 0], "driven_angular_velocity_rad_s": -10},
                 {"name": "b", "kind": "fixed_axle", "radius_m": 0.2, "mass_kg": 4,
                  "position_m": [1, 0], "angular_drag_per_s": 3}],
      "cables": [{"name": "tape", "half_width_m": 0.015,
                  "start": {"body": "a", "rim_angle_rad": 1, "layers": true},
                  "wraps": [{"body": "a", "turn": "clockwise", "extra_turns": 1},
                            {"body": "b", "turn": "clockwise", "extra_turns": 2}],
                  "end": {"body": "b", "rim_angle_rad": 2, "layers": true}}]})",
                                     "reels.json");
  World world = make_world(file.scene, Method::pinch);
  Workspace work;
  std::vector<StripPoint> last;
  int unwound = 0;
  for (int frame = 0; unwound < 12; ++frame) {
    ASSERT_LT(frame, 120);
    const std::vector<StripPoint> now = path_of(file, world);
    for (double m = 0.05; frame > 10 && m < world.cables[0].length; m += 0.05) {
      EXPECT_LT((place_of(now, m) - place_of(last, m)).norm(), 0.12) << frame << ", " << m;
    }
    for (std::size_t i = 1; i < now.size(); ++i) {
      EXPECT_GT((now[i].position - world.position[0]).norm(), 0.21) << frame << ", " << i;
      EXPECT_GE(now[i].material, now[i - 1].material - 1e-9);
    }
    last = now;
    if (world.cables[0].links[1].body == 1) ++unwound;
    for (int s = 0; s < 4; ++s) ASSERT_EQ(step(file.scene, world, work), StepStatus::ok);
  }
}

// Between a drum and the next node rope hung through the turns on the drum: where it came off them
// to hang on the far side, and where the drum held a node already.
TEST(CablePath, RopeWithNodesDoesNotHangThroughItsDrum) {
  const SceneFile file = parse_scene(R"({"title": "hoist", "duration_s": 3, "view": "fit",
      "baseline": {"method": "cable", "reason": "none"},
      "bodies": [{"name": "drum", "kind": "fixed_axle", "radius_m": 0.2, "mass_kg": 5,
                  "position_m": [-1.5, 0],
                  "motor": [{"time_s": 0.3, "angular_velocity_rad_s": 0},
                            {"time_s": 1, "angular_velocity_rad_s": 5}]},
                 {"name": "sheave", "kind": "fixed_axle", "radius_m": 0.25, "mass_kg": 1,
                  "position_m": [1, 1]},
                 {"name": "load", "kind": "free", "mass_kg": 6, "position_m": [1.27, -1.5],
                  "corners_m": [[-0.25, -0.2], [0.25, -0.2], [0.25, 0.2], [-0.25, 0.2]]}],
      "cables": [{"name": "rope", "half_width_m": 0.015, "mass_per_metre_kg": 1, "nodes": 30,
                  "slack_m": 0.2, "start": {"body": "drum", "rim_angle_rad": 1, "layers": true},
                  "wraps": [{"body": "drum", "turn": "clockwise", "extra_turns": 1},
                            {"body": "sheave", "turn": "clockwise"}],
                  "end": {"body": "load", "point_m": [0, 0.2]}}]})",
                                     "hoist.json");
  World world = make_world(file.scene, Method::pinch);
  Workspace work;
  const CableState& cable = world.cables[0];
  int slack = 0, moored = 0;
  for (int frame = 0; frame < 180; ++frame) {
    std::size_t node = 2;  // the next that the drum does not hold
    if (cable.links[2].moored) ++node;
    if (cable.links[2].moored) ++moored;
    if (cable.segments[node].slack) ++slack;
    const double held = tail_material(cable, node, 0.0), radius = cable.links[1].radius;
    const std::vector<StripPoint> points = path_of(file, world);
    for (std::size_t i = points.size() - 1; i > 0; --i) {
      const double lies = cable.links[1].wrap * radius;
      if (points[i].material > held + 1e-9 || points[i].material < 0.8 * lies) continue;
      const double off = (points[i].position - world.position[0]).norm();
      EXPECT_GT(off, radius - 0.02) << "frame " << frame << ", " << i;
    }
    for (int s = 0; s < 4; ++s) ASSERT_EQ(step(file.scene, world, work), StepStatus::ok);
  }
  EXPECT_GE(slack, 10);
  EXPECT_GE(moored, 5);
}

// As a load came up to the pulley the loop below it went, and was there again in one frame as the
// rope left the pulley.
TEST(CablePath, SlackAtAShortEndHangsInALoop) {
  const SceneFile file = parse_scene(R"({"title": "nip", "duration_s": 2, "view": "fit",
      "baseline": {"method": "cable", "reason": "none"},
      "bodies": [{"name": "pulley", "kind": "fixed_axle", "radius_m": 0.4, "mass_kg": 2,
                  "position_m": [0, 0], "cable_friction": 0.3},
                 {"name": "left", "kind": "free", "radius_m": 0.15, "mass_kg": 1,
                  "position_m": [-0.45, -1]},
                 {"name": "right", "kind": "free", "radius_m": 0.15, "mass_kg": 1,
                  "position_m": [0.45, -1], "velocity_m_s": [0, 5]}],
      "cables": [{"name": "c", "half_width_m": 0.05, "start": {"body": "left", "point_m": [0, 0.1]},
                  "wraps": [{"body": "pulley", "turn": "clockwise"}],
                  "end": {"body": "right", "point_m": [0, 0.1]}}]})",
                                     "nip.json");
  World world = make_world(file.scene, Method::cable);
  Workspace work;
  const CableState& cable = world.cables[0];
  double shortest = 1.0;  // m
  for (int frame = 0; frame < 20; ++frame) {
    const std::vector<StripPoint> points = path_of(file, world);
    double length = 0.0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      length += (points[i].position - points[i - 1].position).norm();
    }
    EXPECT_NEAR(length, cable.length, 0.03 * cable.length) << frame;
    shortest = std::min(shortest, cable.segments.back().length);
    for (int s = 0; s < 4; ++s) ASSERT_EQ(step(file.scene, world, work), StepStatus::ok);
  }
  EXPECT_LT(shortest, 0.3);
}

}  // namespace
}  // namespace pinchlab
