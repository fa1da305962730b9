// SPDX-License-Identifier: GPL-3.0-or-later
// The two ways to an OpenGL context: a process has one, so each draws in a process of its own.
#include <gtest/gtest.h>

#include <cstdlib>

#include "demos/scenes/find_scenes.h"
#include "demos/scenes/player.h"
#include "render/canvas.h"
#include "render/picture/compose.h"
#include "tests/demos/run_program.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;

RunResult draw(const fs::path& folder, const char* kind, const fs::path& scene) {
  ::setenv("PINCHLAB_GL", kind, 1);
  RunResult run = run_program(folder, {"still", scene.string(), "--time", "0.5,1.5", "--both",
                                       "--out", std::string(kind) + ".png"});
  ::unsetenv("PINCHLAB_GL");
  return run;
}

TEST(GlContext, OsmesaAndEglGiveTheSameBytes) {
  const fs::path folder = scratch_folder();
  for (const fs::path& scene : find_scenes({fs::path(PINCHLAB_SOURCE_DIR) / "demos"})) {
    for (const char* kind : {"osmesa", "egl"}) {
      const RunResult run = draw(folder, kind, scene);
      if (run.err.find("there is no") != std::string::npos) GTEST_SKIP() << run.err;
      ASSERT_EQ(run.exit_code, 0) << kind << ": " << run.err;
    }
    EXPECT_TRUE(text_of(folder / "osmesa.png") == text_of(folder / "egl.png")) << scene;
  }
}

// A clip's frames are drawn where they differ from the frame before.
TEST(GlContext, EveryFrameOfTheDemonstrationsDrawnInPartsIsAsDrawnWhole) {
  constexpr int side = 480;  // px
  Picture picture, blank;
  Canvas parts(side, side), whole(side, side);
  const fs::path demos = fs::path(PINCHLAB_SOURCE_DIR) / "demos";
  std::vector<fs::path> paths = find_scenes({demos});
  const std::vector<fs::path> more = find_scenes({demos / "more"});
  paths.insert(paths.end(), more.begin(), more.end());
  for (const fs::path& path : paths) {
    const SceneFile file = read_scene_file(path);
    const Scenery scenery = set_scenery(file.scene, file.look);
    for (const Configuration& method :
         {Configuration(Method::pinch), Configuration(file.scene.baseline)}) {
      Player player(file, file.scene, method);
      for (int frame = 0; frame < file.scene.frame_count; ++frame) {
        player.advance_to(frame);
        compose(file.scene, scenery, player.world(), picture);
        whole.draw(blank);
        const std::uint8_t* expected = whole.draw(picture);
        const std::uint8_t* drawn = parts.draw(picture);
        ASSERT_TRUE(std::equal(expected, expected + 4 * side * side, drawn)) << path << frame;
      }
    }
  }
}

TEST(GlContext, ClipsAreTheSameForEachKindAndAnyThreadsOfTheDriver) {
  const fs::path folder = scratch_folder();
  const fs::path scene = fs::path(PINCHLAB_SOURCE_DIR) / "demos/06-windlass.json";
  std::string first;
  for (const auto& [kind, threads] :
       {std::pair{"osmesa", "0"}, {"osmesa", "1"}, {"osmesa", "3"}, {"egl", "0"}, {"egl", "2"}}) {
    ::setenv("PINCHLAB_GL", kind, 1);
    ::setenv("LP_NUM_THREADS", threads, 1);
    const RunResult run =
        run_program(folder, {"render", scene.string(), "--method", "pinch", "--size", "320x320",
                             "--out", std::string(kind) + threads});
    ::unsetenv("PINCHLAB_GL");
    ::unsetenv("LP_NUM_THREADS");
    if (run.err.find("there is no") != std::string::npos) GTEST_SKIP() << run.err;
    ASSERT_EQ(run.exit_code, 0) << kind << ": " << run.err;
    const std::string clip =
        text_of(folder / (std::string(kind) + threads) / "06-windlass.pinch.mp4");
    if (first.empty()) first = clip;
    EXPECT_TRUE(clip == first) << kind << " " << threads;
  }
}

TEST(GlContext, AnUnknownKindIsTold) {
  const fs::path folder = scratch_folder();
  const fs::path scene = fs::path(PINCHLAB_SOURCE_DIR) / "demos/03-drop.json";
  const RunResult run = draw(folder, "vulkan", scene);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("PINCHLAB_GL: `vulkan` must be osmesa or egl"), std::string::npos)
      << run.err;
  EXPECT_FALSE(fs::exists(folder / "vulkan.png"));
}

}  // namespace
}  // namespace pinchlab
