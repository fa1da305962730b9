// SPDX-License-Identifier: GPL-3.0-or-later
// The scenes of demos/more, which show what the eight of the study do not need.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "demos/scenes/scene_json.h"
#include "render/canvas.h"
#include "render/picture/compose.h"
#include "sim/promises.h"
#include "sim/step.h"
#include "sim/tangent.h"

namespace pinchlab {
namespace {

TEST(MoreDemonstrations, KeepEveryPromiseAndCanBeDrawn) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PINCHLAB_SOURCE_DIR "/demos/more")) {
    if (entry.path().extension() != ".json") continue;
    ++count;
    const SceneFile file = read_scene_file(entry.path());
    const Scene& scene = file.scene;
    World world = start_world(scene, file.path, Method::pinch);
    Workspace work;
    Promises promises(scene, world);
    const Scenery scenery = set_scenery(scene, file.look);
    Picture picture;
    for (int i = 0; i < scene.frame_count * scene.steps_per_frame; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      promises.note(scene, world);
    }
    compose(scene, scenery, world, picture);
    EXPECT_EQ(promises.broken(scene, world), std::vector<std::string>()) << entry.path();
    std::size_t patches = 0;  // of a polygon one, of a compound's another for its inside
    for (const Body& body : scene.bodies) {
      if (!body.corners.empty()) patches += body.carrier < 0 ? 1U : 2U;
    }
    std::size_t risers = 0;
    for (const CableState& cable : world.cables) risers += cable.fills ? 1U : 0U;
    EXPECT_EQ(picture.patches.size(), patches + 52 * risers);
    EXPECT_FALSE(picture.strips.empty());
  }
  EXPECT_GE(count, 1);
}

// The first turn on a drum that fills lies on the drum's riser, all the way: no paper between.
TEST(MoreDemonstrations, TheFirstTurnOfADrumLiesOnItsRiser) {
  const SceneFile file = read_scene_file(PINCHLAB_SOURCE_DIR "/demos/more/10-drum.json");
  const Scene& scene = file.scene;
  World world = make_world(scene, Method::pinch);
  Workspace work;
  const Scenery scenery = set_scenery(scene, file.look);
  for (int frame = 0; frame < scene.frame_count; ++frame) {
    for (int i = 0; i < scene.steps_per_frame; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    }
    Picture picture;
    compose(scene, scenery, world, picture);
    const Strip &riser = picture.strips[0], &rope = picture.strips.back();
    const Vec2 drum = world.position[0];
    // From the rope's end on the drum back, but for the riser's step.
    double turned = 0.0;
    for (std::size_t k = rope.first + rope.count - 1; k > rope.first && turned < 6.0; --k) {
      const Vec2 here = picture.points[k].position - drum;
      const Vec2 next = picture.points[k - 1].position - drum;
      const double step = std::atan2(cross(here, next), here.dot(next));
      if (here.norm() > 2.0 * scene.bodies[0].radius || std::abs(step) < 1e-9) break;
      double nearest = infinity, top = 0.0;
      for (std::size_t r = riser.first; r < riser.first + riser.count; ++r) {
        const Vec2 below = picture.points[r].position - drum;
        const double aside = std::abs(std::atan2(cross(here, below), here.dot(below)));
        if (aside < nearest) top = below.norm() + riser.half_width;
        nearest = std::min(nearest, aside);
      }
      // The riser's points are a 52nd of a turn apart.
      if (turned > 0.2) {
        EXPECT_NEAR(here.norm() - rope.half_width, top, 0.05 * rope.half_width) << frame;
      }
      turned += std::abs(step);
    }
  }
}

// Where two turns share a pixel they let a quarter of the paper through, which looked like dots.
TEST(MoreDemonstrations, NoPaperIsSeenBetweenTheTurnsOnADrum) {
  const SceneFile file = read_scene_file(PINCHLAB_SOURCE_DIR "/demos/more/10-drum.json");
  const Scene& scene = file.scene;
  World world = make_world(scene, Method::pinch);
  Workspace work;
  for (int i = 0; i < scene.frame_count * scene.steps_per_frame; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  }
  const CableState& rope = world.cables[0];
  const auto drum =
      std::ranges::find_if(rope.links, [](const Link& l) { return l.layers.way != 0; });
  ASSERT_GT(thickness_of_layers(*drum), 4.0 * rope.half_width) << "more than two turns";
  Picture picture;
  compose(scene, set_scenery(scene, file.look), world, picture);
  const Vec2 middle = world.position[static_cast<std::size_t>(drum->body)];
  picture.view = {middle - Vec2(0.5, 0.5), middle + Vec2(0.5, 0.5)};
  constexpr int side = 200;
  Canvas canvas(side, side);
  const std::uint8_t* const rgba = canvas.draw(picture);
  const int fill = Theme().cable.fill.blue;
  int seen = 0;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const double from_middle = Vec2((x + 0.5) / side - 0.5, 0.5 - (y + 0.5) / side).norm();  // m
      // Nothing but rope is from the second turn's inside to the last but one's outside.
      if (from_middle < drum->layers.inner + 2.0 * rope.half_width ||
          from_middle > drum->radius - 2.0 * rope.half_width)
        continue;
      ++seen;
      ASSERT_LE(rgba[4 * (y * side + x) + 2], fill + 4) << x << " " << y;
    }
  }
  EXPECT_GT(seen, 500);
}

}  // namespace
}  // namespace pinchlab
