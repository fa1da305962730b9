// SPDX-License-Identifier: GPL-3.0-or-later
// Compounds in scene files.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "demos/scenes/scene_json.h"
#include "sim/outline.h"
#include "tests/demos/scenes/scene_files.h"

namespace pinchlab {
namespace {

using nlohmann::json;

/// A plate and an eye above it in place of the left weight, on whose eye the rope is.
json compound_scene() {
  json scene = small_scene();
  json& body = scene["bodies"][1];
  body.erase("radius_m");
  body.erase("mass_kg");
  body["density_kg_m2"] = 50;
  body["angle_rad"] = 0.5;
  body["shapes"] = {
      {{"corners_m", {{0, 0}, {0.4, 0}, {0.4, 0.2}, {0, 0.2}}}, {"at_m", {-0.2, -0.1}}},
      {{"radius_m", 0.05},
       {"at_m", {0, 0.15}},
       {"angle_rad", 1.5},
       {"cable_friction", 0.25},
       {"contact_friction", 0.75},
       {"restitution", 0.125}}};
  scene["cables"][0]["start"] = {{"body", "left weight"}, {"point_m", {0, 0.15}}};
  scene["joints"] = {{{"name", "bar"},
                      {"kind", "distance"},
                      {"start", {{"body", "left weight"}, {"point_m", {0.1, 0}}}},
                      {"end", {{"world_m", {-2, -2}}}}}};
  return scene;
}

TEST(CompoundKeys, ReachTheirPlaces) {
  const SceneFile file = parse_scene(compound_scene().dump(), "s.json");
  const Scene& scene = file.scene;
  ASSERT_EQ(scene.bodies.size(), 5U);
  ASSERT_EQ(file.look.bodies.size(), 5U);
  const Body &compound = scene.bodies[1], &plate = scene.bodies[3], &eye = scene.bodies[4];
  EXPECT_FALSE(compound.outlined);
  EXPECT_EQ(plate.name, "left weight:1");
  EXPECT_EQ(eye.carrier, 1);
  EXPECT_EQ(eye.cable_friction, 0.25);
  EXPECT_EQ(eye.contact_friction, 0.75);
  EXPECT_EQ(eye.restitution, 0.125);
  EXPECT_EQ(file.look.bodies[4].label, "");

  // What the plates weigh together, and where; the origin of the file's frame is where it says.
  const double box = 0.08, disc = std::numbers::pi * 0.0025;
  const Vec2 centre(0.0, disc * 0.15 / (box + disc));
  EXPECT_NEAR(compound.mass, 50.0 * (box + disc), 1e-13);
  EXPECT_NEAR(*compound.inertia,
              50.0 * (box * (0.2 / 12.0 + centre.squaredNorm()) +
                      disc * (0.5 * 0.0025 + std::pow(0.15 - centre.y(), 2))),
              1e-13);
  const Vec2 origin = Vec2(-0.55, -2.0);
  EXPECT_NEAR((compound.position - origin - turned(centre, 0.5)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((plate.position - origin).norm(), 0.0, 1e-15);
  EXPECT_NEAR((eye.position - origin - turned(Vec2(0.0, 0.15), 0.5)).norm(), 0.0, 1e-15);
  EXPECT_EQ(eye.angle, 2.0);

  // Ends on the body are on the shape that is there; those of joints on the body itself.
  EXPECT_EQ(scene.cables[0].start.body, 4);
  EXPECT_NEAR(scene.cables[0].start.point.norm(), 0.0, 1e-15);
  EXPECT_EQ(scene.cables[1].start.body, 1);
  EXPECT_NEAR(
      (place_of(scene, scene.cables[1].start) - origin - turned(Vec2(0.1, 0.0), 0.5)).norm(), 0.0,
      1e-15);
}

// Whoever says mass and inertia says where the centre of mass is.
TEST(CompoundKeys, MassAndInertiaPutTheCentreAtTheOrigin) {
  json scene = compound_scene();
  json& body = scene["bodies"][1];
  body.erase("density_kg_m2");
  body["mass_kg"] = 3;
  body["inertia_kg_m2"] = 0.7;
  const Body read = parse_scene(scene.dump(), "s.json").scene.bodies[1];
  EXPECT_EQ(read.position, Vec2(-0.55, -2.0));
  EXPECT_EQ(read.inertia, 0.7);
}

std::string compound_error(const char* changes) {
  json scene = compound_scene();
  scene["bodies"][1].merge_patch(json::parse(changes));
  return error_of(scene.dump());
}

TEST(CompoundErrors, SayWhatIsWrongAndWhere) {
  const std::string at = "s.json: /bodies/1";
  EXPECT_EQ(compound_error(R"({"radius_m": 0.1, "restitution": 0.5})"),
            at +
                "/radius_m: has no effect on a body of shapes, each of which has its own; leave it "
                "out\n" +
                at +
                "/restitution: has no effect on a body of shapes, each of which has its own; leave "
                "it out");
  EXPECT_EQ(compound_error(R"({"shapes": []})"), at + "/shapes: must have 1 to 32 entries, not 0");
  EXPECT_EQ(compound_error(R"({"shapes": [{}]})"),
            at + "/shapes/0: radius_m is missing (or corners_m, of a polygon)");
  EXPECT_EQ(
      compound_error(R"({"shapes": [{"radius_m": 1, "corners_m": [[0, 0], [1, 0], [0, 1]]}]})"),
      at + "/shapes/0: radius_m makes it a disc and corners_m a polygon; leave one out");
  EXPECT_EQ(compound_error(R"({"shapes": [{"corners_m": [[0, 0], [0, 1], [1, 0]]}]})"),
            at + "/shapes/0/corners_m: must go round a convex polygon counter-clockwise, with no "
                 "corner on "
                 "a straight side");
  EXPECT_EQ(
      compound_error(R"({"shapes": [{"radius_m": 0.1, "mass_kg": 1}]})"),
      at +
          "/shapes/0/mass_kg: unknown key (known here: radius_m, corners_m, corner_radius_m, at_m, "
          "angle_rad, cable_friction, contact_friction, restitution)");
  EXPECT_EQ(
      compound_error(R"({"kind": "fixed_axle", "shapes": [{"radius_m": 0.4, "at_m": [0, 0.5]}]})"),
      at + "/shapes: have their centre of mass at [0, 0.5], off the axle; take that away from each "
           "at_m, hold a free body by a hinge, or give mass_kg and inertia_kg_m2");
}

// Where it must turn as a motor wants it a compound may be a cam, since its weight moves nothing;
// with a torque limit, or without a motor, mass and inertia say that its weight is at the axle.
TEST(CompoundKeys, ACamTurnsAboutItsAxle) {
  json scene = compound_scene();
  json& cam = scene["bodies"][0];
  cam = {{"name", "cam"},
         {"kind", "fixed_axle"},
         {"mass_kg", 2},
         {"position_m", {-4, 3}},
         {"shapes", json::parse(R"([{"radius_m": 0.2, "at_m": [0.1, 0]}])")},
         {"driven_angular_velocity_rad_s", 2}};
  for (const char* list : {"cables", "joints"}) scene.erase(list);
  const SceneFile file = parse_scene(scene.dump(), "s.json");
  const Body& read = file.scene.bodies[0];
  EXPECT_EQ(read.position, Vec2(-4.0, 3.0));
  EXPECT_NEAR(read.inertia.value(), 2.0 * (0.5 * 0.2 * 0.2 + 0.1 * 0.1), 1e-15);
  World world = start_world(file.scene, "s.json", Method::pinch);
  EXPECT_EQ(world.position[0], Vec2(-4.0, 3.0));
  cam["torque_limit_n_m"] = 1e3;
  EXPECT_NE(error_of(scene.dump()).find("off the axle"), std::string::npos);
  cam["inertia_kg_m2"] = 0.1;
  EXPECT_EQ(error_of(scene.dump()), "no error");
  cam.erase("torque_limit_n_m");
  EXPECT_NE(error_of(scene.dump()).find("a motor without torque_limit_n_m"), std::string::npos);
}

TEST(CompoundErrors, NamesAndEnds) {
  json scene = compound_scene();
  scene["bodies"][0]["name"] = "left weight:2";
  scene["cables"][0]["wraps"][0]["body"] = "left weight:2";
  EXPECT_EQ(error_of(scene.dump()),
            "s.json: /bodies/0/name: \"left weight:2\" is the name of a shape of body \"left "
            "weight\"; choose "
            "another");
  // Places are the file's, not those of the shapes in the scene.
  scene = compound_scene();
  scene["bodies"].push_back(scene["bodies"][1]);
  EXPECT_EQ(error_of(scene.dump()),
            "s.json: /bodies/3/name: \"left weight\" is the name of /bodies/1 already");
  scene = compound_scene();
  scene["cables"].push_back({{"name", "left weight"},
                             {"half_width_m", 0.01},
                             {"mass_per_metre_kg", 1},
                             {"nodes", 1},
                             {"slack_m", 0.1},
                             {"start", {{"world_m", {8, 8}}}},
                             {"end", {{"world_m", {9, 8}}}}});
  EXPECT_EQ(error_of(scene.dump()),
            "s.json: /cables/1/name: a node of it is called \"left weight:1\" in tables, as "
            "something else is; choose another name");
  scene = compound_scene();
  scene["cables"][0]["start"]["point_m"] = {0, 0.4};
  EXPECT_TRUE(error_of(scene.dump()).starts_with("s.json: /cables/0/start/point_m: lies 0.25"));
  scene = compound_scene();
  scene["cables"][0]["start"] = {{"body", "left weight"}, {"rim_angle_rad", 1}};
  EXPECT_EQ(
      error_of(scene.dump()),
      "s.json: /cables/0/start/rim_angle_rad: belongs to a disc; name one of the body's shapes, "
      "\"left weight:1\" for the first");
  scene = compound_scene();
  scene["cables"][0]["wraps"].push_back({{"body", "left weight"}, {"turn", "clockwise"}});
  const SceneFile file = parse_scene(scene.dump(), "s.json");
  try {
    start_world(file.scene, "s.json", Method::pinch);
    FAIL() << "no error";
  } catch (const SceneFileError& error) {
    EXPECT_STREQ(
        error.what(),
        "s.json: /cables/0: body 'left weight' has shapes; say which the cable runs round, "
        "'left weight:1' for the first");
  }
}

}  // namespace
}  // namespace pinchlab
