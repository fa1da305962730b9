// SPDX-License-Identifier: GPL-3.0-or-later
// Keys that have an effect only beside others, and what their author is told.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/demos/scenes/scene_files.h"

namespace pinchlab {
namespace {

using nlohmann::json;

TEST(SceneErrors, KeysWithoutEffectAreRefused) {
  const auto refused = [](const char* kind, const char* key, const char* value, bool driven) {
    json scene = small_scene();
    json& body = scene["bodies"][0];
    body["kind"] = kind;
    if (std::string(kind) == "fixed") {
      body.erase("mass_kg");
    }
    if (driven) {
      body["driven_angular_velocity_rad_s"] = 1;
    }
    body[key] = json::parse(value);
    return error_of(scene.dump());
  };
  const auto message = [](const char* key, const char* why) {
    return fmt::format("s.json: /bodies/0/{}: has no effect on {}; leave it out", key, why);
  };
  for (const char* key : {"mass_kg", "inertia_kg_m2", "angular_velocity_rad_s", "torque_n_m",
                          "driven_angular_velocity_rad_s", "torque_limit_n_m", "linear_drag_per_s",
                          "angular_drag_per_s"}) {
    EXPECT_EQ(refused("fixed", key, "1", false), message(key, "a fixed body"));
  }
  EXPECT_EQ(refused("fixed", "velocity_m_s", "[0, 0]", false),
            message("velocity_m_s", "a fixed body"));
  EXPECT_EQ(refused("fixed_axle", "linear_drag_per_s", "1", false),
            message("linear_drag_per_s", "a fixed_axle body"));
  for (const char* key : {"inertia_kg_m2", "angular_velocity_rad_s"}) {
    EXPECT_EQ(refused("fixed_axle", key, "1", true),
              message(key, "a motor without torque_limit_n_m"));
  }
  EXPECT_EQ(
      refused("fixed_axle", "torque_limit_n_m", "1", false),
      message("torque_limit_n_m",
              "a body without driven_angular_velocity_rad_s or a motor of angular velocities"));
  for (const char* key : {"torque_n_m", "angular_drag_per_s"}) {
    EXPECT_EQ(refused("fixed_axle", key, "1", true),
              message(key, "a body whose angular velocity is driven"));
  }
}

TEST(SceneErrors, MotorsAreTablesOfOneThingInOrder) {
  const auto error = [](const char* key, const char* value) {
    json scene = small_scene();
    scene["bodies"][0][key] = json::parse(value);
    if (std::string(key) != "motor") {
      scene["bodies"][0]["motor"] = {{{"time_s", 0}, {"angular_velocity_rad_s", 1}}};
    }
    return error_of(scene.dump());
  };
  const std::string one_thing =
      "needs time_s and either angular_velocity_rad_s or torque_n_m, the same in all";
  EXPECT_EQ(error("motor", "[]"), "s.json: /bodies/0/motor: must have 1 to 1000 entries, not 0");
  EXPECT_EQ(error("motor", R"([{"time_s": 0}])"), "s.json: /bodies/0/motor/0: " + one_thing);
  EXPECT_EQ(error("motor", R"([{"time_s": 0, "torque_n_m": 1},
                               {"time_s": 1, "angular_velocity_rad_s": 1}])"),
            "s.json: /bodies/0/motor/1: " + one_thing);
  EXPECT_EQ(error("motor", R"([{"time_s": 0, "torque_n_m": 1, "angular_velocity_rad_s": 1}])"),
            "s.json: /bodies/0/motor/0: " + one_thing);
  EXPECT_EQ(error("motor", R"([{"time_s": 1, "torque_n_m": 1}, {"time_s": 1, "torque_n_m": 2}])"),
            "s.json: /bodies/0/motor/1/time_s: must be after the one before, 1; a jump takes two "
            "points a little apart");
  EXPECT_EQ(error("motor", R"([{"time_s": -1, "torque_n_m": 1}])"),
            "s.json: /bodies/0/motor/0/time_s: must be 0 to 3600, not -1");
  const auto no_effect = [](const char* key, const char* on) {
    return fmt::format("s.json: /bodies/0/{}: has no effect on {}; leave it out", key, on);
  };
  for (const char* key : {"torque_n_m", "angular_drag_per_s"}) {
    EXPECT_EQ(error(key, "1"), no_effect(key, "a body whose angular velocity is driven"));
  }
  for (const char* key : {"inertia_kg_m2", "angular_velocity_rad_s"}) {
    EXPECT_EQ(error(key, "1"), no_effect(key, "a motor without torque_limit_n_m"));
  }
  EXPECT_EQ(error("torque_limit_n_m", "1"), "no error");
  EXPECT_EQ(error("torque_limit_n_m", "0"),
            "s.json: /bodies/0/torque_limit_n_m: must be 1e-12 to 1e+12, not 0");
  EXPECT_EQ(error("driven_angular_velocity_rad_s", "1"),
            "s.json: /bodies/0/motor: has no effect on a body whose angular velocity is driven; "
            "leave it out");
}

TEST(SceneErrors, GripNeedsABodyThatSlips) {
  json scene = small_scene();
  for (json& body : scene["bodies"]) body.erase("cable_friction");
  for (const double grip : {0.0, 1.0}) {
    scene["cables"][0]["grip"] = grip;
    EXPECT_EQ(error_of(scene.dump()), "no error");
  }
  scene["cables"][0]["grip"] = 0.5;
  EXPECT_EQ(error_of(scene.dump()),
            "s.json: /cables/0/grip: has no effect but as 0 or 1 where no body has a "
            "cable_friction above 0 other than \"no_slip\"; give one to the body that is to slip");
  scene["bodies"][0]["cable_friction"] = 0.1;
  EXPECT_EQ(error_of(scene.dump()), "no error");
  scene["cables"][0]["grip"] = 1.5;
  EXPECT_EQ(error_of(scene.dump()), "s.json: /cables/0/grip: must be 0 to 1, not 1.5");
  scene["cables"][0]["squeeze"] = -0.5;
  scene["cables"][0].erase("grip");
  EXPECT_EQ(error_of(scene.dump()), "s.json: /cables/0/squeeze: must be 0 to 1, not -0.5");
}

TEST(SceneErrors, OutlinesAreDiscsOrConvexPolygons) {
  const auto error = [](const char* changes) {
    json scene = small_scene();
    scene["bodies"][0].merge_patch(json::parse(changes));
    return error_of(scene.dump());
  };
  const std::string corners = R"([[-1, -1], [1, -1], [1, 1], [-1, 1]])";
  const auto polygon = [&](const std::string& rest) {
    return error((R"({"radius_m": null, "corners_m": )" + corners + rest + "}").c_str());
  };
  EXPECT_EQ(error((R"({"corners_m": )" + corners + "}").c_str()),
            "s.json: /bodies/0: radius_m makes it a disc and corners_m a polygon; leave one out");
  EXPECT_EQ(error(R"({"radius_m": null})"),
            "s.json: /bodies/0: radius_m is missing (or corners_m, of a polygon)");
  EXPECT_EQ(error(R"({"corner_radius_m": 0.1})"),
            "s.json: /bodies/0/corner_radius_m: has no effect on a disc; leave it out");
  EXPECT_EQ(error(R"({"density_kg_m2": 3})"),
            "s.json: /bodies/0: mass_kg and density_kg_m2 both say how heavy it is; leave one out");
  EXPECT_EQ(polygon(R"(, "corner_radius_m": -1)"),
            "s.json: /bodies/0/corner_radius_m: must be 0 to 10000, not -1");
  for (const char* wrong : {"[[0, 0], [1, 0], [2, 0], [1, 1]]", "[[0, 0], [0, 1], [1, 0]]",
                            "[[0, 0], [0, 0], [0, 0]]"}) {
    EXPECT_EQ(
        error((std::string(R"({"radius_m": null, "corners_m": )") + wrong + "}").c_str()),
        "s.json: /bodies/0/corners_m: must go round a convex polygon counter-clockwise, with no "
        "corner on a straight side");
  }
  EXPECT_EQ(error(R"({"radius_m": null, "corners_m": [[0, 0], [1, 0]]})"),
            "s.json: /bodies/0/corners_m: must have 3 to 64 entries, not 2");
  EXPECT_EQ(error(R"({"radius_m": null, "corners_m": [[0, 0], [1], [0, 1]]})"),
            "s.json: /bodies/0/corners_m/1: must be a list of two numbers, [x, y]");
  EXPECT_EQ(error(R"({"radius_m": null, "corners_m": [[0, 0], [1, 1e5], [0, 1]]})"),
            "s.json: /bodies/0/corners_m/1/1: must be -10000 to 10000, not 100000.0");
}

TEST(SceneErrors, LayersBelongToARim) {
  const auto error = [](const char* start) {
    json scene = small_scene();
    scene["cables"][0]["start"] = json::parse(start);
    return error_of(scene.dump());
  };
  EXPECT_EQ(error(R"({"world_m": [-2, -2], "layers": true})"),
            "s.json: /cables/0/start/layers: belongs to body, not to world_m; leave one out");
  EXPECT_EQ(
      error(R"({"body": "left weight", "layers": true})"),
      "s.json: /cables/0/start/layers: belongs to an end on a disc's rim; give rim_angle_rad too");
  EXPECT_EQ(error(R"({"body": "wheel", "rim_angle_rad": 3, "layers": 1})"),
            "s.json: /cables/0/start/layers: must be true or false, not a number");
  EXPECT_EQ(error(R"({"body": "wheel", "rim_angle_rad": 3, "layers": true})"), "no error");
}

TEST(SceneErrors, ARimNeedsTheCableRoundIt) {
  const auto error = [](const char* end, const char* rim, const char* wraps) {
    json scene = small_scene();
    scene["cables"][0][end] = json::parse(rim);
    scene["cables"][0]["wraps"] = json::parse(wraps);
    return error_of(scene.dump());
  };
  const char* const wheel = R"([{"body": "wheel", "turn": "clockwise"}])";
  EXPECT_EQ(error("start", R"({"body": "wheel", "rim_angle_rad": 3})", wheel), "no error");
  EXPECT_EQ(error("end", R"({"body": "wheel", "rim_angle_rad": 3})", wheel), "no error");
  EXPECT_EQ(error("start", R"({"body": "wheel", "rim_angle_rad": 3})", "[]"),
            "s.json: /cables/0/start/rim_angle_rad: needs the cable to run round \"wheel\": the "
            "first of its wraps must be on that body; add it, or give point_m instead");
  EXPECT_EQ(error("end", R"({"body": "right weight", "rim_angle_rad": 3})", wheel),
            "s.json: /cables/0/end/rim_angle_rad: needs the cable to run round \"right weight\": "
            "the last of its wraps must be on that body; add it, or give point_m instead");
  EXPECT_EQ(error("end", R"({"body": "right wieght", "rim_angle_rad": 3})", wheel),
            "s.json: /cables/0/end/body: no body is called \"right wieght\" (did you mean \"right "
            "weight\"?)");
}

json hanging_scene() {
  json scene = small_scene();
  scene["cables"] =
      json::parse(R"([{"name": "chain", "half_width_m": 0.01, "start": {"world_m": [-2, 2]},
    "end": {"world_m": [2, 2]}, "slack_m": 0.5, "mass_per_metre_kg": 0.3, "nodes": 9}])");
  return scene;
}

