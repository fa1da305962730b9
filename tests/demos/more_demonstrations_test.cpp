// SPDX-License-Identifier: GPL-3.0-or-later
// The scenes of demos/more, which show what the eight of the study do not need.

#include <gtest/gtest.h>

#include <filesystem>

#include "demos/scenes/scene_json.h"
#include "render/picture/compose.h"
#include "sim/promises.h"
#include "sim/step.h"

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
    EXPECT_EQ(picture.patches.size(), patches);
    EXPECT_FALSE(picture.strips.empty());
  }
  EXPECT_GE(count, 1);
}

}  // namespace
}  // namespace pinchlab
