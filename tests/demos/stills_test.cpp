// SPDX-License-Identifier: GPL-3.0-or-later
// Stills, themes, slow motion: what a user asks for and what is refused.

#include <gtest/gtest.h>

#include <algorithm>

#include "demos/baseline.h"
#include "demos/playback.h"
#include "demos/scenes/player.h"
#include "demos/scenes/theme.h"
#include "tests/demos/scene_folders.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Scene small() {
  return parse_scene(small_scene().dump(), "01-small.json").scene;
}

TEST(Still, WritesWhatTheEndingSays) {
  const fs::path folder = folder_with_scene();
  for (const auto& [name, begin] :
       {std::pair("a.png", "\x89PNG"), {"a.svg", "<?xml"}, {"a.pdf", "%PDF"}}) {
    const RunResult run = run_program(
        folder, {"still", "01-small.json", "--time", "1", "--size", "64x64", "--out", name});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_TRUE(text_of(folder / name).starts_with(begin)) << name;
  }
  for (const std::string name : {"a.jpg", "a", "#.svg"}) {
    const RunResult run =
        run_program(folder, {"still", "01-small.json", "--time", "1", "--out", name});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_NE(run.err.find(".png"), std::string::npos) << run.err;
    EXPECT_FALSE(fs::exists(folder / name));
  }
}