TEST(SceneErrors, CablesWithMassLieOnTheirNodes) {
  const auto error = [](const char* changes) {
    json scene = hanging_scene();
    scene["cables"][0].merge_patch(json::parse(changes));
    return error_of(scene.dump());
  };
  EXPECT_EQ(error("{}"), "no error");
  EXPECT_EQ(error(R"({"wraps": [{"body": "wheel", "turn": "clockwise"}]})"), "no error");
  EXPECT_EQ(error(R"({"wraps": [{"body": "wheel", "turn": "clockwise"}], "nodes": null,
                      "linear_drag_per_s": 1})"),
            "s.json: /cables/0/linear_drag_per_s: has no effect on a cable with mass_per_metre_kg "
            "that runs over bodies and has no nodes; leave it out");
  EXPECT_EQ(error(R"({"wraps": [{"body": "wheel", "turn": "clockwise"}],
                      "node_tolerance_m": 0.01})"),
            "no error");
  EXPECT_EQ(error(R"({"wraps": [{"body": "wheel", "turn": "clockwise"}], "nodes": null,
                      "node_tolerance_m": 0.01})"),
            "s.json: /cables/0/node_tolerance_m: has no effect on a cable with mass_per_metre_kg "
            "that runs over bodies and has no nodes; leave it out");
  EXPECT_EQ(error(R"({"wraps": [{"body": "wheel", "turn": "clockwise"}], "nodes": null,
                      "axial_stiffness_n": 1000, "creep": true})"),
            "no error");
  EXPECT_EQ(error(R"({"wraps": [{"body": "wheel", "turn": "clockwise"}],
                      "axial_stiffness_n": 1000, "creep": true})"),
            "no error");
  EXPECT_EQ(error(R"({"nodes": "automatic"})"), "no error");
  EXPECT_EQ(error(R"({"wraps": [{"body": "wheel", "turn": "clockwise"}], "nodes": "automatic",
                      "linear_drag_per_s": 1})"),
            "no error");
  EXPECT_EQ(error(R"({"nodes": "many"})"),
            "s.json: /cables/0/nodes: must be a whole number or \"automatic\", not \"many\"");
  EXPECT_EQ(error(R"({"nodes": true})"),
            "s.json: /cables/0/nodes: must be a whole number or \"automatic\", not a boolean");
  EXPECT_EQ(error(R"({"nodes": 2.5})"), "s.json: /cables/0/nodes: must be a whole number, not 2.5");
  EXPECT_EQ(error(R"({"nodes": 1000})"),
            "s.json: /cables/0/nodes: pieces of 4.5 mm between nodes are no longer than the cable "
            "is wide; at most "
            "224 nodes fit");
  EXPECT_EQ(
      error(R"({"mass_per_metre_kg": null})"),
      "s.json: /cables/0/nodes: has no effect on a cable without mass_per_metre_kg; leave it out");
  EXPECT_EQ(
      error(R"({"grip": 0})"),
      "s.json: /cables/0/grip: has no effect on a cable with mass_per_metre_kg; leave it out");
  EXPECT_EQ(error(R"({"mass_per_metre_kg": null, "nodes": null, "bending_stiffness_n_m2": 1})"),
            "s.json: /cables/0/bending_stiffness_n_m2: has no effect on a cable without "
            "mass_per_metre_kg; leave it out");
  EXPECT_EQ(error(R"({"bending_stiffness_n_m2": 0.01})"), "no error");
  EXPECT_NE(error(R"({"bending_stiffness_n_m2": 1000})").find("more steps a frame"),
            std::string::npos);
  EXPECT_EQ(error(R"({"bending_stiffness_n_m2": -1})"),
            "s.json: /cables/0/bending_stiffness_n_m2: must be 0 to 1e+09, not -1");
  EXPECT_EQ(error(R"({"mass_per_metre_kg": 0})"),
            "s.json: /cables/0/mass_per_metre_kg: must be 1e-09 to 1e+09, not 0");
  EXPECT_EQ(error(R"({"node_tolerance_m": 0.002, "nodes": 15})"), "no error");
  EXPECT_EQ(error(R"({"node_tolerance_m": 0.002, "nodes": null})"), "no error");
  EXPECT_EQ(error(R"({"node_tolerance_m": 0.002})"),
            "s.json: /cables/0/nodes: pieces of a cable whose number of nodes adapts become one in "
            "pairs, so that it has 1, 3, 7, 15 and so on at most; 7 or 15, not 9");
  EXPECT_EQ(error(R"({"mass_per_metre_kg": null, "nodes": null, "node_tolerance_m": 0.002})"),
            "s.json: /cables/0/node_tolerance_m: has no effect on a cable without "
            "mass_per_metre_kg; leave it out");
  EXPECT_EQ(error(R"({"node_tolerance_m": 0.002, "nodes": 15, "bending_stiffness_n_m2": 0.01})"),
            "s.json: /cables/0/node_tolerance_m: only cables that neither stretch nor resist "
            "bending adapt their number of nodes; leave out the stiffness, or the tolerance");
  EXPECT_EQ(error(R"({"node_tolerance_m": 0.002, "nodes": 15,
                      "end": {"world_m": null, "body": "wheel", "point_m": [0.2, 0]}})")
                .substr(0, 23),
            "s.json: /cables/0/end: ");
  json many = hanging_scene();
  for (int i = 0; i < 60; ++i) {
    json another = many["cables"][0];
    another["name"] = fmt::format("chain {}", i);
    another.erase("nodes");
    many["cables"].push_back(another);
  }
  EXPECT_EQ(error_of(many.dump()),
            "s.json: /cables/51: cables with mass up to this one may have more than 10000 nodes; "
            "give them fewer "
            "with nodes");
  json scene = hanging_scene();
  scene["bodies"][0]["name"] = "chain:3";
  EXPECT_EQ(error_of(scene.dump()),
            "s.json: /bodies/0/name: \"chain:3\" is the name of a node of a cable; choose another");
  scene = hanging_scene();
  scene["cables"].push_back({{"name", "chain:3"},
                             {"half_width_m", 0.01},
                             {"start", {{"world_m", {8, 8}}}},
                             {"end", {{"world_m", {9, 8}}}}});
  EXPECT_EQ(error_of(scene.dump()),
            "s.json: /cables/0/name: a piece of it is called \"chain:3\" in tables, as something "
            "else is; choose another name");
}

