// SPDX-License-Identifier: GPL-3.0-or-later
// Every field of a scene that a program can set: what cannot be is refused by make_world, with its
// place, before anything reads it.

#include <functional>
#include <limits>

#include "sim/compound.h"
#include "sim/joints.h"
#include "sim/nodes.h"
#include "sim/outline.h"
#include "sim/scene_checks.h"
#include "sim/scene_error.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double tiny = std::numeric_limits<double>::denorm_min();
constexpr int huge = std::numeric_limits<int>::max();

// Indices in the scene below.
constexpr int drum = 0, load = 1, slider = 2, box = 3, frame = 4, shape = 5;
constexpr std::size_t over = 0, sagging = 1, bending = 2, spring = 3, loop = 4;

/// One of everything.
Scene scene_of_everything() {
  Scene scene;
  scene.steps_per_frame = 16;
  scene.bodies = {body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.3, 1.0),
                  body("load", BodyKind::free, -0.33, -1.5, 0.1, 1.0),
                  body("slider", BodyKind::rail, 3.0, 0.0, 0.1, 1.0),
                  body("box", BodyKind::free, 5.0, 0.0, 0.1, 1.0),
                  body("frame", BodyKind::free, 7.0, 0.0, 0.1, 1.0)};
  make_polygon(scene.bodies[box], {{-0.1, -0.1}, {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}}, 0.01);
  scene.bodies[drum].motor = {{0.0, 0.0}, {1.0, 0.1}};
  Shape disc;
  disc.properties.radius = 0.1;
  disc.place = {0.2, 0.0};
  add_shapes(scene, frame, std::array{disc, disc});
  scene.cables = {cable(on(load), {{drum, -1, 0}}, at(0.33, -1.0), 0.03),
                  cable(at(10.0, 0.0), {}, at(11.0, 0.0), 0.01),
                  cable(at(12.0, 0.0), {}, at(13.0, 0.0), 0.01)};
  for (const std::size_t c : {sagging, bending}) {
    scene.cables[c].mass_per_metre = 1.0;
    scene.cables[c].nodes = 3;
    scene.cables[c].slack = 0.1;
  }
  scene.cables[sagging].node_tolerance = 1e-3;
  scene.cables[bending].bending_stiffness = 1e-3;
  add_spring(scene, "spring", on(slider), at(3.0, 2.0), 10.0, 0.0, 0.0);
  scene.bodies.push_back(body("left", BodyKind::fixed_axle, 20.0, 0.0, 0.2, 1.0));
  scene.bodies.push_back(body("right", BodyKind::fixed_axle, 21.0, 0.0, 0.2, 1.0));
  const int left = static_cast<int>(scene.bodies.size()) - 2;
  scene.cables.push_back(cable({}, {{left, 1, 0}, {left + 1, 1, 0}}, {}, 0.01));
  scene.cables[loop].closed = true;
  scene.cables[loop].axial_stiffness = 1e4;
  scene.walls.push_back({Vec2(-3.0, -9.0), Vec2(3.0, -9.0), 0.5, 0.0});
  spread_nodes(scene);
  return scene;
}

struct Wrong {
  const char* field;
  const char* place;
  const char* words;  // of the message
  std::function<void(Scene&)> spoil;
};

void expect_all_refused(const std::vector<Wrong>& table) {
  for (const Wrong& wrong : table) {
    Scene scene = scene_of_everything();
    wrong.spoil(scene);
    try {
      make_world(scene, Method::pinch);
      ADD_FAILURE() << "accepted: " << wrong.field;
    } catch (const SceneError& error) {
      EXPECT_EQ(error.place, wrong.place) << wrong.field;
      EXPECT_NE(error.message.find(wrong.words), std::string::npos)
          << wrong.field << ": " << error.message;
    }
  }
}

/// A double in each of the ways that it may be wrong.
std::vector<Wrong> each(const char* field, const char* place, const char* words,
                        std::function<double&(Scene&)> figure, const std::vector<double>& values) {
  std::vector<Wrong> table;
  for (const double value : values) {
    table.push_back({field, place, words, [figure, value](Scene& s) { figure(s) = value; }});
  }
  return table;
}

const std::vector<double> not_finite = {nan, infinity, -infinity};
const std::vector<double> not_positive = {nan, infinity, -1.0, 0.0, tiny};
const std::vector<double> not_0_or_more = {nan, infinity, -1.0};
const std::vector<double> not_a_share = {nan, infinity, -0.1, 1.1};

