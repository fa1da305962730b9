// SPDX-License-Identifier: GPL-3.0-or-later
// The main job on small scenes: the same bytes always, nothing made twice, no half file ever.

#include "demos/batch.h"
#include "base/sha256.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "demos/scenes/find_scenes.h"
#include "demos/version.h"
#include "tests/demos/scene_folders.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

TEST(Batch, MakesPairsPostersAndManifest) {
  const fs::path folder = folder_with_demos();
  const RunResult run = run_program(folder, render);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_TRUE(run.err.starts_with("clips: 6 made, 0 up to date already, 0 failed; ")) << run.err;
  EXPECT_EQ(names_in(folder / "clips"),
            (std::set<std::string>{"01-long.baseline.mp4", "01-long.pinch.mp4",
                                   "01-long.poster.png", "02-short.baseline.mp4",
                                   "02-short.pinch.mp4", "02-short.poster.png", "manifest.json"}));
}

TEST(Batch, ManifestSaysWhatEachFileIs) {
  const fs::path folder = folder_with_demos();
  ASSERT_EQ(run_program(folder, render_with({"--side-by-side"})).exit_code, 0);
  const std::string text = text_of(folder / "clips/manifest.json");
  EXPECT_EQ(text.find(folder.string()), std::string::npos);
  const json manifest = json::parse(text);
  EXPECT_EQ(manifest["format"], "pinchlab clips 1");
  ASSERT_EQ(manifest["clips"].size(), 10U);
  std::vector<std::string> files;
  for (const json& clip : manifest["clips"]) {
    files.push_back(clip["file"]);
    EXPECT_EQ(clip["sha256"], sha256_of_file(folder / "clips" / clip["file"]));
    EXPECT_EQ(clip["scene_sha256"], sha256_of_file(folder / "demos" / clip["scene"]));
    EXPECT_EQ(clip["raw_frames_murmur3"].get<std::string>().size(), 32U);
    EXPECT_EQ(clip["version"], version);
  }
  EXPECT_TRUE(std::ranges::is_sorted(files));

  const auto entry = [&](const std::string& file) {
    json clip =
        manifest["clips"][static_cast<std::size_t>(std::ranges::find(files, file) - files.begin())];
    for (const char* key : {"sha256", "scene_sha256", "raw_frames_murmur3", "version"}) {
      clip.erase(key);
    }
    return clip;
  };
  const json clip = {{"file", "01-long.baseline.mp4"},
                     {"role", "baseline"},
                     {"scene", "01-long.json"},
                     {"title", "Weight and wheel"},
                     {"methods", {"cable"}},
                     {"panel_width_px", 64},
                     {"panel_height_px", 64},
                     {"frames_per_second", 30},
                     {"steps_per_frame", 4},
                     {"error_m", 0.0},
                     {"frame_count", 60},
                     {"duration_s", 2.0},
                     {"codec", "h264"},
                     {"settings", describe({Codec::h264, 64, 64, 30, ""})},
                     {"equal_sizes_with", {"01-long.pinch.mp4"}}};
  EXPECT_EQ(entry("01-long.baseline.mp4"), clip);
  json pair = clip;
  pair["file"] = "01-long.left-baseline.mp4";
  pair["role"] = "left-baseline";
  pair["methods"] = {"cable", "pinch"};
  pair["settings"] = describe({Codec::h264, 128, 64, 30, ""});
  pair["equal_sizes_with"] = {"01-long.left-pinch.mp4"};
  EXPECT_EQ(entry("01-long.left-baseline.mp4"), pair);
  json poster = clip;
  poster["file"] = "01-long.poster.png";
  poster["role"] = "poster";
  poster["methods"] = {"pinch", "cable"};
  poster["time_s"] = 1.0;
  for (const char* key : {"frame_count", "duration_s", "codec", "settings", "equal_sizes_with"}) {
    poster.erase(key);
  }
  EXPECT_EQ(entry("01-long.poster.png"), poster);
}

