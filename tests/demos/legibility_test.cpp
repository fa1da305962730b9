// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/legibility.h"

#include <gtest/gtest.h>

#include "tests/render/scenes.h"

namespace pinchlab {
namespace {

TEST(Legibility, CablesThinnerThanHalfAPixelAreNamed) {
  Scene scene = testing::atwood();
  scene.frame_count = 2;
  scene.cables[0].half_width = 2e-4;  // m; the view is 4 m wide
  const std::vector<std::string> lines = hard_to_see(scene, set_scenery(scene), 500, 500);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].starts_with("cable \"rope\" is 0.05 px wide")) << lines[0];
  scene.cables[0].half_width = 5e-3;
  EXPECT_TRUE(hard_to_see(scene, set_scenery(scene), 500, 500).empty());
}

// A picture that is wider than the view shows more of the world on either side.
TEST(Legibility, AViewOfNothingIsNamed) {
  Scene scene = testing::atwood();
  scene.frame_count = 2;
  scene.view = {Vec2(20.0, 0.0), Vec2(24.0, 4.0)};
  const std::vector<std::string> lines = hard_to_see(scene, set_scenery(scene), 500, 500);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].starts_with("no body is in the picture at the start")) << lines[0];
  EXPECT_TRUE(hard_to_see(scene, set_scenery(scene), 6000, 500).empty());
}

TEST(Legibility, LettersThatTheFontLacksAreNamed) {
  Scene scene = testing::atwood();
  scene.frame_count = 2;
  SceneLook look;
  look.bodies.resize(scene.bodies.size());
  look.bodies[0].label = "a 滑 pulley µ";
  const std::vector<std::string> lines = hard_to_see(scene, set_scenery(scene, look), 500, 500);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].starts_with("label \"a 滑 pulley µ\": the font lacks 滑,")) << lines[0];
}

}  // namespace
}  // namespace pinchlab
