// SPDX-License-Identifier: GPL-3.0-or-later
// OpenGL beside the tile painter, by two ways to a context: a process has one, so each draws in a
// process of its own.
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <stdexcept>

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

/// A canvas that OpenGL fills; null if the program was built without.
std::unique_ptr<Canvas> gl_canvas(int side) {
  ::setenv("PINCHLAB_GL", "osmesa", 1);
  std::unique_ptr<Canvas> made;
  try {
    made = std::make_unique<Canvas>(side, side);
  } catch (const std::runtime_error&) {
  }
  ::unsetenv("PINCHLAB_GL");
  return made;
}

/// The demonstrations, and those of demos/more.
std::vector<fs::path> all_scenes() {
  const fs::path demos = fs::path(PINCHLAB_SOURCE_DIR) / "demos";
  std::vector<fs::path> paths = find_scenes({demos});
  const std::vector<fs::path> more = find_scenes({demos / "more"});
  paths.insert(paths.end(), more.begin(), more.end());
  return paths;
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
  const std::unique_ptr<Canvas> gl_parts = gl_canvas(side), gl_whole = gl_canvas(side);
  for (const fs::path& path : all_scenes()) {
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
        if (gl_parts == nullptr) continue;
        gl_whole->draw(blank);
        expected = gl_whole->draw(picture);
        drawn = gl_parts->draw(picture);
        ASSERT_TRUE(std::equal(expected, expected + 4 * side * side, drawn)) << path << frame;
      }
    }
  }
}

// Two programs that share no line of what gives a pixel its colour: each finds the other's faults.
// Mixing in whole levels puts OpenGL off by up to two; and where two pieces of a strip meet it
// leaves single pixels open.
TEST(GlContext, DrawsWhatTheTilePainterDraws) {
  constexpr int side = 480, values = 4 * side * side;
  const std::unique_ptr<Canvas> by_gl = gl_canvas(side);
  if (by_gl == nullptr) GTEST_SKIP() << "built without OSMesa";
  Canvas by_tiles(side, side);
  Picture picture;
  for (const fs::path& path : all_scenes()) {
    const SceneFile file = read_scene_file(path);
    const Scenery scenery = set_scenery(file.scene, file.look);
    Player player(file, file.scene, Configuration(Method::pinch));
    for (int frame = 0; frame < file.scene.frame_count; frame += 20) {
      player.advance_to(frame);
      compose(file.scene, scenery, player.world(), picture);
      const std::uint8_t *a = by_tiles.draw(picture), *b = by_gl->draw(picture);
      int apart = 0;
      for (int i = 0; i < values; ++i) apart += std::abs(a[i] - b[i]) > 2 ? 1 : 0;
      EXPECT_LT(apart, 50) << path << frame;
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
  if (run.err.find("there is no") != std::string::npos) GTEST_SKIP() << run.err;
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("PINCHLAB_GL: `vulkan` must be osmesa or egl"), std::string::npos)
      << run.err;
  EXPECT_FALSE(fs::exists(folder / "vulkan.png"));
}

}  // namespace
}  // namespace pinchlab