// Bytes of each frame in the file, in order of presentation.
std::vector<int> stored_bytes(const fs::path& path) {
  VideoReader reader(path.string());
  std::vector<int> bytes;
  while (const auto frame = reader.next()) bytes.push_back(frame->stored_bytes);
  return bytes;
}

TEST(Batch, FilesOfAPairHaveEqualSizes) {
  const fs::path folder = scratch_folder();
  const std::string drop = (fs::path(PINCHLAB_SOURCE_DIR) / "demos/03-drop.json").string();
  ASSERT_EQ(
      run_program(folder, render_with({drop, "--side-by-side", "--attention-checks"})).exit_code,
      0);
  for (const auto& [one, other] : {std::pair{"pinch", "baseline"},
                                   {"left-pinch", "left-baseline"},
                                   {"check-left", "check-right"}}) {
    const fs::path a = folder / "clips" / fmt::format("03-drop.{}.mp4", one);
    const fs::path b = folder / "clips" / fmt::format("03-drop.{}.mp4", other);
    EXPECT_EQ(fs::file_size(a), fs::file_size(b)) << one;
    EXPECT_EQ(stored_bytes(a), stored_bytes(b)) << one;
    EXPECT_FALSE(text_of(a) == text_of(b)) << one << ": nothing to be padded";
  }
}

TEST(Batch, PairsOfAnyMethods) {
  const fs::path folder = folder_with_demos();
  const auto pairs = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = {"demos/02-short.json", "--pair", "pinch,thesis", "--pair",
                                    "cable,pinch"};
    all.insert(all.end(), more.begin(), more.end());
    return run_program(folder, render_with(all));
  };
  ASSERT_EQ(pairs({}).exit_code, 0);
  EXPECT_EQ(names_in(folder / "clips"),
            (std::set<std::string>{"02-short.pinch.mp4", "02-short.thesis.mp4",
                                   "02-short.cable.mp4", "02-short.pinch-thesis.mp4",
                                   "02-short.thesis-pinch.mp4", "02-short.cable-pinch.mp4",
                                   "02-short.pinch-cable.mp4", "02-short.pinch-thesis.poster.png",
                                   "02-short.cable-pinch.poster.png", "manifest.json"}));
  const json manifest = json::parse(text_of(folder / "clips/manifest.json"));
  for (const json& clip : manifest["clips"]) {
    if (clip["file"] != "02-short.thesis-pinch.mp4") continue;
    EXPECT_EQ(clip["methods"], json({"thesis", "pinch"}));
    EXPECT_EQ(clip["role"], "thesis-pinch");
  }
  EXPECT_EQ(stored_bytes(folder / "clips/02-short.cable-pinch.mp4"),
            stored_bytes(folder / "clips/02-short.pinch-cable.mp4"));
  EXPECT_EQ(stored_bytes(folder / "clips/02-short.cable.mp4"),
            stored_bytes(folder / "clips/02-short.thesis.mp4"));
  EXPECT_EQ(pairs({}).err, "clips: 0 made, 9 up to date already, 0 failed\n");
  ASSERT_EQ(pairs({"--only-side-by-side", "--out", "study"}).exit_code, 0);
  EXPECT_EQ(names_in(folder / "study").size(), 5U);

  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& why) {
    const RunResult run = run_program(folder, render_with(arguments));
    EXPECT_EQ(run.exit_code, 2) << why;
    EXPECT_NE(run.err.find(why), std::string::npos) << run.err;
  };
  refused({"--pair", "pinch"}, "with a comma between, as pinch,thesis, not pinch");
  refused({"--pair", "pinch,rope"}, "not pinch,rope");
  refused({"--pair", "pinch,cable,thesis"}, "not pinch,cable,thesis");
  refused({"--pair", "cable,cable"}, "cable,cable: a pair needs two methods");
  // The short one's baseline.
  refused({"demos/02-short.json", "--pair", "baseline,cable"},
          "baseline,cable: the baseline of 02-short is cable");
  refused({"--pair", "cable,pinch", "--pair", "pinch,cable"},
          "the pair pinch,cable is asked for twice");
  refused({"--pair", "cable,pinch", "--method", "cable"}, "excludes");
  refused({"--pair", "cable,pinch", "--report"}, "excludes");
}