TEST(Figures, OneOfEverythingIsAccepted) {
  const Scene scene = scene_of_everything();
  ASSERT_EQ(scene.chains.size(), 1u);
  for (const Method method : {Method::pinch, Method::pinch_no_contact, Method::cable}) {
    EXPECT_NO_THROW(make_world(scene, method));
  }
  EXPECT_NO_THROW(make_world(Scene(), Method::pinch));
}

TEST(Figures, OfBodies) {
  const auto refused = [](const char* field, const char* words, auto figure,
                          const std::vector<double>& values) {
    expect_all_refused(each(
        field, "/bodies/1", words, [figure](Scene& s) -> double& { return figure(s.bodies[load]); },
        values));
  };
  refused(
      "radius", "radius", [](Body& b) -> double& { return b.radius; }, not_positive);
  refused("mass", "mass", [](Body& b) -> double& { return b.mass; },
          {nan, infinity, -1.0, 0.0, 0.5 * lightest_body, 2.0 * heaviest_body});
  refused(
      "inertia", "inertia", [](Body& b) -> double& { return b.inertia.emplace(); }, not_positive);
  refused(
      "position", "finite", [](Body& b) -> double& { return b.position.y(); }, not_finite);
  refused(
      "velocity", "finite", [](Body& b) -> double& { return b.velocity.x(); }, not_finite);
  refused(
      "angle", "finite", [](Body& b) -> double& { return b.angle; }, not_finite);
  refused(
      "angular_velocity", "finite", [](Body& b) -> double& { return b.angular_velocity; },
      not_finite);
  refused(
      "driven_angular_velocity", "finite",
      [](Body& b) -> double& { return b.driven_angular_velocity.emplace(); }, not_finite);
  refused(
      "torque", "finite", [](Body& b) -> double& { return b.torque; }, not_finite);
  refused("torque_limit", "torque limit", [](Body& b) -> double& { return b.torque_limit; },
          {nan, -1.0, 0.0, tiny});
  refused(
      "linear_drag", "drag", [](Body& b) -> double& { return b.linear_drag; }, not_0_or_more);
  refused(
      "angular_drag", "drag", [](Body& b) -> double& { return b.angular_drag; }, not_0_or_more);
  refused("cable_friction", "cable friction", [](Body& b) -> double& { return b.cable_friction; },
          {nan, -1.0});
  refused(
      "contact_friction", "contact friction", [](Body& b) -> double& { return b.contact_friction; },
      not_0_or_more);
  refused(
      "restitution", "restitution", [](Body& b) -> double& { return b.restitution; }, not_a_share);
}

TEST(Figures, OfBodiesOfSomeKinds) {
  expect_all_refused({
      {"kind", "/bodies/1", "kind", [](Scene& s) { s.bodies[load].kind = BodyKind(17); }},
      {"kind", "/bodies/1", "kind", [](Scene& s) { s.bodies[load].kind = BodyKind(-1); }},
      {"mass, fixed", "/bodies/1", "mass",
       [](Scene& s) {
         s.bodies[load].kind = BodyKind::fixed;
         s.bodies[load].mass = nan;
       }},
      {"mass, of a node", "/bodies/9", "mass",
       [](Scene& s) { s.bodies[index(s.chains[0].first_body)].mass = tiny; }},
      {"radius, too little to have an inertia", "/bodies/1", "inertia",
       [](Scene& s) { s.bodies[load].radius = 1e-200; }},
      {"rail_axis", "/bodies/2", "unit",
       [](Scene& s) {
         s.bodies[slider].rail_axis = {0.0, 2.0};
       }},
      {"rail_axis", "/bodies/2", "unit", [](Scene& s) { s.bodies[slider].rail_axis.x() = nan; }},
      {"motor, time", "/bodies/0", "table", [](Scene& s) { s.bodies[drum].motor[0].time = -1.0; }},
      {"motor, time", "/bodies/0", "table", [](Scene& s) { s.bodies[drum].motor[0].time = nan; }},
      {"motor, time", "/bodies/0", "table", [](Scene& s) { s.bodies[drum].motor[1].time = 0.0; }},
      {"motor, value", "/bodies/0", "table", [](Scene& s) { s.bodies[drum].motor[1].value = nan; }},
      {"node", "/bodies/3", "node", [](Scene& s) { s.bodies[box].node = true; }},
      {"corners", "/bodies/3", "finite", [](Scene& s) { s.bodies[box].corners[0].x() = nan; }},
      {"corners", "/bodies/3", "3 to 64", [](Scene& s) { s.bodies[box].corners.resize(2); }},
      {"corners", "/bodies/3", "convex",
       [](Scene& s) { std::swap(s.bodies[box].corners[0], s.bodies[box].corners[1]); }},
      {"corners", "/bodies/3", "centre of mass",
       [](Scene& s) {
         for (Vec2& corner : s.bodies[box].corners) corner.x() += 0.01;
       }},
      {"corner_radius", "/bodies/3", "finite",
       [](Scene& s) { s.bodies[box].corner_radius = -1.0; }},
      {"corner_radius", "/bodies/3", "finite", [](Scene& s) { s.bodies[box].corner_radius = nan; }},
      {"radius of a polygon", "/bodies/3", "circle", [](Scene& s) { s.bodies[box].radius = 0.05; }},
      {"inertia of a polygon", "/bodies/3", "inertia",
       [](Scene& s) { s.bodies[box].inertia.reset(); }},
  });
}

