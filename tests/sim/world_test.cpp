// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes whose geometry cannot be are refused, with place and cure.

#include <limits>
#include <numbers>

#include "sim/outline.h"
#include "sim/scene_error.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

void expect_refused(const Scene& scene, const std::string& place, const std::string& words) {
  for (const Method method : {Method::pinch, Method::pinch_no_contact, Method::cable}) {
    try {
      make_world(scene, method);
      ADD_FAILURE() << "accepted, expected " << place << ": ..." << words;
    } catch (const SceneError& error) {
      EXPECT_EQ(error.place, place) << error.what();
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
}

Scene drum_scene() {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.5, 1.0));
  scene.cables.push_back(cable(at(-1.0, -2.0), {{0, -1, 0}}, at(1.0, -2.0)));
  return scene;
}

TEST(MakeWorld, RefusesOverlappingBodies) {
  Scene scene = drum_scene();
  scene.bodies.push_back(body("roller", BodyKind::free, 0.0, 0.7, 0.25, 1.0));
  expect_refused(scene, "/bodies/1", "overlaps body 'drum' by 50 mm");
}

TEST(MakeWorld, RefusesABodyInAWall) {
  Scene scene = drum_scene();
  scene.walls.push_back({Vec2(-1.0, 0.4), Vec2(1.0, 0.4), 0.5, 0.0});
  expect_refused(scene, "/bodies/0", "overlaps wall 0 by 100 mm");
}

// Of sharp corners, which no rounding gives a gap: by the shortest way out, whatever crosses what.
TEST(MakeWorld, RefusesAPolygonAcrossAWall) {
  const auto refused = [](const Vec2& from, const Vec2& to, const std::string& depth) {
    Scene scene;
    Body box = body("box", BodyKind::free, 0.0, 0.0, 0.1);
    make_polygon(box, {{-0.1, -0.1}, {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}}, 0.0);
    scene.bodies = {box};
    scene.walls.push_back({from, to, 0.5, 0.0});
    expect_refused(scene, "/bodies/0", "body 'box' overlaps wall 0 by " + depth);
  };
  refused({-1.0, 0.0}, {1.0, 0.0}, "100 mm");
  refused({-1.0, 0.04}, {1.0, 0.04}, "60 mm");
  refused({0.07, -1.0}, {0.07, 0.02}, "30 mm");    // out to its right
  refused({0.0, 0.08}, {0.0, 1.0}, "20 mm");       // its end is inside
  refused({-0.05, 0.09}, {0.05, 0.085}, "15 mm");  // all of it is
}

