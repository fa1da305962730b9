// SPDX-License-Identifier: GPL-3.0-or-later
// Options that would do nothing, and values that are half read, are refused by name.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/demos/scene_folders.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;

struct BadUse {
  std::vector<std::string> command;
  const char* message;  // a part of it
};

const BadUse bad_uses[] = {
    // Nothing reads it
    {{"simulate", "01-small.json", "--out", "a.csv", "--method", "cable", "--error", "0.001"},
     "--error: steps of the method cable are not divided"},
    {{"simulate", "01-small.json", "--out", "a.csv", "--method", "thesis", "--error", "0.001"},
     "--error: steps of the method thesis are not divided"},
    {{"render", "01-small.json", "--method", "cable", "--error", "0.001"},
     "--error: steps of the method cable are not divided"},
    {{"stopping", "--participants", "20,40", "--share", "0.7", "--bayes-factor", "6"},
     "--bayes-factor: goes with --rule bayes-factor"},
    {{"stopping", "--participants", "20,40", "--share", "0.7", "--rule", "bayes-factor", "--alpha",
      "0.01"},
     "--alpha: has no effect on --rule bayes-factor"},
    {{"stopping", "--participants", "16,32", "--share", "0.7", "--rule", "fixed"},
     "--participants: --rule fixed looks once"},
    {{"stopping", "--participants", "16,32", "--share", "0.7", "--icc", "0.1"},
     "--icc: is about several answers of one participant"},
    {{"power", "--share", "0.7", "--icc", "0.1"},
     "--icc: is about several answers of one participant"},
    {{"still", "01-small.json", "--time", "1", "--neutral", "--out", "x.png"},
     "--neutral: is about the labels of a sheet"},
    {{"render", "01-small.json", "--only-report", "--side-by-side"}, "--side-by-side"},
    {{"render", "01-small.json", "--only-report", "--attention-checks"}, "--attention-checks"},
    {{"render", "01-small.json", "--only-report", "--codec", "vp9"}, "--codec"},
    {{"render", "01-small.json", "--only-report", "--freeze", "1:0.5"}, "--freeze"},
    // Half read
    {{"still", "01-small.json", "--time", "0,,1", "--out", "x.png"}, "--time must be 0 to 2 s"},
    {{"still", "01-small.json", "--time", "0,", "--out", "x.png"}, "--time must be 0 to 2 s"},
    {{"power", "--share", "1"}, "--share: must be above 0 and below 1"},
    {{"power", "--share", "0"}, "--share: must be above 0 and below 1"},
    // It was simulated beyond the clip's end, and what was out of other bounds was told by those
    {{"advise", "01-small.json", "--error", "0.01", "--time", "0.01"},
     "01-small.json: --time must be 0.0333 to 2 s, from a frame to the whole clip, not 0.01"},
    {{"advise", "01-small.json", "--error", "0.01", "--time", "1000"},
     "01-small.json: --time must be 0.0333 to 2 s, from a frame to the whole clip, not 1000"},
    {{"advise", "01-small.json", "--error", "0.01", "--time", "2.1"},
     "01-small.json: --time must be 0.0333 to 2 s, from a frame to the whole clip, not 2.1"},
    {{"stopping", "--participants", "16,,32", "--share", "0.7"}, "--participants: 16,,32 is not"},
    {{"study", "serve", "--clips", "clips", "--answers", "answers", "--name", "bad name"},
     "--name: bad name is no name of a computer"},
    {{"study", "serve", "--clips", "clips", "--answers", "answers", "--name", "https://a.org"},
     "--name: https://a.org is no name of a computer"},
    {{"analyse", "a.csv", "--out", "set", "--map-column", "positon=x"},
     "--map-column: we have no column `positon` (did you mean `position`?)"},
    {{"analyse", "a.csv", "--out", "set", "--map-column", "side=x", "--map-column", "group=x"},
     "--map-column: `x` is mapped to twice"},
    // No whole number, or no number at all
    {{"simulate", "01-small.json", "--out", "a.csv", "--steps-per-frame", "1.5"},
     "--steps-per-frame: 1.5 is not a whole number from 1 to 1000000"},
    {{"simulate", "01-small.json", "--out", "a.csv", "--steps-per-frame", "abc"},
     "--steps-per-frame: abc is not a whole number from 1 to 1000000"},
    {{"render", "01-small.json", "--jobs", "010"}, "--jobs: 010 is not a whole number from 1 to"},
    {{"analyse", "a.csv", "--out", "set", "--seed", "-1"},
     "--seed: -1 is not a whole number from 0 to 9007199254740991"},
    {{"power", "--share", "0.7", "--trials", "2.5"},
     "--trials: 2.5 is not a whole number from 1 to 1000"},
    {{"power", "--share", "0,7"}, "--share: 0,7 is not a number"},
    {{"simulate", "01-small.json", "--out", "a.csv", "--until", "soon"},
     "--until: soon is not a number"},
    {{"simulate", "01-small.json", "--out", "a.csv", "--until", "1", "--until", "2"},
     "--until: is given 2 times; give it once"},
    {{"analyse", "a.csv", "--out", "set", "--lapse", "no"},
     "--lapse: no is neither `free` nor a number from 0 to 0.5"},
    // No room for a function
    {{"analyse", "levels.csv", "--out", "set", "--guess", "0.6", "--lapse", "0.5"},
     "--guess, --lapse: guesses of 0.6 and lapses of 0.5 leave no room"},
    {{"analyse", "levels.csv", "--out", "set", "--guess", "free", "--lapse", "0.5"},
     "--guess, --lapse: guesses of up to 0.5 and lapses of 0.5 leave no room"},
    {{"analyse", "levels.csv", "--out", "set", "--lapse", "0.5"}, "leave no room"},
    // Without the option's name nobody knows which is meant
    {{"render", "01-small.json", "--slow", "1"}, "--slow: 1 is not FROM-TO:FACTOR"},
    {{"render", "01-small.json", "--freeze", "1"}, "--freeze: 1 is not TIME:SECONDS"},
    {{"sweep", "01-small.json", "a=0:1:2", "--out", "set", "--shard", "3"},
     "--shard: 3 is not I/N"},
    {{"sweep", "01-small.json", "a=0:1:1", "--out", "set"},
     "a=0:1:1: a range has 2 to 100000 values, its ends among them; one value is a=0"},
};