TEST(Figures, OfShapes) {
  expect_all_refused({
      {"carrier", "/bodies/5", "add_shapes", [](Scene& s) { s.bodies[shape].carrier = -7; }},
      {"carrier", "/bodies/5", "add_shapes", [](Scene& s) { s.bodies[shape].carrier = huge; }},
      {"carrier", "/bodies/5", "add_shapes", [](Scene& s) { s.bodies[shape].carrier = shape; }},
      {"carrier, with an outline", "/bodies/5", "add_shapes",
       [](Scene& s) { s.bodies[shape].carrier = box; }},
      {"carrier, a shape", "/bodies/6", "add_shapes",
       [](Scene& s) { s.bodies[shape + 1].carrier = shape; }},
      {"mass", "/bodies/5", "add_shapes", [](Scene& s) { s.bodies[shape].mass = 1.0; }},
      {"outlined", "/bodies/5", "add_shapes", [](Scene& s) { s.bodies[shape].outlined = false; }},
      {"seat", "/bodies/5", "seat", [](Scene& s) { s.bodies[shape].seat.x() = nan; }},
      {"seat", "/bodies/5", "reach", [](Scene& s) { s.bodies[shape].seat.x() = 1e6; }},
      {"seat_angle", "/bodies/5", "seat", [](Scene& s) { s.bodies[shape].seat_angle = infinity; }},
      {"kind", "/bodies/5", "fixed", [](Scene& s) { s.bodies[shape].kind = BodyKind::rail; }},
      {"driven", "/bodies/5", "motor",
       [](Scene& s) { s.bodies[shape].driven_angular_velocity = 1.0; }},
      {"torque", "/bodies/5", "motor", [](Scene& s) { s.bodies[shape].torque = 1.0; }},
      {"motor", "/bodies/5", "motor",
       [](Scene& s) {
         s.bodies[shape].motor = {{0.0, 1.0}};
       }},
  });
}

TEST(Figures, OfCables) {
  const auto refused = [](const char* field, const char* words, auto figure,
                          const std::vector<double>& values) {
    expect_all_refused(each(
        field, "/cables/0", words, [figure](Scene& s) -> double& { return figure(s.cables[over]); },
        values));
  };
  refused(
      "half_width", "half width", [](Cable& c) -> double& { return c.half_width; }, not_positive);
  refused("slack", "slack", [](Cable& c) -> double& { return c.slack; },
          {nan, infinity, -infinity, -0.1});
  refused("axial_stiffness", "stiffness", [](Cable& c) -> double& { return c.axial_stiffness; },
          {nan, -1.0, 0.0, tiny});
  refused(
      "damping", "damping", [](Cable& c) -> double& { return c.damping; }, not_0_or_more);
  refused(
      "squeeze", "squeeze", [](Cable& c) -> double& { return c.squeeze; }, not_a_share);
  refused(
      "grip", "grip", [](Cable& c) -> double& { return c.grip; }, not_a_share);
  refused("mass_per_metre", "mass", [](Cable& c) -> double& { return c.mass_per_metre; },
          {nan, infinity, -1.0, tiny});
  refused("node_tolerance", "nodes", [](Cable& c) -> double& { return c.node_tolerance; },
          {nan, infinity, -1.0, 1.0});
  refused("bending_stiffness", "bends", [](Cable& c) -> double& { return c.bending_stiffness; },
          {nan, infinity, -1.0, 1.0});
  refused(
      "bend", "bends", [](Cable& c) -> double& { return c.bend; }, not_0_or_more);
  refused(
      "contact_friction", "friction", [](Cable& c) -> double& { return c.contact_friction; },
      not_0_or_more);
  refused(
      "linear_drag", "drag", [](Cable& c) -> double& { return c.linear_drag; }, not_0_or_more);
  refused(
      "start.point", "finite", [](Cable& c) -> double& { return c.start.point.x(); }, not_finite);
  refused(
      "end.point", "finite", [](Cable& c) -> double& { return c.end.point.y(); }, not_finite);
}