TEST(Batch, SameBytesForAnyJobs) {
  const fs::path folder = folder_with_demos();
  ASSERT_EQ(
      run_program(folder, render_with({"--side-by-side", "--jobs", "1", "--out", "one"})).exit_code,
      0);
  ASSERT_EQ(run_program(folder, render_with({"--side-by-side", "--jobs", "3", "--out", "three"}))
                .exit_code,
            0);
  EXPECT_EQ(files_in(folder / "one"), files_in(folder / "three"));
}

TEST(Batch, ReadsBackAsVideo) {
  const fs::path folder = folder_with_demos();
  ASSERT_EQ(run_program(folder, render_with({"--side-by-side"})).exit_code, 0);
  VideoReader reader((folder / "clips/02-short.left-pinch.mp4").string());
  EXPECT_EQ(reader.info().width, 128);
  EXPECT_EQ(reader.info().height, 64);
  int frames = 0;
  while (const auto frame = reader.next()) {
    EXPECT_NEAR(frame->time_s, frames / 30.0, 1e-9);
    ++frames;
  }
  EXPECT_EQ(frames, 15);
}

// Mean difference of a panel of a wide frame from a frame, levels of 255, but for the line between
// the panels.
double panel_difference(const std::vector<std::uint8_t>& wide, std::size_t panel,
                        const std::vector<std::uint8_t>& frame, bool is_turned) {
  constexpr std::size_t side = 64, row = 4 * side, line = 4;  // px, bytes
  double sum = 0;
  for (std::size_t y = 0; y < side; ++y) {
    const std::size_t from = is_turned ? side - 1 - y : y;
    for (std::size_t x = line; x < row; ++x) {
      sum += std::abs(wide[(2 * y + panel) * row + x] - frame[from * row + x]);
    }
  }
  return sum / static_cast<double>(side * row);
}

// Antialiasing differs a little from place to place, so that panels are not equal to the last bit.
TEST(Batch, AttentionChecksShowTheClipBesideItselfUpsideDown) {
  const fs::path folder = folder_with_demos();
  ASSERT_EQ(run_program(folder, render_with({"--attention-checks", "--codec", "ffv1"})).exit_code,
            0);
  VideoReader single((folder / "clips/02-short.pinch.mkv").string());
  VideoReader left((folder / "clips/02-short.check-left.mkv").string());
  VideoReader right((folder / "clips/02-short.check-right.mkv").string());
  int frames = 0;
  while (const auto frame = single.next()) {
    const auto left_frame = left.next(), right_frame = right.next();
    ASSERT_TRUE(left_frame && right_frame);
    EXPECT_LT(panel_difference(left_frame->rgba, 0, frame->rgba, false), 0.2);
    EXPECT_LT(panel_difference(left_frame->rgba, 1, frame->rgba, true), 0.2);
    EXPECT_LT(panel_difference(right_frame->rgba, 0, frame->rgba, true), 0.2);
    EXPECT_LT(panel_difference(right_frame->rgba, 1, frame->rgba, false), 0.2);
    EXPECT_GT(panel_difference(left_frame->rgba, 1, frame->rgba, false), 1.0);
    ++frames;
  }
  EXPECT_EQ(frames, 15);
}

TEST(Batch, SecondRunMakesNothing) {
  const fs::path folder = folder_with_demos();
  ASSERT_EQ(run_program(folder, render).exit_code, 0);
  const auto made = fs::last_write_time(folder / "clips/01-long.pinch.mp4");
  const auto files = files_in(folder / "clips");
  const RunResult again = run_program(folder, render);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_EQ(again.err, "clips: 0 made, 6 up to date already, 0 failed\n");
  EXPECT_EQ(fs::last_write_time(folder / "clips/01-long.pinch.mp4"), made);
  EXPECT_EQ(files_in(folder / "clips"), files);
}

