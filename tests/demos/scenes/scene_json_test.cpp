// SPDX-License-Identifier: GPL-3.0-or-later
// Good scenes: every key reaches its place, and what is left out keeps its default.

#include "demos/scenes/scene_json.h"
#include "base/sha256.h"

#include <gtest/gtest.h>

#include "demos/scenes/find_scenes.h"
#include "tests/base/temporary_folder.h"
#include "tests/demos/scenes/scene_files.h"

namespace pinchlab {
namespace {

using nlohmann::json;

SceneFile parse(const json& scene) {
  return parse_scene(scene.dump(), "folder/07-some_name.json");
}

TEST(SceneJson, WhatIsLeftOutKeepsItsDefault) {
  const SceneFile file = parse(json::parse(R"({
    "title": "Least", "duration_s": 3, "view": {"low_m": [0, 0], "high_m": [1, 2]},
    "bodies": [{"name": "a", "kind": "free", "radius_m": 0.3, "mass_kg": 2, "position_m": [1, 2]}],
    "cables": [{"name": "c", "half_width_m": 0.01, "start": {"world_m": [0, 5]}, "end": {"body": "a"}}],
    "walls": [{"from_m": [0, 0], "to_m": [1, 0]}],
    "baseline": {"method": "pinch_no_contact", "reason": "r"}})"));
  const Scene& scene = file.scene;
  const Scene fresh;
  EXPECT_EQ(scene.name, "07-some_name");
  EXPECT_EQ(scene.gravity, fresh.gravity);
  EXPECT_EQ(scene.frames_per_second, fresh.frames_per_second);
  EXPECT_EQ(scene.steps_per_frame, fresh.steps_per_frame);
  EXPECT_EQ(scene.frame_count, 180);
  EXPECT_EQ(file.poster_time, 1.5);

  const Body& body = scene.bodies.at(0);
  const Body plain;
  EXPECT_FALSE(body.inertia);
  EXPECT_FALSE(body.driven_angular_velocity);
  EXPECT_EQ(body.angle, 0.0);
  EXPECT_EQ(body.velocity, Vec2(0, 0));
  EXPECT_EQ(body.angular_velocity, 0.0);
  EXPECT_EQ(body.torque, 0.0);
  EXPECT_EQ(body.linear_drag, 0.0);
  EXPECT_EQ(body.angular_drag, 0.0);
  EXPECT_EQ(body.cable_friction, infinity);
  EXPECT_EQ(body.contact_friction, plain.contact_friction);
  EXPECT_EQ(body.restitution, 0.0);

  const Cable& cable = scene.cables.at(0);
  EXPECT_FALSE(cable.closed);
  EXPECT_TRUE(cable.wraps.empty());
  EXPECT_EQ(cable.slack, 0.0);
  EXPECT_EQ(cable.axial_stiffness, infinity);
  EXPECT_TRUE(cable.creep);
  EXPECT_EQ(cable.end.point, Vec2(0, 0));
  EXPECT_EQ(scene.walls.at(0).contact_friction, Wall().contact_friction);
  EXPECT_EQ(scene.walls.at(0).restitution, 0.0);
}

TEST(SceneJson, EveryKeyReachesItsPlace) {
  const SceneFile file = parse(json::parse(R"({
    "$schema": "scene.schema.json", "title": "All \u00e9", "notes": "n", "gravity_m_s2": [1, -2],
    "duration_s": 0.5, "frames_per_second": 24.0, "steps_per_frame": 7, "poster_time_s": 0.25,
    "view": {"low_m": [-1, -2], "high_m": [3, 4]},
    "bodies": [
      {"name": "free one", "kind": "free", "radius_m": 0.1, "mass_kg": 2, "inertia_kg_m2": 0.3, "position_m": [4, 5],
       "angle_rad": 0.6, "velocity_m_s": [0.7, 0.8], "angular_velocity_rad_s": 0.9, "torque_n_m": 1.1,
       "linear_drag_per_s": 1.2, "angular_drag_per_s": 1.3, "cable_friction": 0.14, "contact_friction": 0.15,
       "restitution": 0.16},
      {"name": "railed", "kind": "rail", "rail_axis": [3, 4], "radius_m": 0.2, "mass_kg": 1, "position_m": [0, 0],
       "velocity_m_s": [0.6, 0.8], "driven_angular_velocity_rad_s": -3.5, "cable_friction": "no_slip"},
      {"name": "axle", "kind": "fixed_axle", "radius_m": 0.2, "mass_kg": 1, "position_m": [9, 9],
       "motor": [{"time_s": 0.5, "angular_velocity_rad_s": 2}, {"time_s": 1, "angular_velocity_rad_s": -3}]},
      {"name": "post", "kind": "fixed", "radius_m": 0.2, "position_m": [-9, 9], "angle_rad": 1}],
    "cables": [
      {"name": "open", "half_width_m": 0.02, "start": {"world_m": [1, 1]}, "end": {"body": "post", "point_m": [0.1, 0.1]},
       "wraps": [{"body": "axle", "turn": "clockwise"}, {"body": "railed", "turn": "counter_clockwise", "extra_turns": 2}],
       "slack_m": -0.5, "axial_stiffness_n": 1000, "creep": false, "squeeze": 0.25, "grip": 0.75},
      {"name": "loop", "half_width_m": 0.03, "closed": true, "slack_m": 0.25,
       "wraps": [{"body": "axle", "turn": "clockwise"}, {"body": "post", "turn": "clockwise"}]}],
    "walls": [{"from_m": [1, 2], "to_m": [3, 4], "contact_friction": 0.6, "restitution": 0.7}],
    "baseline": {"method": "cable", "reason": "because"}})"));
  const Scene& scene = file.scene;
  EXPECT_EQ(scene.title, "All \u00e9");
  EXPECT_EQ(scene.gravity, Vec2(1, -2));
  EXPECT_EQ(scene.frame_count, 12);
  EXPECT_EQ(scene.frames_per_second, 24);
  EXPECT_EQ(scene.steps_per_frame, 7);
  EXPECT_EQ(file.poster_time, 0.25);
  EXPECT_EQ(scene.view.low, Vec2(-1, -2));
  EXPECT_EQ(scene.view.high, Vec2(3, 4));
  EXPECT_EQ(scene.baseline, Method::cable);
  EXPECT_EQ(scene.baseline_reason, "because");

  const Body& free = scene.bodies.at(0);
  EXPECT_EQ(free.name, "free one");
  EXPECT_EQ(free.kind, BodyKind::free);
  EXPECT_EQ(free.radius, 0.1);
  EXPECT_EQ(free.mass, 2.0);
  EXPECT_EQ(free.inertia, 0.3);
  EXPECT_EQ(free.position, Vec2(4, 5));
  EXPECT_EQ(free.angle, 0.6);
  EXPECT_EQ(free.velocity, Vec2(0.7, 0.8));
  EXPECT_EQ(free.angular_velocity, 0.9);
  EXPECT_EQ(free.torque, 1.1);
  EXPECT_EQ(free.linear_drag, 1.2);
  EXPECT_EQ(free.angular_drag, 1.3);
  EXPECT_EQ(free.cable_friction, 0.14);
  EXPECT_EQ(free.contact_friction, 0.15);
  EXPECT_EQ(free.restitution, 0.16);
  const Body& railed = scene.bodies.at(1);
  EXPECT_EQ(railed.kind, BodyKind::rail);
  EXPECT_TRUE(railed.rail_axis.isApprox(Vec2(0.6, 0.8), 1e-15));
  EXPECT_EQ(railed.driven_angular_velocity, -3.5);
  EXPECT_EQ(railed.cable_friction, infinity);
  const Body& axle = scene.bodies.at(2);
  EXPECT_EQ(axle.kind, BodyKind::fixed_axle);
  EXPECT_EQ(axle.driven_angular_velocity, 2.0);
  ASSERT_EQ(axle.motor.size(), 2U);
  EXPECT_EQ(axle.motor[1].time, 1.0);
  EXPECT_EQ(axle.motor[1].value, -3.0);
  EXPECT_TRUE(railed.motor.empty());
  EXPECT_EQ(scene.bodies.at(3).kind, BodyKind::fixed);

  const Cable& open = scene.cables.at(0);
  EXPECT_EQ(open.name, "open");
  EXPECT_EQ(open.half_width, 0.02);
  EXPECT_FALSE(open.closed);
  EXPECT_EQ(open.start.body, -1);
  EXPECT_EQ(open.start.point, Vec2(1, 1));
  EXPECT_EQ(open.end.body, 3);
  EXPECT_EQ(open.end.point, Vec2(0.1, 0.1));
  EXPECT_EQ(open.squeeze, 0.25);
  EXPECT_EQ(open.grip, 0.75);
  ASSERT_EQ(open.wraps.size(), 2U);
  EXPECT_EQ(open.wraps[0].body, 2);
  EXPECT_EQ(open.wraps[0].orientation, -1);
  EXPECT_EQ(open.wraps[0].extra_turns, 0);
  EXPECT_EQ(open.wraps[1].body, 1);
  EXPECT_EQ(open.wraps[1].orientation, 1);
  EXPECT_EQ(open.wraps[1].extra_turns, 2);
  EXPECT_EQ(open.slack, -0.5);
  EXPECT_EQ(open.axial_stiffness, 1000.0);
  EXPECT_FALSE(open.creep);
  EXPECT_TRUE(scene.cables.at(1).closed);
  EXPECT_EQ(scene.cables.at(1).slack, 0.25);

  const Wall& wall = scene.walls.at(0);
  EXPECT_EQ(wall.a, Vec2(1, 2));
  EXPECT_EQ(wall.b, Vec2(3, 4));
  EXPECT_EQ(wall.contact_friction, 0.6);
  EXPECT_EQ(wall.restitution, 0.7);
}

TEST(SceneJson, LimitsThemselvesAreAllowed) {
  json scene = small_scene();
  scene["bodies"][0]["mass_kg"] = 1e12;
  scene["bodies"][0]["restitution"] = 1;
  scene["bodies"][1]["mass_kg"] = 1e-9;
  scene["steps_per_frame"] = 1000;
  EXPECT_EQ(parse(scene).scene.bodies[0].mass, 1e12);
}

TEST(SceneJson, Sha256IsTheFiles) {
  const test::TemporaryFolder folder;
  const std::string path = folder.write("08-hash.json", small_scene().dump());
  EXPECT_EQ(read_scene_file(path).sha256, sha256_of_file(path));
}

// The geometry is the simulator's to check; the reader's places must be right for it.
TEST(SceneJson, ImpossibleGeometryIsToldWithThePlaceInTheFile) {
  const auto error = [](const json& scene) -> std::string {
    const SceneFile file = parse(scene);
    try {
      start_world(file.scene, file.path, Method::pinch);
    } catch (const SceneFileError& e) {
      return e.what();
    }
    return "no error";
  };
  const std::string name = "folder/07-some_name.json: ";
  EXPECT_EQ(error(small_scene()), "no error");
  json overlap = small_scene();
  overlap["bodies"][2]["position_m"] = {0.55, -0.3};
  EXPECT_TRUE(error(overlap).starts_with(name + "/bodies/2: ")) << error(overlap);
  json through_wall = small_scene();
  through_wall["walls"][0] = {{"from_m", {-3, -2}}, {"to_m", {3, -2}}};
  EXPECT_TRUE(error(through_wall).starts_with(name + "/bodies/1: ")) << error(through_wall);
  json through_body = small_scene();
  through_body["bodies"].push_back(
      {{"name", "post"}, {"kind", "fixed"}, {"radius_m", 0.1}, {"position_m", {-0.5, -1}}});
  EXPECT_TRUE(error(through_body).starts_with(name + "/cables/0")) << error(through_body);
}

TEST(SceneJson, EveryDemonstrationReadsAndStartsUnderEveryMethod) {
  const std::filesystem::path demos = std::string(PINCHLAB_SOURCE_DIR) + "/demos";
  for (const auto& path : find_scenes({demos})) {
    const SceneFile file = read_scene_file(path);
    for (const Method method : {Method::pinch, Method::pinch_no_contact, Method::cable}) {
      EXPECT_NO_THROW(start_world(file.scene, path, method)) << path;
    }
  }
}

}  // namespace
}  // namespace pinchlab
