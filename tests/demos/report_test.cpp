// SPDX-License-Identifier: GPL-3.0-or-later
// How the clips of a pair differ: events by name, and the figures of the report.

#include <gtest/gtest.h>

#include <cmath>

#include "demos/events.h"
#include "demos/pair_report.h"
#include "demos/scenes/player.h"
#include "render/mesh.h"
#include "render/picture/scenery.h"
#include "run_program.h"
#include "tests/demos/scenes/scene_files.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A roller on a rail falls freely from h above the wrap: it pinches the cable after sqrt(2 h / g).
TEST(Events, NameThePinchAtTheTimeOfTheFall) {
  json scene = json::parse(text_of(PINCHLAB_SOURCE_DIR "/demos/03-drop.json"));
  const double top = scene["bodies"][0]["position_m"][1].get<double>() +
                     scene["bodies"][0]["radius_m"].get<double>() + 0.1;
  const double h = 0.5;  // m
  scene["bodies"][1]["restitution"] = 0.2;
  scene["bodies"][1]["position_m"][1] = top + scene["bodies"][1]["radius_m"].get<double>() + h;
  const SceneFile file = parse_scene(scene.dump(), "03-drop.json");
  Player player(file, file.scene, Method::pinch);
  EventWatch watch(file.scene);
  watch.look(player.world(), 0.0);
  player.on_step([&] { watch.look(player.world(), player.world().time()); });
  player.advance_to(60);
  const std::vector<Event> events = watch.events();
  ASSERT_GE(events.size(), 2U);
  EXPECT_EQ(events[0].what, "cable runs round pulley");
  EXPECT_EQ(events[0].from, 0.0);
  const double a_step = 1.0 / (60.0 * file.scene.steps_per_frame), fall = std::sqrt(2.0 * h / 9.81);
  EXPECT_EQ(events[1].what, "cable pinched between pulley and roller");
  EXPECT_NEAR(events[1].from, fall, 1.01 * a_step);
  EXPECT_NEAR(events[1].to, 1.0, 1e-12) << "bounces are one event";
}

// A pair that is the same twice: a scene in which nothing is ever pinched.
TEST(PairReport, OfAPairWithoutDifferenceSaysNever) {
  const SceneFile file = parse_scene(small_scene().dump(), "01-small.json");
  const fs::path strip = scratch_folder() / "strip.png";
  int ticks = 0;
  const PairReport report =
      report_pair(file, file.scene, 128, 128, strip.string(), [&] { ++ticks; });
  EXPECT_EQ(ticks, file.scene.frame_count);
  EXPECT_FALSE(report.first_difference);
  EXPECT_TRUE(report.differs.empty());
  EXPECT_EQ(report.largest_distance, 0.0);
  EXPECT_EQ(to_json(report)["same_share"], 1.0);
  EXPECT_TRUE(to_json(report)["first_difference_s"].is_null());
  EXPECT_GT(fs::file_size(strip), 500U);
}

// Before the roller lands both clips are the same; from then on it lies one cable's width deeper
// without contact, of which the report says where and by how much.
TEST(PairReport, FindsTheLandingAndTheDepthOfTheDrop) {
  json text = json::parse(text_of(PINCHLAB_SOURCE_DIR "/demos/03-drop.json"));
  text["bodies"][1]["restitution"] = 0;
  text["duration_s"] = 2;
  text["poster_time_s"] = 1;
  const SceneFile file = parse_scene(text.dump(), "03-drop.json");
  const PairReport report =
      report_pair(file, file.scene, 480, 480, (scratch_folder() / "strip.png").string(), [] {});
  ASSERT_TRUE(report.first_difference);
  const Body &pulley = file.scene.bodies[0], &roller = file.scene.bodies[1];
  const double fall =
      roller.position.y() - pulley.position.y() - pulley.radius - roller.radius - 0.1;  // m
  const double landing = std::sqrt(2.0 * fall / 9.81);
  EXPECT_NEAR(*report.first_difference / 60.0, landing, 3.0 / 60.0);
  const double scale = Fit(set_scenery(file.scene, file.look).view, 0, 480, 480).scale;  // px/m
  EXPECT_NEAR(report.largest_distance, 0.1 * scale, 0.5);
  EXPECT_EQ(report.largest_body, "roller");
  EXPECT_GT(longest(report.pinch.still), 1.0);
  EXPECT_NEAR(report.pinch.end_speed, 0.0, 0.1);
  EXPECT_NEAR(total(report.differs), 2.0 - *report.first_difference / 60.0, 1e-9);
}

TEST(PairReport, IsATableAPageAndAManifestEntry) {
  const fs::path folder = scratch_folder();
  json scene = small_scene();
  scene["title"] = "Weights & <wheel>";
  std::ofstream(folder / "01-small.json") << scene;
  const std::vector<std::string> command = {"render", "01-small.json", "--only-report", "--size",
                                            "64x64"};
  const RunResult run = run_program(folder, command);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(run.out.starts_with("pair ")) << run.out;
  EXPECT_NE(run.out.find("\n01-small "), std::string::npos) << run.out;
  EXPECT_EQ(run.out.find("()"), std::string::npos) << "of no body:\n" << run.out;
  const std::string page = text_of(folder / "clips/report.html");
  EXPECT_NE(page.find("Weights &amp; &lt;wheel&gt;"), std::string::npos);
  EXPECT_EQ(page.find("<wheel>"), std::string::npos);
  const json manifest = json::parse(text_of(folder / "clips/manifest.json"));
  ASSERT_EQ(manifest["clips"].size(), 1U);
  EXPECT_EQ(manifest["clips"][0]["role"], "report");
  EXPECT_EQ(manifest["clips"][0]["report"]["same_share"], 1.0);
  const RunResult again = run_program(folder, command);
  EXPECT_EQ(again.out, run.out);
  EXPECT_EQ(text_of(folder / "clips/report.html"), page);
  EXPECT_NE(again.err.find("0 made, 1 up to date"), std::string::npos) << again.err;
  EXPECT_EQ(
      run_program(folder, {"render", "01-small.json", "--report", "--method", "cable"}).exit_code,
      2);
}

TEST(Program, RendersTheThesisMethod) {
  const fs::path folder = scratch_folder();
  std::ofstream(folder / "01-small.json") << small_scene();
  const RunResult run =
      run_program(folder, {"render", "01-small.json", "--method", "thesis", "--size", "64x64"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(json::parse(text_of(folder / "clips/manifest.json"))["clips"][0]["methods"],
            json::parse(R"(["thesis"])"));
}

}  // namespace
}  // namespace pinchlab
