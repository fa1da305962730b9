// SPDX-License-Identifier: GPL-3.0-or-later
// `simulate` as a user runs it, and what plays a scene for it.

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "demos/scenes/player.h"
#include "sim/step.h"
#include "tests/demos/scene_folders.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;

using Rows = std::vector<std::vector<std::string>>;

Rows rows_of(const std::string& csv) {
  Rows rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      rows.back().push_back(cell);
    }
  }
  return rows;
}

TEST(Simulate, WritesOneRowABodyAndFrame) {
  const fs::path folder = folder_with_scene();
  const RunResult run =
      run_program(folder, {"simulate", "01-small.json", "--out", "-", "--segments", "s.csv"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const Rows rows = rows_of(run.out);
  ASSERT_EQ(rows.size(), 1U + 60U * 3U);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"time_s", "body", "x_m", "y_m", "angle_rad",
                                               "vx_m_s", "vy_m_s", "omega_rad_s"}));
  EXPECT_EQ(rows[2],
            (std::vector<std::string>{"0", "left weight", "-0.55", "-2", "0", "0", "0", "0"}));

  // Every number reads back as exactly what the simulation has.
  const SceneFile file = read_scene_file(folder / "01-small.json");
  Player player(file, file.scene, Method::pinch);
  for (int frame = 0; frame < 60; ++frame) {
    player.advance_to(frame);
    EXPECT_EQ(player.world().step, 4 * frame);
    const Velocities velocity = player.velocities();
    for (std::size_t body = 0; body < 3; ++body) {
      const auto& row = rows[1 + 3 * static_cast<std::size_t>(frame) + body];
      ASSERT_EQ(row.size(), 8U);
      const std::vector<double> expected = {
          player.world().position[body].x(), player.world().position[body].y(),
          player.world().angle[body],        velocity.linear[body].x(),
          velocity.linear[body].y(),         velocity.angular[body]};
      EXPECT_EQ(std::stod(row[0]), frame / 30.0);
      EXPECT_EQ(row[1], file.scene.bodies[body].name);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(std::strtod(row[i + 2].c_str(), nullptr), expected[i]);
      }
    }
  }
}

TEST(Simulate, WritesOneRowASegmentAndFrame) {
  const fs::path folder = folder_with_scene();
  ASSERT_EQ(
      run_program(folder, {"simulate", "01-small.json", "--out", "t.csv", "--segments", "s.csv"})
          .exit_code,
      0);
  const Rows rows = rows_of(text_of(folder / "s.csv"));
  ASSERT_EQ(rows.size(), 1U + 60U * 2U);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"time_s", "cable", "segment", "from_body", "to_body",
                                               "length_m", "rest_length_m", "tension_n", "pinched",
                                               "slipping"}));
  // Atwood's machine with a disc: T = m (g + a), a = g (m2 - m1) / (m1 + m2 + I / R^2), R with the
  // cable's half width.
  const double a = 9.81 * 0.2 / (2.2 + 0.25 / (0.55 * 0.55));  // m/s^2
  for (std::size_t i = 3; i < rows.size(); ++i) {
    const bool left = i % 2 == 1;
    ASSERT_EQ(rows[i].size(), 10U);
    EXPECT_EQ(rows[i][1], "rope");
    EXPECT_EQ(rows[i][2], left ? "0" : "1");
    EXPECT_EQ(rows[i][3], left ? "left weight" : "wheel");
    EXPECT_EQ(rows[i][4], left ? "wheel" : "right weight");
    EXPECT_NEAR(std::stod(rows[i][5]), std::stod(rows[i][6]), 1e-9);
    EXPECT_NEAR(std::stod(rows[i][7]), left ? 9.81 + a : 1.2 * (9.81 - a), 1e-6);
    EXPECT_EQ(rows[i][8] + rows[i][9], "00");
  }
}

