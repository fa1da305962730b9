// SPDX-License-Identifier: GPL-3.0-or-later
// What a rehearsal finds: how far rails are used, what must be seen, where labels are out of the
// way.

#include "render/picture/scenery.h"

#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "render/picture/compose.h"
#include "render/vector_canvas.h"
#include "sim/step.h"
#include "tests/render/scenes.h"

namespace pinchlab {
namespace {

using test::TemporaryFolder;
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

// A mark that lies on two pieces of a cable is one shape: between two, viewers show a light line.
TEST(Vector, AMarkIsOnePath) {
  const TemporaryFolder folder;
  Picture picture;
  picture.view = {{-1.0, -1.0}, {3.0, 3.0}};
  Strip strip;
  strip.half_width = 0.1;
  strip.fill = {200, 200, 200, 255};
  strip.mark = {255, 0, 0, 255};
  strip.mark_spacing = 1.0;  // marks about 0, 1 and 2: the pieces meet at 1
  strip.mark_length = 0.5;
  for (const double x : {0.0, 1.0, 2.0}) picture.points.push_back({{x, 0.0}, {1.0, 0.0}, x});
  strip.count = picture.points.size();
  picture.add(strip);
  write_vector(folder.file("marks.svg"), VectorFormat::svg, 100, 100, {{picture, ""}});
  const auto raw = testing::bytes_of(folder.file("marks.svg"));
  const std::string svg(raw.begin(), raw.end()), red = "stroke:rgb(100%,0%,0%)";
  int marks = 0;
  for (std::size_t at = svg.find(red); at != std::string::npos; at = svg.find(red, at + 1)) ++marks;
  EXPECT_EQ(marks, 3);
}

TEST(Vector, SvgAndPdfAreTheSameTwice) {
  const Scene scene = short_atwood();
  Picture picture;
  compose(scene, set_scenery(scene), make_world(scene, Method::pinch), picture);
  const TemporaryFolder folder;
  for (const auto& [format, ending, begin] :
       {std::tuple(VectorFormat::svg, ".svg", "<?xml"), {VectorFormat::pdf, ".pdf", "%PDF"}}) {
    const std::string a = folder.file(std::string("a") + ending);
    const std::string b = folder.file(std::string("b") + ending);
    write_vector(a, format, 200, 200, {{picture, ""}});
    write_vector(b, format, 200, 200, {{picture, ""}});
    // Cairo numbers the surfaces of a process.
    const auto numbered_anew = [](const std::string& path) {
      const auto bytes = testing::bytes_of(path);
      return std::regex_replace(std::string(bytes.begin(), bytes.end()),
                                std::regex("surface[0-9]+"), "surface");
    };
    const std::string raw = numbered_anew(a);
    EXPECT_TRUE(raw == numbered_anew(b));
    EXPECT_TRUE(std::string(raw.begin(), raw.end()).starts_with(begin));
  }
  const auto raw = testing::bytes_of(folder.file("a.svg"));
  const std::string svg(raw.begin(), raw.end());
  EXPECT_NE(svg.find("width=\"200"), std::string::npos);
  EXPECT_EQ(svg.find("<image"), std::string::npos) << "shapes, not pixels";
  write_vector(folder.file("sheet.svg"), VectorFormat::svg, 100, 100,
               {{picture, "A, 0.00 s"}, {picture, "B, 0.00 s"}}, 2);
  EXPECT_THROW(write_vector(folder.file("no/a.svg"), VectorFormat::svg, 10, 10, {{picture, ""}}),
               std::runtime_error);
  EXPECT_THROW(write_vector(folder.file("none.svg"), VectorFormat::svg, 10, 10, {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace pinchlab