/// The small scene with one joint: `changes` to a rod from its wheel to a weight.
std::string joint_error(const char* changes) {
  json scene = small_scene();
  scene["joints"] = {{{"name", "rod"},
                      {"kind", "distance"},
                      {"start", {{"body", "wheel"}, {"point_m", {0.7, 0}}}},
                      {"end", {{"body", "left weight"}}}}};
  scene["joints"][0].merge_patch(json::parse(changes));
  return error_of(scene.dump());
}

TEST(SceneErrors, JointsSayWhatTheyLack) {
  const std::string at = "s.json: /joints/0";
  EXPECT_EQ(joint_error("{}"), "no error");
  EXPECT_EQ(joint_error(R"({"end": null})"), at + ": end is missing");
  EXPECT_EQ(
      joint_error(R"({"end": {"world_m": [0, 0]}})"),
      at + "/end: give either world_m (a point that does not move) or body (and point_m on it)");
  EXPECT_EQ(joint_error(R"({"end": {"body": "left wieght"}})"),
            at + "/end/body: no body is called \"left wieght\" (did you mean \"left weight\"?)");
  EXPECT_EQ(joint_error(R"({"end": {"body": "wheel"}})"),
            at + ": both of its ends are on one body; let one be elsewhere");
  EXPECT_EQ(joint_error(R"({"start": {"body": null, "point_m": null, "world_m": [-0.55, -2]}})"),
            at + ": its ends lie in one place; move them apart, or use a hinge");
  EXPECT_EQ(joint_error(R"({"stiffness_n_m": 1})"),
            at + "/stiffness_n_m: has no effect on a joint that is no spring; leave it out");
  EXPECT_EQ(joint_error(R"({"kind": "spring"})"), at + ": stiffness_n_m is missing");
  EXPECT_EQ(joint_error(R"({"kind": "spring", "stiffness_n_m": 0})"),
            at + "/stiffness_n_m: must be 1e-06 to 1e+15, not 0");
  EXPECT_EQ(joint_error(R"({"kind": "hinge"})"),
            at + "/start: has no effect on a hinge; leave it out\n" + at +
                "/end: has no effect on a hinge; leave it out\n" + at + ": body is missing\n" + at +
                ": at_m is missing");
  EXPECT_EQ(joint_error(R"({"kind": "hinge", "start": null, "end": null, "body": "wheel",
                            "other": "wheel", "at_m": [0, 0]})"),
            at + ": both of its ends are on one body; let one be elsewhere");
  EXPECT_EQ(joint_error(R"({"name": "rope"})"),
            "s.json: /joints/0/name: \"rope\" is the name of /cables/0 already");
  EXPECT_EQ(joint_error(R"({"kind": "hinge", "name": "rope", "start": null, "end": null,
                            "body": "wheel", "at_m": [0, 0]})"),
            at + "/name: \"rope\" is the name of /cables/0 already");
}

