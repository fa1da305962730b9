// SPDX-License-Identifier: GPL-3.0-or-later
// Clips that the study does not render itself: what is said where one is missing.
#include "study/clips.h"

#include <gtest/gtest.h>

#include "tests/base/message_of.h"
#include "tests/base/temporary_folder.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;

std::string why(const fs::path& clips, const Config& config) {
  return pinchlab::test::message_of<std::runtime_error>([&] { open_clips(clips, config); });
}

TEST(Clips, OfMethodsThatAreMissingAreNamedWithTheirCommand) {
  const fs::path folder = scratch_folder();
  Config config = default_config();
  config.demonstrations = {"03-drop"};
  config.methods = {"pinch", "cable"};
  write_text(folder / "03-drop.pinch-cable.mp4", "a");
  EXPECT_EQ(why(folder, config),
            (folder / "03-drop.cable-pinch.mp4").string() +
                ": there is no such clip; pinchlab render demos/03-drop.json --pair pinch,cable "
                "--out " +
                folder.string() + " makes it");
  write_text(folder / "03-drop.cable-pinch.mp4", "b");
  EXPECT_EQ(why(folder, config), "");
}

TEST(Clips, OfSeriesAndChecksThatAreMissingAreNamedWithWhoNamesThem) {
  const fs::path folder = scratch_folder();
  Config config = default_config();
  config.demonstrations = {"squeeze"};
  GradedStimulus stimulus;
  stimulus.clip = {"squeeze", 0.5};
  stimulus.left = "left.mp4";
  stimulus.right = "right.mp4";
  config.graded = {stimulus};
  EXPECT_NE(why(folder, config).find("left.mp4: there is no such clip; `series` of the"),
            std::string::npos);
  write_text(folder / "left.mp4", "a");
  write_text(folder / "right.mp4", "b");
  AttentionCheck check;
  check.name = "frozen";
  check.left = "frozen-left.mp4";
  check.right = "frozen-right.mp4";
  config.attention_checks = {check};
  EXPECT_NE(why(folder, config).find("frozen-left.mp4: there is no such clip; `attention_checks`"),
            std::string::npos);
}

TEST(Clips, ThatAreTheSameAreNamed) {
  const fs::path folder = scratch_folder();
  write_clips(folder);
  EXPECT_TRUE(same_clips(open_clips(folder, small_config())).empty());
  fs::remove(folder / "manifest.json");
  Config config = default_config();
  config.demonstrations = {"03-drop"};
  config.methods = {"pinch", "cable"};
  write_text(folder / "03-drop.pinch-cable.mp4", "a");
  write_text(folder / "03-drop.cable-pinch.mp4", "a");
  const std::vector<std::string> same = same_clips(open_clips(folder, config));
  ASSERT_EQ(same.size(), 1U);
  EXPECT_NE(same[0].find("cannot be told apart: 03-drop.pinch-cable.mp4 and "
                         "03-drop.cable-pinch.mp4 are the same"),
            std::string::npos)
      << same[0];
}

TEST(Clips, AreOrdinaryFiles) {
  EXPECT_EQ(pinchlab::test::message_of<std::runtime_error>(
                [] { const Clip clip("/dev/null", Encoding::mp4); }),
            "/dev/null: cannot be opened: is no ordinary file");
}

}  // namespace
}  // namespace pinchlab::study