TEST(Still, EveryFrameOfAPartBecomesAFile) {
  const fs::path folder = folder_with_scene();
  const RunResult run = run_program(folder, {"still", "01-small.json", "--time", "0.5:0.6",
                                             "--size", "64x64", "--out", "made/f-#.png"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  for (const char* name : {"f-00015.png", "f-00016.png", "f-00017.png", "f-00018.png"}) {
    EXPECT_TRUE(fs::exists(folder / "made" / name)) << name;
  }
  EXPECT_FALSE(fs::exists(folder / "made" / "f-00019.png"));
  EXPECT_NE(text_of(folder / "made" / "f-00015.png"), text_of(folder / "made" / "f-00016.png"));
  // The same frame as a still of its own.
  ASSERT_EQ(run_program(folder, {"still", "01-small.json", "--time", "0.5", "--size", "64x64",
                                 "--out", "one.png"})
                .exit_code,
            0);
  EXPECT_EQ(text_of(folder / "one.png"), text_of(folder / "made" / "f-00015.png"));
  for (const char* time : {"0.6:0.5", "0:9", "0:", ":1", "a"}) {
    EXPECT_EQ(
        run_program(folder, {"still", "01-small.json", "--time", time, "--out", "x.png"}).exit_code,
        2)
        << time;
  }
}

// Refused before anything is drawn, by their pixels.
TEST(Still, SheetsThatFitInNoMemoryAreRefused) {
  const fs::path folder = folder_with_scene();
  const auto still = [&](const std::vector<std::string>& more) {
    std::vector<std::string> command = {"still", "01-small.json"};
    command.insert(command.end(), more.begin(), more.end());
    return run_program(folder, command);
  };
  const RunResult large = still({"--time", "0:1", "--size", "2048x2048", "--out", "x.png"});
  EXPECT_EQ(large.exit_code, 2);
  EXPECT_EQ(
      large.err,
      "a sheet of 31 pictures of 2048x2048 pixels is too large: 130 million pixels, 100 at "
      "most; a # in --out's name gives each frame a file of its own; or take fewer times or a "
      "smaller --size\n");
  EXPECT_EQ(still({"--time", "0:1", "--size", "2048x2048", "--both", "--out", "x.png"}).exit_code,
            2);
  EXPECT_FALSE(fs::exists(folder / "x.png"));
  EXPECT_EQ(still({"--time", "0:0.1", "--size", "2048x2048", "--out", "#.png"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "00003.png"));
}

TEST(Still, NeutralSheetsNameNoMethod) {
  const fs::path folder = folder_with_scene();
  const auto svg = [&](const std::vector<std::string>& more) {
    std::vector<std::string> command = {"still", "01-small.json", "--time", "1",        "--size",
                                        "64x64", "--both",        "--out",  "sheet.svg"};
    command.insert(command.end(), more.begin(), more.end());
    EXPECT_EQ(run_program(folder, command).exit_code, 0);
    return text_of(folder / "sheet.svg");
  };
  EXPECT_NE(svg({}), svg({"--neutral"}));
}

TEST(Baseline, PlainJointsWhereTheyWork) {
  const fs::path folder = folder_with_scene();
  const RunResult run = run_program(folder, {"baseline", "01-small.json"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("\nRecommended: cable. "), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("The scene has it already."), std::string::npos) << run.out;
}

TEST(Baseline, NoneThatJittersIsRecommended) {
  const fs::path folder = scratch_folder();
  json scene = json::parse(text_of(PINCHLAB_SOURCE_DIR "/demos/02-stack.json"));
  scene["baseline"]["method"] = "cable";
  std::ofstream(folder / "02-stack.json") << scene;
  const RunResult run = run_program(folder, {"baseline", "02-stack.json"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("\nRecommended: pinch_no_contact. "), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("\"baseline\": {\"method\":\"pinch_no_contact\""), std::string::npos)
      << run.out;
}

// Its steps would have to be divided, which those of plain joints are not.
TEST(Baseline, NoneThatMissesTheScenesErrorIsRecommended) {
  const SceneFile file = read_scene_file(PINCHLAB_SOURCE_DIR "/demos/more/09-crate.json");
  ASSERT_EQ(file.scene.error, 0.0005);
  BaselineAdvice advice = advise_baseline(file);
  EXPECT_EQ(advice.recommended, file.scene.baseline);
  EXPECT_EQ(advice.recommended, Method::pinch_no_contact);
  EXPECT_GT(advice.changed_by_half_steps, 0.0005);
  SceneFile careless = file;
  careless.scene.error = 0.0;
  advice = advise_baseline(careless);
  EXPECT_EQ(advice.recommended, Method::cable);
}

// Its scenery is set before any frame of it is played.
TEST(Still, NamesTheFileOfASceneThatCannotBe) {
  const fs::path folder = folder_with_scene();
  nlohmann::json scene = nlohmann::json::parse(std::ifstream(folder / "01-small.json"));
  scene["bodies"].push_back(scene["bodies"][0]);
  scene["bodies"].back()["name"] = "another there";
  std::ofstream(folder / "02-twice.json") << scene;
  for (const char* out : {"x.png", "x.svg"}) {
    const RunResult run =
        run_program(folder, {"still", "02-twice.json", "--time", "1", "--out", out});
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(run.err.find("02-twice.json: /bodies/"), 0U) << run.err;
  }
}

TEST(Theme, TheDeliveredOnesAreReadAndTheDefaultIsTheDefault) {
  const std::string folder = PINCHLAB_SOURCE_DIR "/demos/themes/";
  EXPECT_EQ(read_theme_file(folder + "default.json").theme, Theme{});
  const ThemeFile contrast = read_theme_file(folder + "high-contrast.json");
  EXPECT_EQ(contrast.name, "high-contrast");
  EXPECT_EQ(contrast.theme.background, (Colour{0, 0, 0, 255}));
  EXPECT_EQ(read_theme_file(folder + "print.json").theme.background.alpha, 0);
}

TEST(Theme, MistakesAreNamedWithTheirPlace) {
  const fs::path folder = folder_with_scene();
  std::ofstream(folder / "bad.json") << R"({"ink": "red", "cabel": "#000000", "line_width": 0})";
  const RunResult run = run_program(
      folder, {"still", "01-small.json", "--time", "1", "--theme", "bad.json", "--out", "x.png"});
  EXPECT_NE(run.exit_code, 0);
  for (const char* part : {"bad.json: /ink: must be a colour", "did you mean cable?",
                           "/line_width: must be 0.1 to 10"}) {
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
  }
  EXPECT_FALSE(fs::exists(folder / "x.png"));
}

TEST(Theme, StillsMayBeTransparentAndClipsMayNot) {
  const fs::path folder = folder_with_scene();
  const std::string print = PINCHLAB_SOURCE_DIR "/demos/themes/print.json";
  ASSERT_EQ(run_program(folder, {"still", "01-small.json", "--time", "1", "--size", "64x64",
                                 "--theme", print, "--out", "x.png"})
                .exit_code,
            0);
  const std::string png = text_of(folder / "x.png");
  EXPECT_EQ(png[25], 6) << "colour type of PNG: RGB with alpha";
  const RunResult clip =
      run_program(folder, {"render", "01-small.json", "--theme", print, "--size", "64x64"});
  EXPECT_EQ(clip.exit_code, 2);
  EXPECT_NE(clip.err.find("transparent"), std::string::npos) << clip.err;
}

TEST(Theme, IsInTheManifest) {
  const fs::path folder = folder_with_scene();
  const std::string theme = PINCHLAB_SOURCE_DIR "/demos/themes/high-contrast.json";
  ASSERT_EQ(run_program(folder, {"render", "01-small.json", "--theme", theme, "--burn-time",
                                 "--size", "64x64", "--method", "cable"})
                .exit_code,
            0);
  const json clip = json::parse(text_of(folder / "clips/manifest.json"))["clips"][0];
  EXPECT_EQ(clip["theme"], "high-contrast");
  EXPECT_EQ(clip["theme_sha256"].get<std::string>().size(), 64U);
  EXPECT_EQ(clip["burn_time"], true);
}

TEST(Playback, PlainIsEveryFrame) {
  const Scene scene = small();
  const std::vector<std::int64_t> steps = steps_shown(scene, {});
  ASSERT_EQ(steps.size(), 60U);
  for (std::size_t i = 0; i < steps.size(); ++i) EXPECT_EQ(steps[i], 4 * static_cast<int>(i));
}

TEST(Playback, SlowMotionShowsStepsInBetween) {
  const Scene scene = small();  // 30 frames/s of 4 steps
  const std::vector<std::int64_t> steps =
      steps_shown(scene, {{slow_from("1-1.2:0.25")}, {freeze_from("0.5:0.1")}});
  // Six frames become 24; three more stand at 0.5 s.
  ASSERT_EQ(steps.size(), 60U - 6 + 24 + 3);
  EXPECT_TRUE(std::ranges::is_sorted(steps));
  EXPECT_EQ(std::ranges::count(steps, 60), 4);
  for (std::int64_t step = 120; step < 144; ++step) {
    EXPECT_EQ(std::ranges::count(steps, step), 1) << step;
  }
  EXPECT_EQ(std::ranges::count(steps, 119), 0);
  EXPECT_EQ(std::ranges::count(steps, 145), 0);
  EXPECT_EQ(steps.back(), 236);
}

TEST(Playback, AThreeQuarterWindowEndsOnAFrame) {
  const std::vector<std::int64_t> steps = steps_shown(small(), {{slow_from("0-0.1:0.75")}, {}});
  EXPECT_EQ((std::vector<std::int64_t>(steps.begin(), steps.begin() + 6)),
            (std::vector<std::int64_t>{0, 3, 6, 9, 12, 16}));
}

TEST(Playback, WhatCannotBeIsRefused) {
  const Scene scene = small();
  for (const char* text : {"1", "1-2", "1-2:0.25x", "a-b:c"}) {
    EXPECT_THROW(slow_from(text), std::invalid_argument) << text;
  }
  for (const char* text : {"1", "1:0", "1:-1", "1:nan", "1:61"}) {
    EXPECT_THROW(freeze_from(text), std::invalid_argument) << text;
  }
  for (const char* text : {"1-1.2:0.3", "1-1.2:0", "1-1.2:2", "1.2-1:0.5", "1-9:0.5", "1-1:0.5"}) {
    EXPECT_THROW(steps_shown(scene, {{slow_from(text)}, {}}), std::invalid_argument) << text;
  }
  EXPECT_THROW(steps_shown(scene, {{slow_from("0-1:0.5"), slow_from("0.5-1.5:0.5")}, {}}),
               std::invalid_argument);
  EXPECT_THROW(steps_shown(scene, {{}, {freeze_from("3:1")}}), std::invalid_argument);
}

TEST(Playback, AStepBetweenFramesIsTheSimulationsOwn) {
  const SceneFile file = parse_scene(small_scene().dump(), "01-small.json");
  Player slow(file, file.scene, Method::pinch);
  Scene finer = file.scene;  // a frame a step
  finer.frames_per_second *= finer.steps_per_frame;
  finer.frame_count *= finer.steps_per_frame;
  finer.steps_per_frame = 1;
  Player fine(file, finer, Method::pinch);
  slow.advance_to_step(121);
  fine.advance_to(121);
  EXPECT_EQ(slow.world().position, fine.world().position);
  EXPECT_EQ(slow.time(), fine.time());
  EXPECT_EQ(slow.frame(), 30);
}

TEST(Playback, TheManifestSaysHowAClipWasSlowed) {
  const fs::path folder = folder_with_scene();
  const RunResult run =
      run_program(folder, {"render", "01-small.json", "--method", "cable", "--size", "64x64",
                           "--slow", "1-1.2:0.25", "--freeze", "0.5:0.1", "--codec", "apng"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json clip = json::parse(text_of(folder / "clips/manifest.json"))["clips"][0];
  EXPECT_EQ(clip["file"], "01-small.cable.apng");
  EXPECT_EQ(clip["frame_count"], 81);
  EXPECT_EQ(clip["slow"], json::parse("[[1.0, 1.2, 0.25]]"));
  EXPECT_EQ(clip["freeze"], json::parse("[[0.5, 0.1]]"));
  EXPECT_EQ(run_program(folder, {"render", "01-small.json", "--slow", "1-1.2:0.3"}).exit_code, 2);
}

}  // namespace
}  // namespace pinchlab