TEST(Figures, OfCourses) {
  expect_all_refused({
      {"nodes", "/cables/0", "nodes", [](Scene& s) { s.cables[over].nodes = -5; }},
      {"nodes", "/cables/0", "nodes", [](Scene& s) { s.cables[over].nodes = 5; }},
      {"joint", "/cables/0", "joint", [](Scene& s) { s.cables[over].joint = Joint(9); }},
      {"joint", "/cables/0", "joint", [](Scene& s) { s.cables[over].joint = Joint(-1); }},
      {"joint, wrapped", "/cables/0", "straight",
       [](Scene& s) { s.cables[over].joint = Joint::bar; }},
      {"rod, wrapped", "/cables/0", "straight", [](Scene& s) { s.cables[over].rod = true; }},
      {"piece, wrapped", "/cables/0", "straight", [](Scene& s) { s.cables[over].piece = true; }},
      {"closed", "/cables/0", "two bodies", [](Scene& s) { s.cables[over].closed = true; }},
      {"closed, a rod", "/cables/4", "straight", [](Scene& s) { s.cables[loop].rod = true; }},
      {"start.body", "/cables/0", "not in", [](Scene& s) { s.cables[over].start.body = -2; }},
      {"end.body", "/cables/0", "not in", [](Scene& s) { s.cables[over].end.body = huge; }},
      {"start.layers", "/cables/0", "rim", [](Scene& s) { s.cables[over].start.layers = true; }},
      {"end.layers", "/cables/0", "rim", [](Scene& s) { s.cables[over].end.layers = true; }},
      {"end.body", "/cables/3", "alone", [](Scene& s) { s.cables[spring].end.body = slider; }},
      {"wraps.body", "/cables/0", "not in", [](Scene& s) { s.cables[over].wraps[0].body = -1; }},
      {"wraps.body", "/cables/0", "not in", [](Scene& s) { s.cables[over].wraps[0].body = huge; }},
      {"wraps.body", "/cables/0", "shapes", [](Scene& s) { s.cables[over].wraps[0].body = frame; }},
      {"wraps.orientation", "/cables/0", "orientation",
       [](Scene& s) { s.cables[over].wraps[0].orientation = 0; }},
      {"wraps.orientation", "/cables/0", "orientation",
       [](Scene& s) { s.cables[over].wraps[0].orientation = -huge - 1; }},
      {"wraps.extra_turns", "/cables/0", "turns",
       [](Scene& s) { s.cables[over].wraps[0].extra_turns = -1; }},
      {"wraps.extra_turns", "/cables/0", "turns",
       [](Scene& s) { s.cables[over].wraps[0].extra_turns = huge; }},
      {"wraps, twice", "/cables/0", "succession",
       [](Scene& s) { s.cables[over].wraps.push_back(s.cables[over].wraps[0]); }},
      {"wraps, twice", "/cables/4", "succession",
       [](Scene& s) { s.cables[loop].wraps.push_back(s.cables[loop].wraps[0]); }},
      {"bends_with", "/cables/2", "not in", [](Scene& s) { s.cables[bending].bends_with = -7; }},
      {"bends_with", "/cables/2", "not in", [](Scene& s) { s.cables[bending].bends_with = huge; }},
      {"bends_with", "/cables/2", "goes on",
       [](Scene& s) { s.cables[bending].bends_with = static_cast<int>(bending); }},
      {"bends_with", "/cables/2", "goes on",
       [](Scene& s) { s.cables[bending].bends_with = static_cast<int>(sagging); }},
      {"mass_per_metre, hanging", "/cables/3", "spread_nodes",
       [](Scene& s) { s.cables[spring].mass_per_metre = 1.0; }},
  });
}

// What spreads nodes reads where cables run before make_world does.
TEST(Figures, OfCoursesBeforeThereAreNodes) {
  Scene hanging;
  hanging.bodies = {body("load", BodyKind::free, 0.0, -1.0, 0.1, 1.0)};
  hanging.cables = {cable(at(0.0, 0.0), {}, on(0), 0.01), cable(at(1.0, 0.0), {}, on(0), 0.01)};
  hanging.cables[0].mass_per_metre = 1.0;
  for (const int body : {-2, 1, 1000}) {
    Scene scene = hanging;
    scene.cables[0].end.body = body;
    EXPECT_THROW(spread_nodes(scene), SceneError) << body;
    scene = hanging;
    scene.cables[1].start.body = body;
    EXPECT_THROW(spread_nodes(scene), SceneError) << body;
    scene = hanging;
    scene.cables[1].wraps = {{body, 1, 0}};
    EXPECT_THROW(spread_nodes(scene), SceneError) << body;
  }
  EXPECT_NO_THROW(spread_nodes(hanging));
}