TEST(Usage, WhatWouldDoNothingIsRefused) {
  const fs::path folder = folder_with_scene();
  std::ofstream(folder / "levels.csv") << "level,correct,trials\n0.1,5,10\n0.2,8,10\n0.3,9,10\n";
  for (const BadUse& bad : bad_uses) {
    const RunResult run = run_program(folder, bad.command);
    const std::string command = fmt::format("{}", fmt::join(bad.command, " "));
    EXPECT_EQ(run.exit_code, 2) << command << "\n" << run.err;
    EXPECT_EQ(run.out, "") << command;
    EXPECT_NE(run.err.find(bad.message), std::string::npos) << command << "\n" << run.err;
  }
  for (const char* made : {"a.csv", "x.png", "clips", "set", "answers"}) {
    EXPECT_FALSE(fs::exists(folder / made)) << made;
  }
}

TEST(Usage, WhatIsOfUseIsNot) {
  const fs::path folder = folder_with_scene();
  const std::vector<std::vector<std::string>> good = {
      {"simulate", "01-small.json", "--out", "a.csv", "--method", "cable", "--error", "0"},
      {"simulate", "01-small.json", "--out", "a.csv", "--error", "0.001"},
      {"still", "01-small.json", "--time", "0,1", "--neutral", "--size", "64x64", "--out", "x.png"},
      // The scene may stand behind any option
      {"still", "--time", "0", "--time", "1", "01-small.json", "--size", "64x64", "--out", "x.png"},
      {"render", "--codec", "ffv1", "--size", "64x64", "--pair", "pinch,cable", "01-small.json"},
      {"render", "--codec", "ffv1", "--size", "64x64", "--slow", "0.1-0.2:0.5", "01-small.json"},
      {"render", "--codec", "ffv1", "--size", "64x64", "--freeze", "1:0.1", "--freeze", "0.5:0.1",
       "01-small.json"},
      {"stopping", "--participants", "40", "--share", "0.7", "--rule", "fixed"},
      {"power", "--share", "0.8", "--trials", "2", "--icc", "0.1"}};
  for (const auto& command : good) {
    EXPECT_EQ(run_program(folder, command).exit_code, 0)
        << fmt::format("{}", fmt::join(command, " "));
  }
}