TEST(Batch, MakesOnlyWhatIsMissingOrOutOfDate) {
  const fs::path folder = folder_with_demos();
  ASSERT_EQ(run_program(folder, render).exit_code, 0);
  const auto files = files_in(folder / "clips");
  const auto made_again = [&] {
    const RunResult run = run_program(folder, render);
    return run.err.substr(0, run.err.find(" up to date"));
  };

  fs::remove(folder / "clips/01-long.pinch.mp4");
  EXPECT_EQ(made_again(), "clips: 2 made, 4") << "with its partner: their sizes hang together";
  std::ofstream(folder / "clips/02-short.baseline.mp4", std::ios::app) << "damaged";
  EXPECT_EQ(made_again(), "clips: 2 made, 4");
  std::ofstream(folder / "clips/02-short.pinch.mp4.partial") << "left by a killed run";
  EXPECT_EQ(made_again(), "clips: 0 made, 6");
  EXPECT_EQ(files_in(folder / "clips"), files);

  write_scene(folder / "demos/02-short.json", 1.0);
  EXPECT_EQ(made_again(), "clips: 3 made, 3");
  EXPECT_EQ(run_program(folder, {"render", "--size", "32x32"}).err.substr(0, 13), "clips: 6 made");

  json manifest = json::parse(text_of(folder / "clips/manifest.json"));
  for (json& clip : manifest["clips"]) {
    clip["version"] = "0.0.0";
  }
  std::ofstream(folder / "clips/manifest.json") << manifest;
  EXPECT_EQ(made_again(), "clips: 6 made, 0");
}

// Each option gives another file, and so does the next run without it.
TEST(Batch, WhatAnOptionChangedIsMadeAnew) {
  const fs::path folder = folder_with_demos();
  std::ofstream(folder / "theme.json") << R"({"background": "#ff0000"})";
  const std::vector<std::string> short_scene = {"demos/02-short.json", "--method", "pinch"};
  const auto made = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = short_scene;
    all.insert(all.end(), more.begin(), more.end());
    const RunResult run = run_program(folder, render_with(all));
    return run.err.substr(0, run.err.find(" up to date"));
  };
  const std::string one = "clips: 1 made, 0", none = "clips: 0 made, 1";
  EXPECT_EQ(made({}), one);
  const std::vector<std::vector<std::string>> options = {
      {"--burn-time"},           {"--theme", "theme.json"}, {"--fps", "60"},
      {"--slow", "0.1-0.2:0.5"}, {"--error", "1e-3"},       {"--freeze", "0.1:0.5"}};
  for (const std::vector<std::string>& option : options) {
    EXPECT_EQ(made(option), one) << option[0];
    EXPECT_EQ(made(option), none) << option[0];
    EXPECT_EQ(made({}), one) << option[0];
    EXPECT_EQ(made({}), none) << option[0];
  }
}

// What is noted of a clip is no reason to make it once more.
TEST(Batch, ClipsThatAreHardToSeeAreKept) {
  const fs::path folder = folder_with_scene();
  json scene = small_scene();
  scene["duration_s"] = 0.1;
  scene["cables"][0]["half_width_m"] = 1e-3;
  std::ofstream(folder / "01-small.json") << scene;
  const std::vector<std::string> arguments = render_with({"01-small.json", "--method", "cable"});
  const RunResult first = run_program(folder, arguments), second = run_program(folder, arguments);
  EXPECT_NE(first.err.find("px wide"), std::string::npos) << first.err;
  EXPECT_NE(second.err.find("px wide"), std::string::npos) << second.err;
  EXPECT_NE(second.err.find("clips: 0 made, 1 up to date"), std::string::npos) << second.err;
}

