// SPDX-License-Identifier: GPL-3.0-or-later
// Sets of stimuli: the same bytes however they are made, nothing made twice, no half set ever.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "demos/research_crate.h"
#include "demos/scenes/player.h"
#include "demos/sweep.h"
#include "run_program.h"
#include "tests/demos/scenes/scene_files.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A folder with a template that wants a squeeze and a mass, and a table of five rows, two alike.
fs::path folder_with_sweep() {
  fs::path folder = scratch_folder();
  json scene = small_scene();
  scene["title"] = "squeeze ${squeeze}";
  scene["duration_s"] = 0.2;
  scene["cables"][0]["squeeze"] = "${squeeze}";
  for (json& body : scene["bodies"]) {
    if (body.contains("mass_kg")) body["mass_kg"] = "${mass}";
  }
  std::ofstream(folder / "s.json") << scene.dump(1);
  std::ofstream(folder / "t.csv") << "squeeze,mass\n0,1\n0.5,1\n0.50,1.0\n1,1\n0.5,2\n";
  return folder;
}

RunResult sweep(const fs::path& folder, const std::string& out,
                const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {"sweep",  "s.json", "t.csv",  "--out",     out,
                                        "--size", "64x64",  "--date", "2026-11-20"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(folder, arguments);
}

/// Whether a line begins so; on a slow machine progress comes before.
bool tells(const std::string& text, const std::string& line) {
  return text.starts_with(line) || text.find("\n" + line) != std::string::npos;
}

std::map<std::string, std::string> files_in(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const bool is_file = entry.is_regular_file();
    files[entry.path().filename().string()] = is_file ? text_of(entry.path()) : "a folder";
  }
  return files;
}

// What simulate would have to be given has placeholders.
TEST(Sweep, FailureOfARowNamesNoCommandThatCannotBeRun) {
  Scene scene;
  World world;
  world.failure = "step 7: velocity not finite";
  EXPECT_EQ(
      failure_of_row(failure_report("s.json", scene, world, 2)),
      "s.json: method pinch: step 7: velocity not finite; to see it again, sweep a table that "
      "holds this row alone");
  EXPECT_EQ(failure_of_row("the disk is full"), "the disk is full");
}

std::vector<std::string> with_ending(const fs::path& folder, const std::string& ending) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(ending)) names.push_back(name);
  }
  std::ranges::sort(names);
  return names;
}

TEST(Sweep, MakesAClipATableAndARecordARow) {
  const fs::path folder = folder_with_sweep();
  const RunResult run = sweep(folder, "set");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, "");
  EXPECT_TRUE(tells(run.err, "set: 5 made, 0 there already, 0 failed\n")) << run.err;
  const fs::path set = folder / "set";
  EXPECT_EQ(with_ending(set, ".mp4").size(), 5U);  // 0.5 and 0.50 have other titles
  const json manifest = json::parse(text_of(set / "manifest.json"));
  ASSERT_EQ(manifest["clips"].size(), 5U);
  std::vector<double> squeezes;
  for (const json& clip : manifest["clips"]) {
    squeezes.push_back(clip["parameters"]["squeeze"].get<double>());
    const std::string name = fs::path(clip["file"].get<std::string>()).stem().string();
    EXPECT_TRUE(name.starts_with("s-")) << name;
    const json record = json::parse(text_of(set / (name + ".json")));
    EXPECT_EQ(record["clip"], clip);
    EXPECT_EQ(record["scene"]["cables"][0]["squeeze"], squeezes.back());
    EXPECT_EQ(record["scene"]["title"].get<std::string>(), clip["title"].get<std::string>());
    EXPECT_TRUE(text_of(set / (name + ".csv")).starts_with("time_s,body,"));
  }
  std::ranges::sort(squeezes);
  EXPECT_EQ(squeezes, (std::vector<double>{0, 0.5, 0.5, 0.5, 1}));
  const std::string table = text_of(set / "stimuli.csv");
  EXPECT_TRUE(table.starts_with("squeeze,mass,clip_file,motion_file,record_file\n0,1,s-")) << table;
  EXPECT_EQ(std::ranges::count(table, '\n'), 6);
  EXPECT_EQ(text_of(set / "parameters.csv"), text_of(folder / "t.csv"));
  EXPECT_EQ(text_of(set / "s.json"), text_of(folder / "s.json"));
}