TEST(Figures, OfWalls) {
  const auto refused = [](const char* field, const char* words, auto figure,
                          const std::vector<double>& values) {
    expect_all_refused(each(
        field, "/walls/0", words, [figure](Scene& s) -> double& { return figure(s.walls[0]); },
        values));
  };
  refused(
      "a", "length", [](Wall& w) -> double& { return w.a.x(); }, not_finite);
  refused(
      "b", "length", [](Wall& w) -> double& { return w.b.y(); }, not_finite);
  refused("b", "length", [](Wall& w) -> double& { return w.b.x(); }, {-3.0});
  refused(
      "contact_friction", "friction", [](Wall& w) -> double& { return w.contact_friction; },
      not_0_or_more);
  refused(
      "restitution", "restitution", [](Wall& w) -> double& { return w.restitution; }, not_a_share);
}

TEST(Figures, OfChains) {
  const auto refused = [](const char* field, const char* words, auto spoil) {
    expect_all_refused({{field, "/chains/0", words, [spoil](Scene& s) { spoil(s.chains[0]); }}});
  };
  for (const int wrong : {-1, huge}) {
    refused("cable", "not in", [wrong](NodeChain& c) { c.cable = wrong; });
    refused("first_piece", "not in", [wrong](NodeChain& c) { c.first_piece = wrong; });
    refused("first_body", "not in", [wrong](NodeChain& c) { c.first_body = wrong; });
    refused("pieces", "not in", [wrong](NodeChain& c) { c.pieces = wrong; });
  }
  refused("pieces", "not in", [](NodeChain& c) { c.pieces = 3; });
  refused("cable", "follow", [](NodeChain& c) { c.cable = static_cast<int>(bending); });
  refused("first_body", "follow", [](NodeChain& c) { ++c.first_body; });
  for (const double wrong : not_positive) {
    refused("piece_length", "above 0", [wrong](NodeChain& c) { c.piece_length = wrong; });
    refused("mass_per_metre", "above 0", [wrong](NodeChain& c) { c.mass_per_metre = wrong; });
    refused("tolerance", "above 0", [wrong](NodeChain& c) { c.tolerance = wrong; });
  }
  expect_all_refused(
      {{"two of one cable", "/chains/1", "not in",
        [](Scene& s) { s.chains.push_back(s.chains[0]); }},
       {"node", "/chains/0", "none",
        [](Scene& s) { s.bodies[index(s.chains[0].first_body)].node = false; }},
       {"gravity", "/chains/0", "gravity", [](Scene& s) { s.gravity = Vec2::Zero(); }}});
}

TEST(Figures, OfTheScene) {
  expect_all_refused({
      {"gravity", "/gravity_m_s2", "finite", [](Scene& s) { s.gravity.y() = -infinity; }},
      {"error", "/error_m", "error", [](Scene& s) { s.error = nan; }},
      {"error", "/error_m", "error", [](Scene& s) { s.error = infinity; }},
      {"frames_per_second", "/frames_per_second", "at least 1",
       [](Scene& s) { s.frames_per_second = 0; }},
      {"steps_per_frame", "/frames_per_second", "at least 1",
       [](Scene& s) { s.steps_per_frame = -3; }},
      {"frame_count", "/duration_s", "one frame", [](Scene& s) { s.frame_count = 0; }},
      {"view", "/view", "finite", [](Scene& s) { s.view.low.x() = nan; }},
      {"view", "/view", "above", [](Scene& s) { s.view.high.y() = s.view.low.y(); }},
      {"baseline", "/baseline", "methods", [](Scene& s) { s.baseline = Method(7); }},
      {"apart", "/apart/0", "in the scene",
       [](Scene& s) {
         s.apart[0] = {0, huge};
       }},
      {"apart", "/apart/0", "in the scene",
       [](Scene& s) {
         s.apart[0] = {-5, 1};
       }},
      {"apart", "/apart/0", "ascend",
       [](Scene& s) {
         s.apart[0] = {2, 1};
       }},
      {"apart", "/apart/1", "ascend",
       [](Scene& s) { s.apart.insert(s.apart.begin(), s.apart.front()); }},
  });
}

}  // namespace
}  // namespace pinchlab::testing