TEST(SceneErrors, PartsOfJointsHaveNamesOfTheirOwn) {
  json scene = small_scene();
  json pin = {{"name", "pin"}, {"kind", "hinge"}, {"body", "left weight"}, {"at_m", {-0.55, -2}}};
  json other = pin;
  other["body"] = "right weight";
  scene["joints"] = {pin, other};
  EXPECT_EQ(error_of(scene.dump()),
            "s.json: /joints/1/name: \"pin\" is the name of /joints/0 already");
  scene["cables"][0]["name"] = "pin:y";
  scene["joints"] = json::array({pin});
  EXPECT_EQ(error_of(scene.dump()),
            "s.json: /joints/0/name: a part of it is called \"pin:y\" in tables, as something else "
            "is; choose another name");
  scene["cables"][0]["name"] = "right weight:low";
  scene["bodies"][2]["travel_m"] = {-1, 1};
  EXPECT_EQ(error_of(scene.dump()),
            "s.json: /bodies/2/name: a part of it is called \"right weight:low\" in tables, as "
            "something else is; choose another name");
}

// Nothing moves that they could hold.
TEST(SceneErrors, JointsBetweenFixedBodiesDoNothing) {
  json scene = small_scene();
  for (const char* name : {"post", "beam"}) {
    scene["bodies"].push_back({{"name", name},
                               {"kind", "fixed"},
                               {"radius_m", 0.1},
                               {"position_m", {name == std::string("post") ? 3.0 : 4.0, 3.0}}});
  }
  const auto error = [&scene](const char* joint) {
    scene["joints"] = {json::parse(joint)};
    return error_of(scene.dump());
  };
  EXPECT_EQ(error(R"({"name": "pin", "kind": "hinge", "body": "post", "at_m": [3, 3]})"),
            "s.json: /joints/0: holds the fixed body \"post\" to the world, where it does nothing; "
            "leave it out, or let one of the two move");
  EXPECT_EQ(error(R"({"name": "bar", "kind": "distance", "start": {"world_m": [0, 3]},
                      "end": {"body": "beam"}})"),
            "s.json: /joints/0: holds the fixed body \"beam\" to the world, where it does nothing; "
            "leave it out, or let one of the two move");
  EXPECT_EQ(error(R"({"name": "bar", "kind": "distance", "start": {"body": "post"},
                      "end": {"body": "beam"}})"),
            "s.json: /joints/0: holds the fixed body \"post\" to \"beam\", which is fixed too, "
            "where it does nothing; leave it out, or let one of the two move");
  EXPECT_EQ(error(R"({"name": "bar", "kind": "distance", "start": {"body": "post"},
                      "end": {"body": "left weight"}})"),
            "no error");
}

