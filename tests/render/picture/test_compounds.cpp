// SPDX-License-Identifier: GPL-3.0-or-later
// How bodies of several shapes are drawn.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/picture/compose.h"
#include "sim/compound.h"
#include "tests/render/scenes.h"

namespace pinchlab {
namespace {

// Patches have jagged sides. Those of the insides lie under bands of their own colour.
TEST(ComposeCompounds, InsidesHaveSmoothSides) {
  Scene scene;
  scene.name = "compound";
  scene.bodies = {testing::body("pair", BodyKind::free, {0.0, 0.0}, 1.0)};
  Shape square;
  make_polygon(square.properties, {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}, 0.0);
  std::vector<Shape> shapes(2, square);
  shapes[0].place = {-0.4, 0.1};
  shapes[1].place = {0.4, -0.1};
  add_shapes(scene, 0, shapes);
  scene.frame_count = 2;
  Picture picture;
  compose(scene, set_scenery(scene), make_world(scene, Method::pinch), picture);
  ASSERT_EQ(picture.patches.size(), 4U);
  ASSERT_EQ(picture.strips.size(), 4U);
  const Colour inside = picture.patches.back().fill;
  EXPECT_EQ(
      std::ranges::count_if(picture.strips, [&inside](const Strip& s) { return s.fill == inside; }),
      2);
}

// Nothing of them showed whether they turn.
TEST(ComposeCompounds, DiscsAboutOneCentreShowThatTheyTurn) {
  Scene scene;
  scene.name = "wheel";
  scene.bodies = {testing::body("wheel", BodyKind::fixed_axle, {0.3, -0.2}, 1.0)};
  std::vector<Shape> shapes(2);
  shapes[0].properties.radius = 0.2;
  shapes[1].properties.radius = 0.5;
  add_shapes(scene, 0, shapes);
  scene.frame_count = 2;
  World world = make_world(scene, Method::pinch);
  const Scenery scenery = set_scenery(scene);
  const auto spokes = [&](double angle) {
    Picture picture;
    compose(scene, scenery, world, picture);
    return std::ranges::count_if(picture.strokes, [&](const Stroke& s) {
      const Vec2 along = s.b - s.a, e(std::cos(angle), std::sin(angle));
      return s.a == world.position[0] && along.dot(e) > 0.4;
    });
  };
  EXPECT_EQ(spokes(0.0), 1);
  world.angle[0] = 0.5;
  EXPECT_EQ(spokes(0.5), 1);
}

// A bar's axle was of a size with its thickness, and not to be seen.
TEST(ComposeCompounds, AThinBarsAxleIsToBeSeen) {
  Scene scene;
  scene.name = "bar";
  scene.bodies = {testing::body("bar", BodyKind::fixed_axle, {0.0, 0.0}, 1.0)};
  make_polygon(scene.bodies[0], {{-0.9, -0.02}, {0.9, -0.02}, {0.9, 0.02}, {-0.9, 0.02}}, 0.0);
  scene.frame_count = 2;
  const Scenery scenery = set_scenery(scene);
  Picture picture;
  compose(scene, scenery, make_world(scene, Method::pinch), picture);
  double largest = 0.0;
  for (const Stroke& s : picture.strokes) {
    if (s.a.isZero() && s.b.isZero()) largest = std::max(largest, s.half_width);
  }
  EXPECT_GE(largest, 0.75 * scenery.unit());
}

}  // namespace
}  // namespace pinchlab