// A scene that a program makes has passed no reader.
TEST(MakeWorld, RefusesFiguresThatCannotBe) {
  const auto refused = [](const std::string& place, const std::string& words, auto spoil) {
    Scene scene = drum_scene();
    spoil(scene);
    expect_refused(scene, place, words);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused("/bodies/0", "mass", [](Scene& s) { s.bodies[0].mass = -1.0; });
  refused("/bodies/0", "mass", [nan](Scene& s) { s.bodies[0].mass = nan; });
  refused("/bodies/0", "radius", [](Scene& s) { s.bodies[0].radius = 0.0; });
  refused("/bodies/0", "inertia", [](Scene& s) { s.bodies[0].inertia = -0.1; });
  refused("/bodies/0", "finite", [nan](Scene& s) { s.bodies[0].position.x() = nan; });
  refused("/bodies/0", "finite", [nan](Scene& s) { s.bodies[0].angle = nan; });
  refused("/bodies/0", "finite", [nan](Scene& s) { s.bodies[0].angular_velocity = nan; });
  refused("/bodies/0", "finite", [](Scene& s) { s.bodies[0].driven_angular_velocity = infinity; });
  refused("/bodies/0", "finite", [nan](Scene& s) { s.bodies[0].torque = nan; });
  refused("/bodies/0", "drag", [](Scene& s) { s.bodies[0].linear_drag = -0.1; });
  refused("/bodies/0", "drag", [](Scene& s) { s.bodies[0].angular_drag = infinity; });
  refused("/bodies/0", "cable friction", [nan](Scene& s) { s.bodies[0].cable_friction = nan; });
  refused("/bodies/0", "contact friction", [](Scene& s) { s.bodies[0].contact_friction = -1.0; });
  refused("/bodies/0", "restitution", [](Scene& s) { s.bodies[0].restitution = 2.0; });
  refused("/bodies/0", "unit vector", [](Scene& s) {
    s.bodies[0].kind = BodyKind::rail;
    s.bodies[0].rail_axis = {0.0, 2.0};
  });
  refused("/gravity_m_s2", "finite", [nan](Scene& s) { s.gravity.x() = nan; });
  refused("/cables/0", "slack", [](Scene& s) { s.cables[0].slack = -0.1; });
  refused("/cables/0", "half width", [](Scene& s) { s.cables[0].half_width = 0.0; });
  refused("/cables/0", "not in the scene", [](Scene& s) { s.cables[0].wraps[0].body = 1; });
  refused("/cables/0", "not in the scene", [](Scene& s) { s.cables[0].end.body = 7; });
  refused("/cables/0", "orientation", [](Scene& s) { s.cables[0].wraps[0].orientation = 0; });
  refused("/walls/0", "length", [](Scene& s) {
    s.walls.push_back({Vec2(3.0, 3.0), Vec2(3.0, 3.0), 0.5, 0.0});
  });
}

TEST(MakeWorld, AFixedDrivenBodyTurnsFromTheStart) {
  Scene scene = drum_scene();
  scene.bodies[0].kind = BodyKind::fixed;
  scene.bodies[0].driven_angular_velocity = 2.0;
  EXPECT_EQ(make_world(scene, Method::pinch).angular_velocity[0], 2.0);
}

// What is allowed to overlap is a share of the scene, so that small ones are judged as strictly.
TEST(MakeWorld, JudgesScenesOfAnySizeAlike) {
  for (const double size : {1e-6, 1.0, 1e6}) {
    for (const double overlap : {1e-12, 1e-3}) {
      Scene scene;
      scene.bodies.push_back(body("a", BodyKind::free, 0.0, 0.0, size, 1.0));
      scene.bodies.push_back(body("b", BodyKind::free, (2.0 - overlap) * size, 0.0, size, 1.0));
      if (overlap < 1e-9) {
        EXPECT_NO_THROW(make_world(scene, Method::pinch)) << size;
      } else {
        EXPECT_THROW(make_world(scene, Method::pinch), SceneError) << size;
      }
    }
  }
}

TEST(MakeWorld, RefusesACableThroughABody) {
  Scene scene = drum_scene();
  scene.bodies.push_back(body("roller", BodyKind::free, -0.95, -1.5, 0.2, 1.0));
  expect_refused(scene, "/cables/0", "runs through body 'roller'");
}

TEST(MakeWorld, RefusesAnEndInsideThePulley) {
  Scene scene = drum_scene();
  scene.cables[0].start.point = {-0.5, 0.1};
  expect_refused(scene, "/cables/0/wraps/0", "the cable's end lies");
}

TEST(MakeWorld, RefusesASqueezedCable) {
  Scene scene = drum_scene();
  scene.bodies.push_back(body("roller", BodyKind::free, 0.0, 0.8, 0.25, 1.0));
  expect_refused(scene, "/bodies/1", "squeezes a cable on body 'drum'");
}

TEST(MakeWorld, RefusesTooNarrowACrossing) {
  Scene scene;
  scene.bodies.push_back(body("lower", BodyKind::fixed_axle, 0.0, 0.0, 0.5, 1.0));
  scene.bodies.push_back(body("upper", BodyKind::fixed_axle, 0.0, 1.05, 0.5, 1.0));
  scene.cables.push_back(cable(at(-2.0, -1.0), {{0, -1, 0}, {1, 1, 0}}, at(2.0, 2.0)));
  expect_refused(scene, "/cables/0/wraps/1", "does not fit between");
}

TEST(MakeWorld, RefusesAWrapTheWrongWayRound) {
  Scene scene = drum_scene();
  scene.cables[0] = cable(at(-2.0, 0.6), {{0, -1, 0}}, at(2.0, 0.6));
  expect_refused(scene, "/cables/0/wraps/0", "the other `turn`");
}

TEST(MakeWorld, RefusesAnEndOffTheRimItIsWoundOn) {
  Scene scene = drum_scene();
  scene.cables[0] = cable(at(-2.0, -0.6), {{0, -1, 1}}, {0, {0.5, 0.0}});
  expect_refused(scene, "/cables/0/end", "must lie at its rim");
}

TEST(MakeWorld, RefusesAnEndOffThePolygonItIsWoundOn) {
  Scene scene = drum_scene();
  make_polygon(scene.bodies[0], {{-0.3, -0.3}, {0.3, -0.3}, {0.3, 0.3}, {-0.3, 0.3}}, 0.0);
  const std::vector<std::pair<double, const char*>> off_the_rim{
      {0.0, "0.3 m inside"}, {-0.3, "0 m"}, {-0.31, "0.01 m"}};
  for (const auto& [x, where] : off_the_rim) {
    scene.cables[0] = cable({0, {x, 0.0}}, {{0, -1, 0}}, at(0.4, -2.0), 0.02);
    expect_refused(scene, "/cables/0/start",
                   std::string("must lie at its rim, 0.02 m outside of one of its sides (half "
                               "width), not ") +
                       where);
  }
  scene.cables[0] = cable(at(-0.4, -2.0), {{0, -1, 0}}, {0, {0.0, 0.0}}, 0.02);
  expect_refused(scene, "/cables/0/end", "must lie at its rim, 0.02 m outside");
  scene.cables[0] = cable({0, {-0.32, 0.0}}, {{0, -1, 0}}, at(0.4, -2.0), 0.02);
  EXPECT_NO_THROW(make_world(scene, Method::pinch));
}

// No wrap takes a cable out of a body that its end lies in.
TEST(MakeWorld, RefusesAnEndInsideABody) {
  Scene scene = drum_scene();
  scene.cables[0] = cable(at(0.0, 0.1), {}, at(2.0, 0.0));
  expect_refused(scene, "/cables/0/start", "the cable's end lies 450 mm inside of body 'drum'");
  scene.cables[0] = cable(at(2.0, 0.0), {}, at(0.0, 0.1));
  expect_refused(scene, "/cables/0/end", "fix the end to the body");
  scene.cables[0] = cable({0, {0.0, 0.1}}, {}, at(2.0, 0.0));
  EXPECT_NO_THROW(make_world(scene, Method::pinch));
  scene.cables[0] = cable(at(-2.0, 0.1), {}, at(2.0, 0.0));
  expect_refused(scene, "/cables/0", "runs through body 'drum'");
}

TEST(MakeWorld, AClosedCableHasNoEndsToMove) {
  Scene scene;
  scene.bodies.push_back(body("a", BodyKind::fixed_axle, -0.5, 0.0, 0.3, 1.0));
  scene.bodies.push_back(body("b", BodyKind::fixed_axle, 0.14, 0.0, 0.3, 1.0));
  scene.cables.push_back(cable({}, {{0, -1, 0}, {1, 1, 0}}, {}, 0.02));
  scene.cables[0].closed = true;
  expect_refused(scene, "/cables/0", "give it slack or move its bodies apart");
  scene.cables[0].slack = 0.01;
  EXPECT_NO_THROW(make_world(scene, Method::pinch));
}

TEST(MakeWorld, LaysCablesTaut) {
  Scene scene = drum_scene();
  World world = make_world(scene, Method::pinch);
  const CableState& c = world.cables[0];
  EXPECT_NEAR(c.segments[1].length, c.segments[2].length, 1e-14);
  EXPECT_NEAR(c.length, 2.0 * c.segments[1].length + 0.55 * c.links[1].wrap, 1e-14);
  EXPECT_GT(c.links[1].wrap, std::numbers::pi / 2.0);
  EXPECT_NEAR(c.segments[1].rest_length, c.segments[1].length, 1e-14);
  EXPECT_NEAR(tail_material(c, 1, 0.0), c.segments[1].length, 1e-14);
}

TEST(MakeWorld, SharesSlackByLength) {
  Scene scene = drum_scene();
  scene.cables[0].slack = 0.4;
  World world = make_world(scene, Method::pinch);
  for (std::size_t s : {1u, 2u}) {
    EXPECT_NEAR(world.cables[0].segments[s].rest_length - world.cables[0].segments[s].length, 0.2,
                1e-14);
  }
}

}  // namespace
}  // namespace pinchlab::testing
