// SPDX-License-Identifier: GPL-3.0-or-later
// What a rehearsal finds: how far rails are used, what must be seen, where labels are out of the
// way.

#include "render/picture/scenery.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "demos/scenes/scene_json.h"
#include "render/picture/compose.h"
#include "sim/outline.h"
#include "sim/step.h"
#include "tests/render/scenes.h"

namespace pinchlab {
namespace {

using testing::atwood;
using testing::body;

Scene short_atwood() {
  Scene scene = atwood();
  scene.frame_count = 30;
  return scene;
}

/// A body that falls freely on a rail for half a second.
Scene falling() {
  Scene scene;
  scene.name = "falling";
  scene.bodies = {body("stone", BodyKind::rail, {0.0, 3.0}, 0.2)};
  scene.frame_count = 30;
  scene.view = {{-2.0, -2.0}, {2.0, 4.0}};
  return scene;
}

TEST(Scenery, RailsReachAsFarAsTheBodyGoes) {
  const Scenery scenery = set_scenery(falling());
  EXPECT_NEAR(scenery.travel[0].high, 0.0, 1e-12);
  const double last = 29.0 / 60.0;  // s
  EXPECT_NEAR(scenery.travel[0].low, -0.5 * 9.81 * last * last, 0.01);
}

// A bracket where a body turns or halts would look like what stops it.
TEST(Scenery, RailsEndBeyondAllMotionWithoutBrackets) {
  const Scene scene = falling();
  const Scenery scenery = set_scenery(scene);
  Picture picture;
  compose(scene, scenery, make_world(scene, Method::pinch), picture);
  const auto is_rail = [&scenery](const Stroke& s) { return s.fill == scenery.theme.rail; };
  const auto rail = std::ranges::find_if(picture.strokes, is_rail);
  ASSERT_NE(rail, picture.strokes.end());
  const double lowest = 3.0 + scenery.travel[0].low;
  EXPECT_NEAR(std::max(rail->a.y(), rail->b.y()), 3.0 + 1.5 * 0.2, 1e-12);
  EXPECT_NEAR(std::min(rail->a.y(), rail->b.y()), lowest - 1.5 * 0.2, 1e-12);
  const auto is_support = [&scenery](const Stroke& s) { return s.fill == scenery.theme.support; };
  EXPECT_EQ(std::ranges::count_if(picture.strokes, is_support), 0);
}

TEST(Scenery, BodiesOnOneLineWhoseWaysMeetShareARail) {
  Scene scene = falling();
  scene.bodies.push_back(body("other", BodyKind::rail, {0.0, 2.0}, 0.2));
  scene.bodies[1].rail_axis = {0.0, -1.0};
  const Scenery scenery = set_scenery(scene);
  EXPECT_FALSE(scenery.travel[0].own);
  EXPECT_TRUE(scenery.travel[1].own);
  // From the other's highest place to its own lowest, along its own axis, which points down.
  EXPECT_NEAR(scenery.travel[1].low, -1.0, 1e-9);
  EXPECT_GT(scenery.travel[1].high, 1.0);

  scene.bodies[1].position.y() = 1.0;
  const Scenery apart = set_scenery(scene);
  EXPECT_TRUE(apart.travel[0].own);
  EXPECT_TRUE(apart.travel[1].own);

  // One between them whose way meets both, wherever in the list it stands.
  scene.bodies.push_back(body("between", BodyKind::rail, {0.0, 2.0}, 0.2));
  const Scenery joined = set_scenery(scene);
  EXPECT_FALSE(joined.travel[0].own || joined.travel[1].own);
  EXPECT_TRUE(joined.travel[2].own);
}

TEST(Scenery, LabelsKeepOffWallsAndRails) {
  Scene scene = falling();
  Scenery scenery = set_scenery(scene);
  EXPECT_GT(std::abs(scenery.labels[0].offset.x()), 0.2) << "not on the rail";
  EXPECT_GT(scenery.labels[0].offset.x(), 0.0);
  scene.walls.push_back({{0.5, -2.0}, {0.5, 4.0}});
  scenery = set_scenery(scene);
  EXPECT_LT(scenery.labels[0].offset.x(), 0.0) << "not on the wall";
}

TEST(Scenery, AFittedViewShowsEverythingAllTheTime) {
  const Scene scene = short_atwood();
  SceneLook look;
  look.fit_view = true;
  const Scenery scenery = set_scenery(scene, look);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  for (int i = 0; i < scene.frame_count * scene.steps_per_frame; ++i) {
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const double r = scene.bodies[b].radius;
      EXPECT_TRUE(((world.position[b].array() - r) >= scenery.view.low.array()).all());
      EXPECT_TRUE(((world.position[b].array() + r) <= scenery.view.high.array()).all());
    }
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  }
  EXPECT_LT((scenery.view.high - scenery.view.low).maxCoeff(), 3.5);
}

// Labels widen a fitted view, so that there is room below what hangs, and none on the rope.
TEST(Scenery, LabelsOfAFittedViewAreBesideWhatMoves) {
  Scene scene;
  scene.name = "hanging";
  scene.bodies = {body("stone", BodyKind::free, {0.0, 2.0}, 0.3)};
  scene.bodies[0].mass = 1234.0;  // wider than what moves
  Cable cable;
  cable.name = "rope";
  cable.start.body = 0;
  cable.end.point = {0.0, 4.0};
  scene.cables = {cable};
  scene.frame_count = 2;
  SceneLook look;
  look.fit_view = true;
  const Scenery scenery = set_scenery(scene, look);
  ASSERT_EQ(scenery.labels.size(), 1U);
  EXPECT_LT(scenery.labels[0].offset.y(), -0.3);
  EXPECT_GT(2.0 + scenery.labels[0].offset.y() - scenery.view.low.y(), 0.5 * scenery.text());
}

// A lever's label stands by the lever, and not by the circle round it.
TEST(Scenery, LabelsOfLongBodiesAreBesideTheirOutline) {
  Scene scene;
  scene.name = "lever";
  scene.bodies = {body("lever", BodyKind::free, {0.0, 0.0}, 0.6)};
  make_polygon(scene.bodies[0], {{-0.6, -0.06}, {0.6, -0.06}, {0.6, 0.06}, {-0.6, 0.06}}, 0.0);
  scene.gravity = Vec2::Zero();
  scene.frame_count = 2;
  const double off =
      0.06 + 1.1 * set_scenery(scene).text();  // half of the lever, a gap, half of it
  EXPECT_NEAR(set_scenery(scene).labels[0].offset.y(), -off, 1e-9);
  scene.bodies[0].angle = 0.5 * std::numbers::pi;
  EXPECT_NEAR(set_scenery(scene).labels[0].offset.y(), -off - 0.54, 1e-9);
}

TEST(Scenery, LabelsCanBeSetHiddenAndPlaced) {
  const Scene scene = short_atwood();
  SceneLook look;
  look.bodies.resize(3);
  look.bodies[0].label = "a fixed pulley";
  look.bodies[0].side = LabelSide::above;
  look.bodies[1].label = "";
  const Scenery scenery = set_scenery(scene, look);
  ASSERT_EQ(scenery.labels.size(), 2U);
  EXPECT_EQ(scenery.labels[0].text, "a fixed pulley");
  EXPECT_GT(scenery.labels[0].offset.y(), 0.5);
  EXPECT_EQ(scenery.labels[0].offset.x(), 0.0);
  EXPECT_EQ(scenery.labels[1].body, 2U);
  EXPECT_EQ(scenery.labels[1].text, "1.05 kg");
}

// As wide on the picture, whatever the letters are: what the label keeps clear of is as wide, too.
TEST(Scenery, LettersOfSeveralBytesAreAsWideAsOthers) {
  const auto right_of_pulley = [](const std::string& text) {
    const Scene scene = short_atwood();
    SceneLook look;
    look.bodies.resize(3);
    look.bodies[0].label = text;
    look.bodies[0].side = LabelSide::right;
    return set_scenery(scene, look).labels[0].offset.x();
  };
  EXPECT_EQ(right_of_pulley("åäö €"), right_of_pulley("aao E"));
  EXPECT_LT(right_of_pulley("åäö €"), right_of_pulley("aao EE"));
}

TEST(Scenery, ALabelMovesOffARope) {
  // A weight on a rope that goes on below it: below is taken, so that the label stands beside it.
  Scene scene = short_atwood();
  Cable below;
  below.name = "below";
  below.start.body = 1;
  below.end.point = {-0.55, -2.9};
  below.slack = 2.0;
  scene.cables.push_back(below);
  const Scenery scenery = set_scenery(scene);
  ASSERT_EQ(scenery.labels[0].body, 1U);
  EXPECT_GT(std::abs(scenery.labels[0].offset.x()), 0.2);
}

TEST(Scenery, ThemeAndLooksReachThePicture) {
  const Scene scene = short_atwood();
  Theme theme;
  theme.background = {1, 2, 3, 255};
  SceneLook look;
  look.bodies.resize(3);
  look.cables.resize(1);
  look.bodies[1].colour = Colour{10, 200, 10, 255};
  look.bodies[1].marks = false;
  look.cables[0].colour = Colour{9, 9, 200, 255};
  look.cables[0].marks = false;
  Picture plain, picture;
  const World world = make_world(scene, Method::pinch);
  compose(scene, set_scenery(scene), world, plain);
  compose(scene, set_scenery(scene, look, theme), world, picture);
  EXPECT_EQ(picture.background, theme.background);
  EXPECT_EQ(picture.strips[0].fill, (Colour{9, 9, 200, 255}));
  EXPECT_EQ(picture.strips[0].mark_length, 0.0);
  EXPECT_EQ(plain.strokes.size(), picture.strokes.size() + 4) << "three spokes and a dot";
  const auto green = [](const Stroke& s) { return s.fill == Colour{10, 200, 10, 255}; };
  EXPECT_EQ(std::count_if(picture.strokes.begin(), picture.strokes.end(), green), 1);
}

// A cable whose number of nodes adapts gives half of its last piece to the body at its end.
TEST(Scenery, LabelsTellTheMassesThatTheSceneGives) {
  const SceneFile file = parse_scene(R"({"title": "ring", "duration_s": 0.1, "view": "fit",
      "baseline": {"method": "cable", "reason": "none"},
      "bodies": [{"name": "ring", "kind": "free", "radius_m": 0.05, "mass_kg": 0.5,
                  "position_m": [1, 1]}],
      "cables": [{"name": "c", "half_width_m": 0.02, "mass_per_metre_kg": 0.8, "slack_m": 0.5,
                  "nodes": 31, "node_tolerance_m": 0.004, "start": {"world_m": [-1, 1]},
                  "end": {"body": "ring"}}]})",
                                     "ring.json");
  ASSERT_GT(file.scene.bodies[0].mass, 0.51);
  const Scenery scenery = set_scenery(file.scene, file.look);
  ASSERT_EQ(scenery.labels.size(), 1U);
  EXPECT_EQ(scenery.labels[0].text, "0.5 kg");
}

}  // namespace
}  // namespace pinchlab