// Before minutes of work, not after.
TEST(Usage, WhatCannotBeReadOrWrittenIsToldAtOnce) {
  const fs::path folder = folder_with_scene();
  fs::create_directories(folder / "demos");
  fs::copy(folder / "01-small.json", folder / "demos" / "01-small.json");
  nlohmann::json scene = small_scene();
  scene["title"] = "${name}";
  std::ofstream(folder / "table.json") << scene;
  std::ofstream(folder / "a.key.json") << "{}";
  const std::pair<std::vector<std::string>, const char*> bad[] = {
      {{"simulate", "01-small.json", "--out", "none/a.csv", "--error", "1e-3", "--time-limit",
        "1e-6"},
       "none/a.csv: the folder none does not exist; create it first\n"},
      {{"still", "01-small.json", "--time", "2", "--out", "none/a.png"},
       "none/a.png: the folder none does not exist; create it first\n"},
      {{"still", "01-small.json", "--time", "0:2", "--out", "01-small.json/#.png"},
       "01-small.json: is not a folder; name another one\n"},
      {{"still", "table.json", "--table", "name=a", "--time", "2", "--out", "none/a.svg"},
       "none/a.svg: the folder none does not exist; create it first\n"},
      {{"study", "export", "--jatos", "none/a.jzip", "--clips", "clips", "--participants", "4"},
       "none/a.jzip: the folder none does not exist; create it first\n"},
      {{"study", "export", "--jatos", "a.jzip", "--clips", "clips", "--participants", "4"},
       "a.key.json: is there already, and answers to its archive need it; choose another name\n"},
      {{"study", "serve", "--clips", "clips", "--answers", "01-small.json", "--port", "0"},
       "01-small.json: cannot be made: Not a directory; use another --answers\n"},
      {{"study", "freeze", "--clips", "clips", "--answers", "answers", "--out", "frozen",
        "--stopping", "none.json"},
       "none.json: cannot be opened: No such file or directory\n"},
      {{"study", "freeze", "--clips", "clips", "--answers", "answers", "--out", "frozen",
        "--participants", "4", "--rules", "none.json"},
       "none.json: cannot be opened: No such file or directory\n"}};
  for (const auto& [command, message] : bad) {
    const RunResult run = run_program(folder, command);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(run.err, message) << fmt::format("{}", fmt::join(command, " "));
  }
  EXPECT_FALSE(fs::exists(folder / "clips"));
}

