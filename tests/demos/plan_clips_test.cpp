// SPDX-License-Identifier: GPL-3.0-or-later
// Which files a scene becomes, by the options.

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "demos/batch.h"
#include "demos/scenes/scene_json.h"
#include "tests/demos/scenes/scene_files.h"

namespace pinchlab {
namespace {

SceneFile small_file() {
  return parse_scene(small_scene().dump(), "01-small.json");
}

TEST(PlanClips, WhatIsMade) {
  const SceneFile file = small_file();
  const auto files = [&](const BatchOptions& options) {
    std::vector<std::string> names;
    for (const ClipPlan& plan : plan_clips(file, options)) {
      names.push_back(plan.file);
    }
    return names;
  };
  const std::string name = file.scene.name;
  const std::vector<std::string> singles = {name + ".pinch.mp4", name + ".baseline.mp4",
                                            name + ".poster.png"};
  const std::vector<std::string> pairs = {name + ".left-pinch.mp4", name + ".left-baseline.mp4"};
  BatchOptions options;
  EXPECT_EQ(files(options), singles);
  options.singles = false;
  options.side_by_side = true;
  EXPECT_EQ(files(options), pairs);
  options.singles = true;
  std::vector<std::string> all = singles;
  all.insert(all.end(), pairs.begin(), pairs.end());
  EXPECT_EQ(files(options), all);
  options.singles = options.side_by_side = false;
  options.checks = true;
  EXPECT_EQ(files(options),
            (std::vector<std::string>{name + ".check-left.mp4", name + ".check-right.mp4"}));
}

TEST(PlanClips, OptionsThatCannotBe) {
  const SceneFile file = small_file();
  const auto error = [&](const BatchOptions& options) -> std::string {
    try {
      plan_clips(file, options);
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "no error";
  };
  BatchOptions odd;
  odd.width = 65;
  EXPECT_EQ(error(odd), "h264 needs an even size, not 65x960; change --size, or use --codec ffv1");
  odd.codec = Codec::ffv1;
  EXPECT_EQ(error(odd), "no error");
  BatchOptions wide;
  wide.width = 5000;
  wide.side_by_side = true;
  EXPECT_EQ(error(wide), "frames of 10000 x 960 pixels cannot be drawn: each must be 16 to 8192");
  BatchOptions preview;
  preview.codec = Codec::gif;
  EXPECT_EQ(error(preview).find(file.scene.name + ".pinch.gif: a GIF counts hundredths"), 0U)
      << error(preview);
  preview.timing.frames_per_second = 50;
  EXPECT_EQ(error(preview), "no error");
  BatchOptions rate;
  nlohmann::json scene = small_scene();
  scene["duration_s"] = 2.1;
  const SceneFile uneven = parse_scene(scene.dump(), "01-small.json");
  rate.timing.frames_per_second = 24;
  EXPECT_EQ(error(rate), "no error");
  EXPECT_THROW(plan_clips(uneven, rate), std::invalid_argument);
}

}  // namespace
}  // namespace pinchlab