TEST(Sweep, GivesTheSameBytesInAnyShardsAndOrder) {
  const fs::path folder = folder_with_sweep();
  ASSERT_EQ(sweep(folder, "one", {"--jobs", "1"}).exit_code, 0);
  for (const char* shard : {"3/3", "1/3", "2/3"}) {
    const RunResult run = sweep(folder, "three", {"--shard", shard});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_FALSE(fs::exists(folder / "three/manifest.json"));
  }
  const RunResult merged = sweep(folder, "three", {"--merge"});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  EXPECT_EQ(files_in(folder / "one"), files_in(folder / "three"));
}

TEST(Sweep, MakesAlikeRowsOnce) {
  const fs::path folder = folder_with_sweep();
  std::ofstream(folder / "t.csv") << "squeeze,mass\n0.5,1\n0.5,1.0\n0.5,1\n";
  const RunResult run = sweep(folder, "set");
  EXPECT_TRUE(tells(run.err, "set: 1 made, ")) << run.err;
  EXPECT_EQ(with_ending(folder / "set", ".mp4").size(), 1U);
  EXPECT_EQ(std::ranges::count(text_of(folder / "set/stimuli.csv"), '\n'), 4);
}

TEST(Sweep, KeepsWhatIsThereAndMakesAnewWhatIsNotWhole) {
  const fs::path folder = folder_with_sweep();
  ASSERT_EQ(sweep(folder, "set").exit_code, 0);
  const auto before = files_in(folder / "set");
  RunResult run = sweep(folder, "set");
  EXPECT_TRUE(tells(run.err, "set: 0 made, 5 there already, 0 failed\n")) << run.err;
  const auto clips = with_ending(folder / "set", ".mp4");
  const auto tables = with_ending(folder / "set", ".csv");
  std::ofstream(folder / "set" / clips[0]) << "half";
  fs::remove(folder / "set" / fs::path(clips[1]).replace_extension(".json"));
  run = sweep(folder, "set", {"--merge"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("set: 2 of 5 stimuli are missing, the first for t.csv:"),
            std::string::npos)
      << run.err;
  run = sweep(folder, "set");
  EXPECT_TRUE(tells(run.err, "set: 2 made, 3 there already, 0 failed\n")) << run.err;
  EXPECT_EQ(files_in(folder / "set"), before);
  EXPECT_EQ(run.err.find("of other values"), std::string::npos);
  // Other settings are other stimuli.
  run = sweep(folder, "set", {"--method", "cable"});
  EXPECT_TRUE(tells(run.err, "set: 5 made, 0 there already, 0 failed\n")) << run.err;
  EXPECT_NE(run.err.find("5 clips of other values are there"), std::string::npos) << run.err;
}

// The last row takes so long that it is still made when the first ones are seen to be there.
TEST(Sweep, GoesOnWhereItWasKilled) {
  const fs::path folder = folder_with_sweep();
  json scene = json::parse(text_of(folder / "s.json"));
  scene["duration_s"] = "${seconds}";
  std::ofstream(folder / "s.json") << scene.dump(1);
  std::ofstream(folder / "t.csv")
      << "squeeze,mass,seconds\n0,1,0.2\n0.5,1,0.2\n1,1,0.2\n0.5,2,300\n";
  ASSERT_EQ(sweep(folder, "one").exit_code, 0);
  for (const int signal : {SIGKILL, SIGTERM}) {
    const std::string set = fmt::format("killed-{}", signal);
    const pid_t process = start_program(folder, {"sweep", "s.json", "t.csv", "--out", set, "--size",
                                                 "64x64", "--date", "2026-11-20", "--jobs", "1"});
    ASSERT_TRUE(wait_until(process, [&] {
      return fs::exists(folder / set) && with_ending(folder / set, ".json").size() >= 2;
    }));
    ::kill(process, signal);
    EXPECT_EQ(wait_for_program(folder, process).signal, signal);
    EXPECT_FALSE(fs::exists(folder / set / "manifest.json"));
    const RunResult run = sweep(folder, set);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_FALSE(tells(run.err, set + ": 4 made")) << run.err;
    EXPECT_EQ(files_in(folder / "one"), files_in(folder / set));
  }
}

TEST(Sweep, ChoosesMethodAndSweepsByTheRow) {
  const fs::path folder = folder_with_sweep();
  std::ofstream(folder / "t.csv") << "squeeze,mass,method,sweeps\n0,1,thesis,1\n0,1,thesis,50\n";
  RunResult run = sweep(folder, "set");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json manifest = json::parse(text_of(folder / "set/manifest.json"));
  ASSERT_EQ(manifest["clips"].size(), 2U);
  for (const json& clip : manifest["clips"]) {
    EXPECT_EQ(clip["methods"], json({"thesis"}));
    EXPECT_EQ(clip["solver_sweeps"], clip["parameters"]["sweeps"]);
  }
  EXPECT_NE(manifest["clips"][0]["raw_frames_murmur3"], manifest["clips"][1]["raw_frames_murmur3"]);
  std::ofstream(folder / "t.csv") << "squeeze,mass,sweeps\n0,1,50\n";
  run = sweep(folder, "set");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.err,
            "t.csv:2 (squeeze=0, mass=1, sweeps=50): the column sweeps has an effect with the "
            "method thesis only; leave it out, or give the row this method\n");
}