TEST(Usage, AConfigurationIsNotOverwritten) {
  const fs::path folder = scratch_folder();
  const std::string config = R"({"format": "pinchlab-study 1", "demonstrations": ["a"]})";
  std::ofstream(folder / "study.json") << config;
  const RunResult run =
      run_program(folder, {"study", "export", "--jatos", "./study.json", "--clips", "clips",
                           "--participants", "4", "--config", "study.json"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err, "./study.json: is the configuration; give the archive another name\n");
  EXPECT_EQ(text_of(folder / "study.json"), config);
}

// Nobody makes a file there, not even root.
TEST(Usage, AFolderThatTakesNoFilesIsToldAtOnce) {
  const fs::path folder = folder_with_scene();
  const RunResult run = run_program(folder, {"render", "01-small.json", "--out", "/proc/self"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_TRUE(run.err.starts_with("/proc/self/manifest.json: cannot be written: ")) << run.err;
  EXPECT_EQ(run.err.find("not made"), std::string::npos) << run.err;
}

TEST(Usage, FilesAreToldByTheNamesThatTheyGet) {
  const fs::path folder = folder_with_scene();
  const pid_t process =
      start_program(folder, {"render", "01-small.json", "--size", "64x64", "--out", "clips"}, 1000);
  const RunResult run = wait_for_program(folder, process);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("01-small.pinch.mp4: not made: clips/01-small.pinch.mp4: cannot be "),
            std::string::npos)
      << run.err;
  EXPECT_EQ(run.err.find("unpadded"), std::string::npos) << run.err;
}

// Or the next file that is opened would take its place, and the messages.
TEST(Usage, AClosedStreamTakesNoFilesPlace) {
  const fs::path folder = folder_with_scene();
  const auto run = [&folder](const char* to) {
    return std::system(fmt::format("cd '{}' && '{}' simulate 01-small.json --until 0.51 --out {}",
                                   folder.string(), PINCHLAB_PROGRAM, to)
                           .c_str());
  };
  EXPECT_EQ(run("open.csv 2> err.txt"), 0);
  EXPECT_EQ(run("closed.csv <&- >&- 2>&-"), 0);
  EXPECT_EQ(text_of(folder / "closed.csv"), text_of(folder / "open.csv"));
  EXPECT_NE(run("- >&- 2> err.txt"), 0);
  EXPECT_NE(text_of(folder / "err.txt").find("\nstandard output: cannot be written: Bad file"),
            std::string::npos)
      << text_of(folder / "err.txt");
}

TEST(Usage, WhatTheDiskSaysBeginsWithItsPlace) {
  const fs::path folder = scratch_folder();
  fs::create_directory(folder / "answers");
  fs::create_symlink("round.json", folder / "answers" / "round.json");
  const RunResult run = run_program(folder, {"analyse", "answers", "--out", "report"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.err, "answers/round.json: Too many levels of symbolic links\n");
}

TEST(Usage, ALinkStaysOne) {
  const fs::path folder = folder_with_scene();
  fs::create_symlink("there.csv", folder / "link.csv");
  for (const char* both : {"link.csv", "./there.csv"}) {
    const RunResult same =
        run_program(folder, {"simulate", "01-small.json", "--out", "link.csv", "--segments", both});
    EXPECT_EQ(same.exit_code, 2);
    EXPECT_EQ(same.err, "--out and --segments must be different files\n");
  }
  EXPECT_EQ(run_program(folder, {"simulate", "01-small.json", "--out", "link.csv"}).exit_code, 0);
  EXPECT_TRUE(fs::is_symlink(folder / "link.csv"));
  EXPECT_TRUE(text_of(folder / "there.csv").starts_with("time_s,body,"));
}

TEST(Usage, ATimeBetweenTwoFramesIsSaidToBe) {
  const fs::path folder = folder_with_scene();  // 30 frames a second
  const auto err = [&](const char* until) {
    return run_program(folder, {"simulate", "01-small.json", "--out", "a.csv", "--until", until})
        .err;
  };
  EXPECT_EQ(err("0.5"), "");
  EXPECT_EQ(err("0.51"),
            "01-small.json: note: --until 0.51 s lies between two frames; the last row is of 0.5 "
            "s\n");
  EXPECT_NE(text_of(folder / "a.csv").find("\n0.5,"), std::string::npos);
}

TEST(Usage, AStoppingRuleGoesToStandardOutput) {
  const fs::path folder = scratch_folder();
  const RunResult run =
      run_program(folder, {"stopping", "--participants", "20,40", "--share", "0.7", "--json", "-"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(nlohmann::json::parse(run.out)["format"], "pinchlab-stopping 1");
  EXPECT_FALSE(fs::exists(folder / "-"));
}

TEST(Usage, AdviceIsAResultWhateverItSays) {
  const fs::path folder = scratch_folder();
  const RunResult run =
      run_program(folder, {"advise", PINCHLAB_SOURCE_DIR "/demos/06-windlass.json", "--error",
                           "1e-12", "--time", "0.05"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.err, "");
  EXPECT_NE(run.out.find("An error of 1e-12 m is below what this can vouch for"), std::string::npos)
      << run.out;
}

TEST(Usage, HelpPromisesWhatThereIs) {
  const fs::path folder = scratch_folder();
  EXPECT_NE(run_program(folder, {"bench", "--help"}).out.find("where there is something to"),
            std::string::npos);
  for (const char* command : {"serve", "freeze", "simulate"}) {
    EXPECT_NE(run_program(folder, {"study", command, "--help"})
                  .out.find("missing ones of demonstrations are rendered"),
              std::string::npos)
        << command;
  }
}

TEST(Usage, ATemplateIsSaidToBeOne) {
  const fs::path folder = scratch_folder();
  fs::copy(PINCHLAB_SOURCE_DIR "/demos/sweep/drop.json", folder / "drop.json");
  const RunResult run = run_program(folder, {"simulate", "drop.json", "--out", "-"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_TRUE(
      run.err.starts_with("drop.json: is a template with placeholders (${...}), whose values "
                          "`pinchlab sweep` and `pinchlab still --table` give\n"))
      << run.err;
}

// As `bench all --quick` does.
TEST(Usage, InstructionsAreCountedQuicklyToo) {
  const RunResult run = run_program(scratch_folder(), {"bench", "instructions", "--help"});
  EXPECT_NE(run.out.find("--quick"), std::string::npos) << run.out;
}

// Behind an option that takes as many words as there are.
TEST(Usage, ASceneMayStandBehindItsTable) {
  const fs::path folder = scratch_folder();
  fs::copy(PINCHLAB_SOURCE_DIR "/demos/sweep/drop.json", folder / "drop.json");
  std::ofstream(folder / "t.csv") << "squeeze,mass,height\n1,1,0.9\n";
  for (const std::vector<std::string>& table :
       {std::vector<std::string>{"t.csv"}, {"squeeze=0,1", "mass=1", "height=0.9"}}) {
    std::vector<std::string> arguments = {"still", "--table"};
    arguments.insert(arguments.end(), table.begin(), table.end());
    for (const char* more : {"drop.json", "--time", "0", "--size", "64x64", "--out", "x.png"}) {
      arguments.emplace_back(more);
    }
    const RunResult run = run_program(folder, arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }
}

TEST(Usage, TheDayOfPublicationIsNotGuessed) {
  const fs::path folder = scratch_folder();
  fs::copy(PINCHLAB_SOURCE_DIR "/demos/sweep/drop.json", folder / "drop.json");
  ::setenv("SOURCE_DATE_EPOCH", "abc", 1);
  const RunResult run = run_program(
      folder, {"sweep", "drop.json", "squeeze=0,1", "mass=1", "height=0.9", "--out", "set"});
  ::unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err,
            "SOURCE_DATE_EPOCH of the environment: abc is not a whole number of seconds since "
            "1970\n");
  EXPECT_FALSE(fs::exists(folder / "set"));
}

// Of results of all kinds, however long.
TEST(Usage, AFullDiskIsToldInOneWay) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  const fs::path folder = folder_with_scene();
  for (const char* command : {"manual", "completion bash", "study plan --participants 400 --seed 1",
                              "power --share 0.7", "simulate 01-small.json --out -"}) {
    fs::create_directories(folder / "demos");
    fs::copy(folder / "01-small.json", folder / "demos" / "01-small.json",
             fs::copy_options::overwrite_existing);
    const std::string line = fmt::format("cd '{}' && '{}' {} > /dev/full 2> err.txt",
                                         folder.string(), PINCHLAB_PROGRAM, command);
    EXPECT_NE(std::system(line.c_str()), 0) << command;
    EXPECT_EQ(text_of(folder / "err.txt"),
              "standard output: cannot be written: No space left on device\n")
        << command;
  }
  constexpr rlim_t most = 100;  // bytes a file
  const RunResult picture =
      run_program(folder, {"still", "01-small.json", "--time", "1", "--out", "x.png"}, most);
  EXPECT_EQ(picture.exit_code, 1);
  EXPECT_EQ(picture.err, "x.png: cannot be written: File too large\n");
}

}  // namespace
}  // namespace pinchlab