TEST(SceneErrors, CreepNeedsARimThatCreeps) {
  json scene = small_scene();
  scene["cables"][0]["axial_stiffness_n"] = 1000;
  scene["cables"][0]["creep"] = true;
  EXPECT_EQ(error_of(scene.dump()), "no error");
  const std::string none =
      "s.json: /cables/0/creep: has no effect where all that the cable runs round is drums with "
      "layers or, of one with mass_per_metre_kg, bodies with cable_friction 0; leave it out";
  for (const double friction : {0.0, 0.3}) {
    json slips = scene;
    slips["bodies"][0]["cable_friction"] = friction;
    EXPECT_EQ(error_of(slips.dump()), "no error");
    slips["cables"][0]["mass_per_metre_kg"] = 0.1;
    EXPECT_EQ(error_of(slips.dump()), friction == 0.0 ? none : "no error");
  }
  json fills = scene;
  fills["cables"][0]["end"] = {{"body", "wheel"}, {"rim_angle_rad", 0}, {"layers", true}};
  EXPECT_EQ(error_of(fills.dump()), none);
  scene["bodies"][0].erase("radius_m");
  scene["bodies"][0]["corners_m"] = {{-0.4, -0.4}, {0.4, -0.4}, {0.4, 0.4}, {-0.4, 0.4}};
  EXPECT_EQ(error_of(scene.dump()), "no error");
}