TEST(Sweep, TellsOfRowsThatCannotBe) {
  const fs::path folder = folder_with_sweep();
  std::ofstream(folder / "t.csv") << "squeeze,mass\n0,1\n1.5,1\n";
  RunResult run = sweep(folder, "set");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.err,
            "t.csv:3 (squeeze=1.5, mass=1): s.json: /cables/0/squeeze: must be 0 to 1, not 1.5\n");
  EXPECT_FALSE(fs::exists(folder / "set"));
  EXPECT_EQ(sweep(folder, "set", {"--shard", "0/3"}).exit_code, 2);
  EXPECT_EQ(sweep(folder, "set", {"--shard", "1/3", "--merge"}).exit_code, 2);
  EXPECT_EQ(sweep(folder, "set", {"--orcid", "x", "--author", "A"}).exit_code, 2);
  for (const char* no_day : {"2026-02-30", "2026-13-01", "2026-1-1", "today"}) {
    run = run_program(folder, {"sweep", "s.json", "t.csv", "--out", "set", "--date", no_day});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_TRUE(tells(run.err, fmt::format("--date: {} is no day as YYYY-MM-DD", no_day)))
        << run.err;
  }
}

TEST(Sweep, MergesNothingWhereNothingIs) {
  const RunResult run = sweep(folder_with_sweep(), "set", {"--merge"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.err,
            "set: there is no such folder; make the stimuli first, by the same command without "
            "--merge\n");
}

TEST(Sweep, ReportsHowEachRowsPairDiffers) {
  const fs::path folder = folder_with_sweep();
  std::ofstream(folder / "t.csv") << "squeeze,mass\n0,1\n";
  const RunResult run = sweep(folder, "set", {"--report"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ASSERT_EQ(with_ending(folder / "set", ".png").size(), 1U);
  const std::string record = fs::path(with_ending(folder / "set", ".mp4")[0]).stem().string();
  EXPECT_TRUE(json::parse(text_of(folder / "set" / (record + ".json")))["report"].contains(
      "largest_distance_px"));
  EXPECT_NE(text_of(folder / "set/stimuli.csv").find("first_difference_s,largest_distance_px"),
            std::string::npos);
}

TEST(Series, StandsOnOneSheet) {
  const fs::path folder = folder_with_sweep();
  const std::vector<std::string> still = {"still",      "s.json", "--table", "squeeze=0:1:5",
                                          "mass=1",     "--time", "0,0.1",   "--out",
                                          "graded.svg", "--size", "100x100"};
  ASSERT_EQ(run_program(folder, still).exit_code, 0);
  const std::string svg = text_of(folder / "graded.svg");
  double width = 0.0, height = 0.0;  // five columns of 100 px, two rows, gaps and labels
  const std::size_t size = svg.find("width=");
  ASSERT_NE(size, std::string::npos);
  ASSERT_EQ(std::sscanf(svg.c_str() + size, "width=\"%lfpx\" height=\"%lfpx\"", &width, &height),
            2);
  EXPECT_GT(width, 500.0);
  EXPECT_LT(width, 600.0);
  EXPECT_GT(height, 200.0);
  EXPECT_LT(height, 300.0);
  ASSERT_EQ(run_program(folder, still).exit_code, 0);
  EXPECT_EQ(text_of(folder / "graded.svg"), svg);
  std::vector<std::string> wrong = still;
  wrong[8] = "graded.jpg";
  EXPECT_EQ(run_program(folder, wrong).err, "graded.jpg: --out must end in .png, .svg or .pdf\n");
  wrong = still;
  wrong[6] = "0.1,0";  // back in time
  EXPECT_EQ(run_program(folder, wrong).exit_code, 2);
}

/// What is wrong with a crate after a change of it.
std::vector<std::string> problems_after(const fs::path& set,
                                        const std::function<void(json& graph)>& change) {
  const std::string before = text_of(set / "ro-crate-metadata.json");
  json document = json::parse(before);
  change(document["@graph"]);
  std::ofstream(set / "ro-crate-metadata.json") << document.dump();
  std::vector<std::string> problems = problems_of_crate(set);
  std::ofstream(set / "ro-crate-metadata.json") << before;
  return problems;
}

TEST(Crate, IsWholeAndEveryBreachIsSeen) {
  const fs::path folder = folder_with_sweep();
  ASSERT_EQ(sweep(folder, "set",
                  {"--title", "T", "--author", "A. Name", "--orcid",
                   "https://orcid.org/0000-0002-1825-0097", "--licence",
                   "https://spdx.org/licenses/CC-BY-4.0"})
                .exit_code,
            0);
  const fs::path set = folder / "set";
  EXPECT_EQ(problems_of_crate(set), std::vector<std::string>());
  EXPECT_EQ(run_program(folder, {"crate", "set"}).exit_code, 0);

  const auto entity = [](json& graph, const std::string& key, const std::string& value) -> json& {
    return *std::ranges::find_if(graph, [&](const json& e) { return e.value(key, "") == value; });
  };
  const std::vector<std::function<void(json&)>> breaches = {
      [&](json& g) { entity(g, "@id", "./").erase("datePublished"); },
      [&](json& g) { entity(g, "@id", "./").erase("conformsTo"); },
      [&](json& g) { entity(g, "@id", "./").erase("mentions"); },
      [&](json& g) { entity(g, "@id", "./")["hasPart"].erase(0); },
      [&](json& g) { entity(g, "@id", "./")["@id"] = "root"; },
      [&](json& g) { entity(g, "@id", "ro-crate-metadata.json").erase("about"); },
      [&](json& g) { entity(g, "@id", "ro-crate-metadata.json").erase("conformsTo"); },
      [&](json& g) { entity(g, "@id", "#pinchlab").erase("softwareVersion"); },
      [&](json& g) { entity(g, "@id", "#pinchlab")["@type"] = "Person"; },
      [&](json& g) { entity(g, "@type", "CreateAction").erase("instrument"); },
      [&](json& g) { entity(g, "@type", "CreateAction").erase("result"); },
      [&](json& g) {
        entity(g, "@type", "CreateAction")["agent"] = {{"@id", "#nobody"}};
      },
      [&](json& g) {
        entity(g, "@type", "CreateAction")["agent"] = {{"name", "nested"}};
      },
      [&](json& g) { entity(g, "@type", "File")["sha256"] = "0"; },
      [&](json& g) { entity(g, "@type", "File")["@id"] = "/etc/passwd"; },
      [&](json& g) { g.push_back(g[0]); },
      [&](json& g) {
        g.push_back({{"@id", "x"}});
      }};
  for (std::size_t i = 0; i < breaches.size(); ++i) {
    EXPECT_FALSE(problems_after(set, breaches[i]).empty()) << "breach " << i;
  }
  std::ofstream(set / "more.txt") << "x";
  EXPECT_EQ(problems_of_crate(set),
            std::vector<std::string>{"more.txt: is in the folder, but not in the crate"});
  fs::remove(set / "more.txt");
  const std::string clip = with_ending(set, ".mp4")[0];
  std::ofstream(set / clip, std::ios::app) << "x";
  EXPECT_EQ(problems_of_crate(set),
            std::vector<std::string>{clip + ": has changed: its size or SHA-256 is another one"});
  fs::remove(set / clip);
  const RunResult run = run_program(folder, {"crate", "set"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.out, "set/" + clip + ": is not in the folder\n");
}

}  // namespace
}  // namespace pinchlab