// A clip of a pair that is made by itself has another size: neither entry says that they are equal.
TEST(Batch, SizesThatAreNoLongerEqualAreNotSaidToBe) {
  const fs::path folder = folder_with_demos();
  const auto render_short = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = {"demos/02-short.json"};
    all.insert(all.end(), more.begin(), more.end());
    return run_program(folder, render_with(all)).err;
  };
  const auto of_equal_size = [&] {
    const json manifest = json::parse(text_of(folder / "clips/manifest.json"));
    return std::ranges::count_if(
        manifest["clips"], [](const json& clip) { return clip.contains("equal_sizes_with"); });
  };
  render_short({});
  EXPECT_EQ(of_equal_size(), 2);
  EXPECT_TRUE(render_short({"--method", "pinch"}).starts_with("clips: 1 made"));
  EXPECT_EQ(of_equal_size(), 0);
  EXPECT_TRUE(render_short({}).starts_with("clips: 2 made, 1 up to date"));
  EXPECT_EQ(of_equal_size(), 2);
}

TEST(Batch, KeepsTheEntriesOfOtherRuns) {
  const fs::path folder = folder_with_demos();
  ASSERT_EQ(run_program(folder, render_with({"demos/01-long.json"})).exit_code, 0);
  ASSERT_EQ(
      run_program(folder, render_with({"demos/02-short.json", "--method", "cable"})).exit_code, 0);
  EXPECT_EQ(json::parse(text_of(folder / "clips/manifest.json"))["clips"].size(), 4U);
  fs::remove(folder / "clips/01-long.pinch.mp4");
  ASSERT_EQ(
      run_program(folder, render_with({"demos/02-short.json", "--method", "cable"})).exit_code, 0);
  EXPECT_EQ(json::parse(text_of(folder / "clips/manifest.json"))["clips"].size(), 3U);
}

TEST(Batch, OneFailureDoesNotStopTheOthers) {
  const fs::path folder = folder_with_demos();
  fs::create_directories(folder / "clips/01-long.pinch.mp4");  // in the way
  const RunResult run = run_program(folder, render);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_FALSE(fs::exists(folder / "clips/01-long.baseline.mp4")) << "without its partner";
  for (const auto& entry : fs::directory_iterator(folder / "clips")) {
    EXPECT_NE(entry.path().extension(), ".partial") << entry.path();
  }
  EXPECT_NE(run.err.find("01-long.pinch.mp4: not made: "), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("clips: 4 made, 0 up to date already, 2 failed"), std::string::npos)
      << run.err;
}

TEST(Batch, BadInputStopsItBeforeAnythingIsMade) {
  const fs::path folder = folder_with_demos();
  json scene = small_scene();
  scene["bodies"][0]["mass_kg"] = -1;
  std::ofstream(folder / "demos/03-bad.json") << scene;
  const RunResult run = run_program(folder, render);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.err, "demos/03-bad.json: /bodies/0/mass_kg: must be 1e-09 to 1e+12, not -1\n");
  EXPECT_FALSE(fs::exists(folder / "clips"));
}

TEST(Batch, ForeignManifestIsNotOverwritten) {
  for (const char* text :
       {"", "[]", "{\"format\": \"other\"}", "{\"format\": \"pinchlab clips 1\", \"clips\": [1]}",
        "{\"format\": \"pinchlab clips 1\", \"clips\": [{\"file\": \"../x\"}]}"}) {
    const fs::path folder = folder_with_demos();
    fs::create_directory(folder / "clips");
    std::ofstream(folder / "clips/manifest.json") << text;
    const RunResult run = run_program(folder, render);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(run.err,
              "clips/manifest.json: is not a manifest of this program; remove it to have every "
              "clip made anew\n");
    EXPECT_EQ(names_in(folder / "clips"), std::set<std::string>{"manifest.json"});
  }
  const fs::path folder = folder_with_demos();
  fs::create_directories(folder / "clips/manifest.json");
  const RunResult run = run_program(folder, render);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.err, "clips/manifest.json: cannot be read: Is a directory\n");
}

TEST(FindScenes, FolderStandsForItsNumberedScenesInOrder) {
  const fs::path folder = folder_with_demos();
  EXPECT_EQ(find_scenes({"x.json", folder / "demos"}),
            (std::vector<fs::path>{"x.json", folder / "demos/01-long.json",
                                   folder / "demos/02-short.json"}));
  EXPECT_THROW(find_scenes({folder}), std::runtime_error);
}

}  // namespace
}  // namespace pinchlab