// Not less than mass_kg itself may be.
TEST(SceneErrors, DensitiesGiveAMassWithinRange) {
  json scene = small_scene();
  json& weight = scene["bodies"][1];
  weight.erase("mass_kg");
  weight["density_kg_m2"] = 1e-12;
  EXPECT_EQ(
      error_of(scene.dump()),
      "s.json: /bodies/1/density_kg_m2: makes a body of 1.26e-13 kg of it, whose mass must be "
      "1e-09 to 1e+12 kg");
  weight["density_kg_m2"] = 1e-8;
  EXPECT_EQ(error_of(scene.dump()), "no error");
}

TEST(SceneErrors, TravelEndsOnEitherSideOfTheStart) {
  const auto error = [](int body, const char* travel) {
    json scene = small_scene();
    scene["bodies"][static_cast<std::size_t>(body)]["travel_m"] = json::parse(travel);
    return error_of(scene.dump());
  };
  const std::string wrong =
      "s.json: /bodies/2/travel_m: must be [low, high], how far it may go either way from where it "
      "starts: low at most 0, high at least 0, and room between them";
  EXPECT_EQ(error(2, "[-1, 0]"), "no error");
  EXPECT_EQ(error(2, "[0, 0]"), wrong);
  EXPECT_EQ(error(2, "[0.1, 1]"), wrong);
  EXPECT_EQ(error(2, "[1, -1]"), wrong);
  EXPECT_EQ(
      error(0, "[-1, 1]"),
      "s.json: /bodies/0/travel_m: has no effect on a body that is not on a rail; leave it out");
}

