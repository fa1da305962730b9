// SPDX-License-Identifier: GPL-3.0-or-later
// The two ways to an OpenGL context: a process has one, so each draws in a process of its own.
#include <gtest/gtest.h>

#include <cstdlib>

#include "demos/scenes/find_scenes.h"
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