TEST(Simulate, GivesUpAfterTheTimeLimit) {
  const fs::path folder = folder_with_scene();
  const RunResult run = run_program(
      folder, {"simulate", "01-small.json", "--out", "x.csv", "--time-limit", "0.000001"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(
      run.err,
      "01-small.json: method pinch: given up at t = 0.00833333 s, step 1, after the 1e-06 s of "
      "--time-limit; fewer steps a frame or fewer bodies are faster\n");
  EXPECT_FALSE(fs::exists(folder / "x.csv"));
  EXPECT_EQ(
      run_program(folder, {"simulate", "01-small.json", "--out", "x.csv", "--time-limit", "3600"})
          .exit_code,
      0);
}

TEST(Simulate, UntilAndTiming) {
  const fs::path folder = folder_with_scene();
  const auto rows = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"simulate", "01-small.json", "--out", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return rows_of(run_program(folder, arguments).out);
  };
  EXPECT_EQ(rows({"--until", "0"}).size(), 1U + 3U);
  EXPECT_EQ(rows({"--until", "0.3"}).size(), 1U + 10U * 3U);  // frames 0 to 9, at 30 a second
  EXPECT_EQ(rows({"--until", "0.34"}).size(), 1U + 11U * 3U);
  EXPECT_EQ(rows({"--until", "2.5"}).size(), 1U + 76U * 3U);  // beyond the clip
  // Twice the frames of half the steps: the same motion at the common times.
  const Rows usual = rows({"--until", "1"}), twice = rows({"--until", "1", "--fps", "60"});
  ASSERT_EQ(twice.size(), 1U + 61U * 3U);
  EXPECT_EQ(usual.back(), twice.back());
  const Rows fine = rows({"--until", "1", "--steps-per-frame", "64"});
  EXPECT_NE(usual.back(), fine.back());
  EXPECT_NEAR(std::stod(usual.back()[3]), std::stod(fine.back()[3]), 1e-3);
}

// A rope that bends at 9 nodes needs more than 4 steps a frame; where it may choose, it has the
// nodes that a file with these steps gives it.
TEST(Simulate, NodesFollowTheStepsThatAreAskedFor) {
  const fs::path folder = folder_with_scene();
  const auto write = [&folder](const char* nodes, const char* steps) {
    std::ofstream(folder / "02-rope.json") << R"({
      "title": "Rope", "duration_s": 0.5, "view": "fit",
      "baseline": {"method": "cable", "reason": "it is plain"},
      "bodies": [{"name": "a", "kind": "rail", "rail_axis": [1, 0], "radius_m": 0.01,
                  "mass_kg": 0.1, "position_m": [1, 0]}],
      "cables": [{"name": "c", "half_width_m": 0.005, "mass_per_metre_kg": 1,
                  "bending_stiffness_n_m2": 8, "start": {"world_m": [0, 0]}, "end": {"body": "a"},
                  "nodes": )" << nodes << R"(}], "steps_per_frame": )"
                                           << steps << "}\n";
  };
  const auto simulate = [&folder](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"simulate", "02-rope.json", "--out", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(folder, arguments);
  };
  write("9", "4");
  const std::string refusal = simulate({}).err;
  EXPECT_NE(refusal.find("faster than 4 steps a frame follow"), std::string::npos) << refusal;
  const RunResult asked = simulate({"--steps-per-frame", "16"});
  EXPECT_EQ(asked.exit_code, 0) << asked.err;
  const std::string as_long = simulate({"--fps", "240"}).err;
  EXPECT_NE(as_long.find("faster than 1 steps a frame follow"), std::string::npos) << as_long;
  write("9", "16");
  EXPECT_EQ(simulate({}).out, asked.out);
  EXPECT_EQ(simulate({"--steps-per-frame", "4"}).err, refusal);
  write("\"automatic\"", "4");
  const RunResult chosen = simulate({"--steps-per-frame", "16"});
  EXPECT_NE(simulate({}).out, chosen.out);
  write("\"automatic\"", "16");
  EXPECT_EQ(simulate({}).out, chosen.out);
}

TEST(WithTiming, KeepsTheDurationAndNoStepGetsLonger) {
  Scene scene;
  scene.frame_count = 300;
  scene.frames_per_second = 60;
  scene.steps_per_frame = 4;
  for (const int rate : {1, 24, 25, 30, 50, 60, 120, 240, 300, 1000}) {
    const Scene changed = with_timing(scene, {rate, {}});
    EXPECT_EQ(changed.frame_count, 5 * rate);
    EXPECT_LE(step_length(changed), step_length(scene));
    if (changed.steps_per_frame > 1) {  // one step fewer would be too long
      EXPECT_GT(1.0 / (rate * (changed.steps_per_frame - 1)), step_length(scene));
    }
  }
  EXPECT_EQ(with_timing(scene, {{}, 9}).steps_per_frame, 9);
  EXPECT_EQ(with_timing(scene, {30, 2}).steps_per_frame, 2);
  scene.frame_count = 301;
  EXPECT_THROW(with_timing(scene, {30, {}}), std::invalid_argument);
  EXPECT_THROW(with_timing(scene, {0, {}}), std::invalid_argument);
}

// However many sweeps it has, and whatever else is asked of it, thesis is what to type.
TEST(Player, NamesTheThesisByItsWays) {
  Configuration thesis = thesis_configuration();
  EXPECT_STREQ(to_string(thesis), "thesis");
  thesis.iterations = 40;
  thesis.sleep = true;
  thesis.diagnostics = true;
  EXPECT_STREQ(to_string(thesis), "thesis");
  EXPECT_STREQ(in_words(thesis), "the thesis' pinch joints");
  thesis.solver = Solver::direct;
  EXPECT_STREQ(to_string(thesis), "pinch");
}

TEST(Player, FailureSaysHowToSeeItAgain) {
  Scene scene;
  World world;
  world.configuration.method = Method::cable;
  world.failure = "step 1841, cable 3, segment 12: velocity not finite";
  EXPECT_EQ(
      failure_report("demos/03-drop.json", scene, world, 461),
      "demos/03-drop.json: method cable: step 1841, cable 3, segment 12: velocity not finite; to "
      "see it again: "
      "pinchlab simulate demos/03-drop.json --method cable --fps 60 --steps-per-frame 4 "
      "--until 7.683333333333334 --out -");
  scene.error = 1e-3;
  world.configuration = thesis_configuration();
  world.configuration.iterations = 40;
  const std::string report = failure_report("s.json", scene, world, 6);
  EXPECT_NE(report.find("pinchlab simulate s.json --method thesis --fps 60 --steps-per-frame 4 "
                        "--until 0.1 --out - (but with 40 sweeps"),
            std::string::npos)
      << report;
  world.configuration = Method::pinch;
  EXPECT_NE(failure_report("s.json", scene, world, 6).find("--error 0.001 --until 0.1 "),
            std::string::npos);
  // With the nodes of other steps it would be another motion.
  const std::vector<ChosenNodes> nodes = {{"rope", 63}, {"chain", 7}};
  EXPECT_TRUE(failure_report("s.json", scene, world, 6, nodes)
                  .ends_with("--out -; before that, give \"nodes\": 63 to cable \"rope\", 7 to "
                             "cable \"chain\", since more steps give more nodes"));
}

}  // namespace
}  // namespace pinchlab