TEST(SceneJson, JointsComeBeforePiecesBetweenNodes) {
  json scene = hanging_scene();
  scene["joints"] = {{{"name", "pin"},
                      {"kind", "hinge"},
                      {"body", scene["bodies"][0]["name"]},
                      {"at_m", {0.3, 0.2}},
                      {"look", {{"colour", "#102030"}}}}};
  const SceneFile file = parse_scene(scene.dump(), "s.json");
  ASSERT_EQ(file.scene.cables.size(), 12U);
  ASSERT_EQ(file.look.cables.size(), 12U);
  EXPECT_EQ(file.scene.cables[1].name, "pin:x");
  EXPECT_EQ(file.scene.cables[2].name, "pin:y");
  EXPECT_EQ(file.scene.cables[2].joint, Joint::pin);
  EXPECT_EQ(file.look.cables[2].colour->blue, 0x30);
  EXPECT_FALSE(file.look.cables[9].colour.has_value());
}

TEST(SceneJson, NodesFollowTheBodiesOfTheFile) {
  const SceneFile file = parse_scene(hanging_scene().dump(), "s.json");
  ASSERT_EQ(file.scene.bodies.size(), 12U);
  EXPECT_EQ(file.scene.bodies[3].name, "chain:1");
  EXPECT_TRUE(file.scene.bodies[3].node);
  EXPECT_EQ(file.scene.cables.size(), 10U);
  EXPECT_EQ(file.look.bodies.size(), 12U);
  EXPECT_EQ(file.look.cables.size(), 10U);
  EXPECT_NEAR(file.scene.bodies[3].mass, 0.3 * 0.45, 1e-12);
}

TEST(SceneJson, MassAndInertiaFollowFromAnOutlineAndADensity) {
  json scene = small_scene();
  json& body = scene["bodies"][0];
  body.erase("radius_m");
  body.erase("mass_kg");
  body["corners_m"] = {{-0.2, -0.1}, {0.2, -0.1}, {0.2, 0.1}, {-0.2, 0.1}};
  body["density_kg_m2"] = 50;
  const Body read = parse_scene(scene.dump(), "s.json").scene.bodies[0];
  EXPECT_NEAR(read.mass, 4.0, 1e-14);
  EXPECT_NEAR(read.inertia.value(), 4.0 * (0.16 + 0.04) / 12.0, 1e-15);
  EXPECT_NEAR(read.radius, std::hypot(0.2, 0.1), 1e-15);
}

}  // namespace
}  // namespace pinchlab
