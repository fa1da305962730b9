// SPDX-License-Identifier: GPL-3.0-or-later
// What is believed of a simulation's error, against motions that are known.

#include "demos/scenes/fineness.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "demos/scenes/build.h"
#include "sim/joints.h"
#include "tests/demos/scene_folders.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;

/// A motion along x, of the scene's first body, that is known.
struct Known {
  const char* name;
  Scene scene;
  std::function<double(double t)> x;  // m, at t s
};

Scene one_body(double x, double speed) {
  Scene scene;
  scene.name = "known";
  scene.gravity = Vec2::Zero();
  scene.bodies.push_back(build::body("a", BodyKind::free, x, 0.0, 0.1));
  scene.bodies[0].velocity.x() = speed;
  scene.frame_count = 121;
  return scene;
}

/// x'' = -(k / m) (x - L), from x_0 at rest.
Known on_a_spring() {
  Known known{"spring", one_body(1.0, 0.0),
              [](double t) { return 0.8 + 0.2 * std::cos(20.0 * t); }};
  add_spring(known.scene, "spring", build::at(0.0, 0.0), build::on(0), 400.0, 0.8, 0.0);
  return known;
}

/// v' = -d v.
Known dragged() {
  Known known{"drag", one_body(0.0, 2.0),
              [](double t) { return 2.0 / 3.0 * (1.0 - std::exp(-3.0 * t)); }};
  known.scene.bodies[0].linear_drag = 3.0;
  return known;
}

/// The most by which the body is off at a frame.
double true_error(const Known& known, const SceneFile& file, int factor) {
  Player player(file, made_finer(known.scene, factor), Method::pinch);
  double most = 0.0;
  for (int frame = 0; frame < known.scene.frame_count; ++frame) {
    player.advance_to(frame);
    most = std::max(most, std::abs(player.world().position[0].x() - known.x(player.time())));
  }
  return most;
}

TEST(Fineness, BelievesWhatIsTrue) {
  for (Known known : {on_a_spring(), dragged()}) {
    SceneFile file;
    file.scene = known.scene;
    int factor = 0;
    for (const double share : {2.0, 0.2, 0.04}) {
      known.scene.error = share * true_error(known, file, 1);
      const Fineness found = find_fineness(file, known.scene, Method::pinch,
                                           known.scene.frame_count - 1, std::nullopt);
      ASSERT_TRUE(found.believed) << known.name;
      EXPECT_GT(found.factor, factor) << known.name << ' ' << share;
      factor = found.factor;
      EXPECT_EQ(found.steps_per_frame, known.scene.steps_per_frame * factor);
      EXPECT_LE(*found.believed, known.scene.error) << known.name << ' ' << share;
      const double error = true_error(known, file, factor);
      EXPECT_LE(error, *found.believed) << known.name << ' ' << share;
      EXPECT_GE(error, 0.5 * *found.believed) << known.name << ' ' << share;
    }
  }
}

TEST(Fineness, SaysWhereItIsNotReached) {
  Known known = on_a_spring();
  known.scene.error = 1e-9;
  SceneFile file;
  file.scene = known.scene;
  const Fineness found = find_fineness(file, known.scene, Method::pinch, 60, std::nullopt);
  EXPECT_EQ(found.factor, 8);
  ASSERT_TRUE(found.believed);
  EXPECT_GT(*found.believed, 1e-6);
  std::vector<std::string> lines;
  add_missed_error(found, Method::pinch, lines);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("more than the error of 1e-09 m asked for, with 32 steps a frame"),
            std::string::npos)
      << lines[0];
}

// Each measurement begins anew: what is told of how far it is stays below 100 %.
TEST(Fineness, TellsHowFarEachMeasurementIs) {
  Known known = on_a_spring();
  known.scene.error = 1e-9;
  SceneFile file;
  file.scene = known.scene;
  std::map<int, int> first, last;  // frame, by steps a frame
  find_fineness(file, known.scene, Method::pinch, 60, std::nullopt, [&](int steps, int frame) {
    first.emplace(steps, frame);
    EXPECT_EQ(frame, last.contains(steps) ? last[steps] + 1 : 1);
    last[steps] = frame;
  });
  EXPECT_EQ(first.at(32), 1);
  EXPECT_EQ(last.at(32), 60);
}

TEST(Fineness, MeasuresNothingThatNobodyAskedFor) {
  Known known = on_a_spring();
  SceneFile file;
  file.scene = known.scene;
  EXPECT_FALSE(find_fineness(file, known.scene, Method::pinch, 60, std::nullopt).believed);
  known.scene.error = 1e-3;
  for (const Configuration& fixed : {Configuration(Method::cable), thesis_configuration()}) {
    const Fineness found = find_fineness(file, known.scene, fixed, 60, std::nullopt);
    EXPECT_FALSE(found.believed);
    EXPECT_EQ(found.factor, 1);
  }
}

constexpr const char* spring_scene = R"({"title": "t", "duration_s": 1, "view": "fit",
  "baseline": {"method": "cable", "reason": "x"}, "error_m": 1e-5, "cables": [],
  "bodies": [{"name": "a", "kind": "rail", "radius_m": 0.1, "mass_kg": 1, "position_m": [1, 0],
              "rail_axis": [1, 0]}],
  "joints": [{"name": "s", "kind": "spring", "start": {"world_m": [0, 0]}, "end": {"body": "a"},
              "stiffness_n_m": 400, "natural_length_m": 0.8}]})";

TEST(Fineness, IsToldByEveryCommand) {
  const fs::path folder = scratch_folder();
  std::ofstream(folder / "01-spring.json") << spring_scene;
  const RunResult table = run_program(folder, {"simulate", "01-spring.json", "--out", "a.csv"});
  EXPECT_EQ(table.exit_code, 0) << table.err;
  EXPECT_NE(table.err.find("(1e-05 m asked), with 32 steps a frame"), std::string::npos)
      << table.err;
  const RunResult wide =
      run_program(folder, {"simulate", "01-spring.json", "--out", "a.csv", "--error", "0.01"});
  EXPECT_NE(wide.err.find("(0.01 m asked), with 4 steps a frame"), std::string::npos) << wide.err;
  const RunResult still = run_program(folder, {"still", "01-spring.json", "--time", "0.5", "--out",
                                               "a.png", "--size", "64x64", "--error", "1e-4"});
  EXPECT_EQ(still.exit_code, 0) << still.err;
  EXPECT_NE(still.err.find("pinch: bodies are believed within "), std::string::npos) << still.err;
  EXPECT_NE(still.err.find("(0.0001 m asked), with "), std::string::npos) << still.err;
  const RunResult clip = run_program(
      folder, {"render", "01-spring.json", "--out", "clips", "--size", "64x64", "--error", "1e-8"});
  EXPECT_EQ(clip.exit_code, 0) << clip.err;
  EXPECT_NE(clip.err.find("more than the error of 1e-08 m asked for"), std::string::npos)
      << clip.err;
  const auto manifest = nlohmann::json::parse(text_of(folder / "clips" / "manifest.json"));
  for (const auto& entry : manifest["clips"]) {
    const bool divides = entry["role"] != "baseline";
    ASSERT_EQ(entry.contains("accuracy"), divides) << entry.dump(2);
    if (!divides) continue;
    EXPECT_EQ(entry["accuracy"][0]["method"], "pinch");
    EXPECT_EQ(entry["accuracy"][0]["steps_per_frame"], 32);
    EXPECT_GT(entry["accuracy"][0]["believed_error_m"], 1e-8);
  }
}

}  // namespace
}  // namespace pinchlab
