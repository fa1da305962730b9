// SPDX-License-Identifier: GPL-3.0-or-later
// The program's other commands as a user runs them: exit codes, where messages go, what files hold.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/time.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include "demos/version.h"
#include "demos/worker_pool.h"
#include "tests/demos/scene_folders.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;

TEST(Program, HelpTeachesOnStandardOutput) {
  const fs::path folder = scratch_folder();
  const std::map<std::string, std::string> commands = {{"render", "pinchlab render --side-by-side"},
                                                       {"still", "--time 2.5"},
                                                       {"simulate", "time_s,body,x_m"}};
  for (const auto& [command, expected] : commands) {
    const RunResult run = run_program(folder, {command, "--help"});
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_EQ(run.err, "");
    EXPECT_NE(run.out.find("Examples:"), std::string::npos) << run.out;
    EXPECT_NE(run.out.find(expected), std::string::npos) << run.out;
    EXPECT_NE(run_program(folder, {"--help"}).out.find("  " + command + " "), std::string::npos);
  }
  EXPECT_EQ(run_program(folder, {"--version"}).out, fmt::format("pinchlab {}\n", version));
}

TEST(Program, BadUsageIsTwoAndSaysSoOnStandardError) {
  const fs::path folder = folder_with_scene();
  const std::vector<std::vector<std::string>> bad = {
      {},
      {"rendr"},
      {"render", "--sise", "64x64"},
      {"render", "--size", "64"},
      {"render", "--size", "64x64x64"},
      {"render", "--size", "8x8"},
      {"render", "--size", "65x65", "01-small.json"},
      {"render", "--size", "999999x64"},
      {"render", "--method", "plain"},
      {"render", "--codec", "mpeg2"},
      {"render", "--jobs", "0"},
      {"render", "--jobs", "two"},
      {"render", "--fps", "0"},
      {"render", "--fps", "24.5"},
      {"render", "01-small.json", "./01-small.json"},
      {"still"},
      {"still", "01-small.json", "--time", "1"},
      {"still", "01-small.json", "--out", "x.png"},
      {"still", "01-small.json", "--time", "-0.1", "--out", "x.png"},
      {"still", "01-small.json", "--time", "2.1", "--out", "x.png"},
      {"still", "01-small.json", "--time", "nan", "--out", "x.png"},
      {"still", "01-small.json", "--time", "1", "--both", "--method", "cable", "--out", "x.png"},
      {"simulate", "01-small.json"},
      {"simulate", "--out", "-"},
      {"simulate", "01-small.json", "--out", "a.csv", "--method", "plain"},
      {"simulate", "01-small.json", "--out", "a.csv", "--segments", "a.csv"},
      {"simulate", "01-small.json", "--out", "a.csv", "--segments", "./a.csv"},
      {"simulate", "01-small.json", "--out", "-", "--segments", "-"},
      {"simulate", "01-small.json", "--out", "../" + folder.filename().string() + "/01-small.json"},
      {"simulate", "01-small.json", "--out", "a.csv", "--segments", "01-small.json"},
      {"study", "plan", "--participants", "1", "--seed", "1", "--csv", "p", "--json", "./p"},
      {"study", "plan", "--participants", "1", "--seed", "1", "--csv", "-", "--json", "-"},
      {"simulate", "01-small.json", "--out", "a.csv", "--until", "-1"},
      {"simulate", "01-small.json", "--out", "a.csv", "--until", "nan"},
      {"simulate", "01-small.json", "--out", "a.csv", "--until", "inf"},
      {"simulate", "01-small.json", "--out", "a.csv", "--until", "1e9"},
      {"simulate", "01-small.json", "--out", "a.csv", "--steps-per-frame", "0"},
      {"simulate", "01-small.json", "--out", "a.csv", "--steps-per-frame", "99999999999"},
      {"simulate", "01-small.json", "--out", "a.csv", "--error", "nan"},
      {"simulate", "01-small.json", "--out", "a.csv", "--time-limit", "nan"},
      {"simulate", "01-small.json", "--out", "a.csv", "--time-limit", "0"},
      {"simulate", "01-small.json", "01-small.json", "--out", "a.csv"},
      {"analyse", "answers.csv", "--out", "report", "--alpha", "nan"},
      {"analyse", "answers.csv", "--out", "report", "--guess", "nan"},
      {"analyse", "answers.csv", "--out", "report", "--lapse", "0.6"},
      {"analyse", "answers.csv", "--out", "report", "--threshold-at", "nan"},
      {"analyse", "answers.csv", "--out", "report", "--seed", "-1"},
      {"bench"},
  };
  for (const auto& arguments : bad) {
    const RunResult run = run_program(folder, arguments);
    EXPECT_EQ(run.exit_code, 2) << fmt::format("{}", fmt::join(arguments, " ")) << "\n" << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_NE(run.err, "");
  }
  EXPECT_FALSE(fs::exists(folder / "x.png"));
  EXPECT_FALSE(fs::exists(folder / "a.csv"));
  EXPECT_FALSE(fs::exists(folder / "clips"));
  EXPECT_FALSE(fs::exists(folder / "report"));
}

TEST(Program, UnknownWordsAreNamedWithTheirCure) {
  const fs::path folder = folder_with_scene();
  const std::vector<std::pair<std::vector<std::string>, std::string>> unknown = {
      {{"rendr"},
       "pinchlab: no command is called rendr (did you mean `render`?); pinchlab --help lists what "
       "there is\n"},
      {{"study", "exprot"},
       "pinchlab study: no command is called exprot (did you mean `export`?); pinchlab study "
       "--help "
       "lists what there is\n"},
      {{"simulate", "01-small.json", "--mehtod", "cable", "--out", "a.csv"},
       "pinchlab simulate: no option is called --mehtod (did you mean `--method`?); pinchlab "
       "simulate --help lists what there is\n"},
      {{"study", "export", "--answers", "a", "--cvs", "-"},
       "pinchlab study export: no option is called --cvs (did you mean `--csv`?); pinchlab study "
       "export --help lists what there is\n"},
      {{"simulate", "--", "01-small.json", "--out", "a.csv"},
       "pinchlab simulate: --out stands where nothing reads it; its place is after the command and "
       "before any --\n"},
  };
  for (const auto& [arguments, message] : unknown) {
    const RunResult run = run_program(folder, arguments);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(run.err, message);
  }
  EXPECT_FALSE(fs::exists(folder / "a.csv"));
}

TEST(Program, SimulatesAsTheThesisDoes) {
  const fs::path folder = folder_with_scene();
  const auto motion = [&folder](const std::string& method) {
    const RunResult run =
        run_program(folder, {"simulate", "01-small.json", "--method", method, "--out", "-"});
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.out;
  };
  const std::string thesis = motion("thesis"), pinch = motion("pinch");
  EXPECT_EQ(std::count(thesis.begin(), thesis.end(), '\n'),
            std::count(pinch.begin(), pinch.end(), '\n'));
  EXPECT_NE(thesis, pinch);
}

TEST(Program, FailureIsOneAndLeavesNoFile) {
  const fs::path folder = folder_with_scene();
  std::ofstream(folder / "bad.json") << "{";
  const std::vector<std::pair<std::vector<std::string>, std::string>> failures = {
      {{"render"},
       "demos: there is no such folder here; go to the project's folder, or name scene files\n"},
      {{"still", "none.json", "--time", "1", "--out", "x.png"},
       "none.json: No such file or directory; name a scene file, as those of demos/\n"},
      {{"still", "01-smal.json", "--time", "1", "--out", "x.png"},
       "01-smal.json: No such file or directory (did you mean `01-small.json`?)\n"},
      {{"simulate", "./01-small", "--out", "x.csv"},
       "./01-small: No such file or directory (did you mean `./01-small.json`?)\n"},
      {{"simulate", "bad.json", "--out", "x.csv"},
       "bad.json: line 1, column 1: not JSON: unexpected end of input; expected string literal\n"},
      {{"simulate", "01-small.json", "--out", "none/x.csv"},
       "none/x.csv: the folder none does not exist; create it first\n"},
      {{"simulate", "01-small.json", "--out", ""},
       "the name of a file to write is empty; give it one\n"},
      {{"simulate", "", "--out", "x.csv"}, "the scene file's name: is empty\n"},
      {{"render", "01-small.json", "--out", "bad.json"},
       "bad.json: is not a folder; name another one\n"},
  };
  for (const auto& [arguments, message] : failures) {
    const RunResult run = run_program(folder, arguments);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(run.err, message);
  }
  const RunResult full = run_program(folder, {"simulate", "01-small.json", "--out", "x.csv"}, 1000);
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_EQ(full.err, "x.csv: cannot be written: File too large\n");
  EXPECT_FALSE(fs::exists(folder / "x.csv"));
  EXPECT_FALSE(fs::exists(folder / "x.csv.partial"));
}

// Whoever gives an option expects something of it.
TEST(Program, AnalyseRefusesOptionsThatItDoesNotRead) {
  const fs::path folder = scratch_folder();
  std::ofstream(folder / "counts.csv") << "demonstration,pinch,cable\na,7,3\n";
  std::ofstream(folder / "answers.csv")
      << "participant,demonstration,choice\np,a,pinch\nq,a,cable\n";
  std::ofstream(folder / "several.csv")
      << "left,right,left_wins,right_wins\na,b,7,3\nb,c,6,4\na,c,8,2\n";
  std::ofstream(folder / "levels.csv") << "level,correct,trials\n0.1,5,10\n0.2,8,10\n0.3,10,10\n";
  using Words = std::vector<std::string>;
  const auto analyse = [&](const std::string& input, const Words& option) {
    Words command = {"analyse", input, "--out", "report", "--no-figures"};
    command.insert(command.end(), option.begin(), option.end());
    return run_program(folder, command);
  };
  const Words of_levels[] = {
      {"--function", "weibull"}, {"--guess", "0.3"}, {"--lapse", "0"}, {"--threshold-at", "0.5"}};
  const Words scale = {"--scale", "thurstone"}, groups = {"--groups", "nofile"},
              repetitions = {"--repetitions", "7"}, missing = {"--allow-missing"},
              pinch = {"--pinch-value", "zz"};
  const auto refuses = [&](const std::string& input, const Words& option) {
    const RunResult run = analyse(input, option);
    EXPECT_EQ(run.exit_code, 2) << input << option[0];
    EXPECT_TRUE(run.err.starts_with(option[0] + ": is about ")) << input << run.err;
    EXPECT_FALSE(fs::exists(folder / "report")) << input << option[0];
  };
  for (const char* input : {"counts.csv", "answers.csv", "several.csv"}) {
    for (const Words& option : of_levels) refuses(input, option);
  }
  for (const char* input : {"counts.csv", "answers.csv", "levels.csv"}) refuses(input, scale);
  for (const char* input : {"several.csv", "levels.csv"}) refuses(input, groups);
  for (const char* input : {"several.csv", "levels.csv", "counts.csv"}) {
    refuses(input, repetitions);
    refuses(input, missing);
  }
  refuses("several.csv", pinch);
  EXPECT_EQ(analyse("counts.csv", pinch).exit_code, 0);
  EXPECT_EQ(analyse("several.csv", scale).exit_code, 0);
  EXPECT_EQ(analyse("answers.csv", missing).exit_code, 0);
  EXPECT_EQ(analyse("answers.csv", {"--repetitions", "1"}).exit_code, 0);
  EXPECT_EQ(analyse("levels.csv", {"--bootstrap", "99"}).exit_code, 0);
}

// Results that went to standard output are lost: that is a failure, whatever the command.
TEST(Program, FullStandardOutputIsAFailure) {
  const fs::path folder = folder_with_scene();
  fs::create_directory(folder / "demos");
  fs::copy_file(folder / "01-small.json", folder / "demos/01-small.json");
  std::ofstream(folder / "counts.csv") << "demonstration,pinch,cable\na,7,3\n";
  fs::create_symlink("/dev/full", folder / "stdout.txt");
  const std::vector<std::vector<std::string>> commands = {
      {"--help"},
      {"--version"},
      {"render", "--help"},
      {"simulate", "01-small.json", "--out", "-"},
      {"baseline", "01-small.json"},
      {"render", "01-small.json", "--size", "64x64", "--only-report"},
      {"study", "plan", "--participants", "1", "--seed", "1"},
      {"analyse", "counts.csv", "--out", "report", "--no-figures"},
      {"power", "--share", "0.75"},
  };
  for (const std::vector<std::string>& command : commands) {
    const pid_t process = start_program(folder, command);
    int status = 0;
    EXPECT_EQ(::waitpid(process, &status, 0), process);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 1) << command[0];
    const std::string told = text_of(folder / "stderr.txt");
    EXPECT_NE(told.find("standard output: cannot be written"), std::string::npos)
        << command[0] << ": " << told;
  }
}

TEST(Program, TheTimeLimitBoundsTheRehearsalOfAFittedView) {
  const fs::path folder = scratch_folder();
  nlohmann::json scene = small_scene();
  scene["view"] = "fit";
  std::ofstream(folder / "01-small.json") << scene;
  // The first frame needs no step of its own.
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"still", "01-small.json", "--time", "0", "--out", "x.png"},
        {"render", "01-small.json", "--out", "clips"}}) {
    std::vector<std::string> limited = command;
    limited.insert(limited.end(), {"--time-limit", "0.000001"});
    const RunResult run = run_program(folder, limited);
    EXPECT_EQ(run.exit_code, 1) << command[0];
    EXPECT_NE(run.err.find("01-small.json: while placing labels and fitting the view: method "
                           "pinch: given up at t = 0.00833333 s, step 1, after the 1e-06 s"),
              std::string::npos)
        << run.err;
    EXPECT_EQ(run_program(folder, command).exit_code, 0) << command[0];
  }
}

// What may run for minutes says how long it still will, and can be given a limit.
TEST(Program, LongWorkTellsHowFarItIsAndEndsAtItsLimit) {
  const fs::path folder = scratch_folder();
  nlohmann::json scene = small_scene();
  scene["duration_s"] = 600;
  scene["steps_per_frame"] = 1000;
  std::ofstream(folder / "01-small.json") << scene;
  const std::pair<std::vector<std::string>, std::string> commands[] = {
      {{"still", "01-small.json", "--time", "0", "--out", "x.png"},
       "placing labels and fitting the view of 01-small: "},
      {{"baseline", "01-small.json"}, "simulating 01-small, pinch: "},
      {{"advise", "01-small.json", "--error", "1e-9"}, "solving 01-small at 512 steps a frame: "}};
  for (const auto& [command, expected] : commands) {
    std::vector<std::string> limited = command;
    limited.insert(limited.end(), {"--time-limit", "2"});
    const std::string told = told_on_terminal(folder, limited);
    EXPECT_NE(told.find(expected), std::string::npos) << told;
    EXPECT_NE(told.find(" left"), std::string::npos) << told;
    EXPECT_NE(told.find("after the 2 s of --time-limit"), std::string::npos) << told;
    limited.back() = "0.000001";
    const RunResult run = run_program(folder, limited);
    EXPECT_EQ(run.exit_code, 1) << command[0];
    EXPECT_TRUE(run.err.starts_with("01-small.json: ")) << run.err;
    EXPECT_EQ(run.out, "");
  }
}

// Plain joints meet a body of some hundred sizes a step in the step after.
TEST(Program, TellsWhatIsNotKept) {
  const fs::path folder = scratch_folder();
  nlohmann::json scene = small_scene();
  scene["bodies"].push_back({{"name", "bullet"},
                             {"kind", "free"},
                             {"radius_m", 0.2},
                             {"mass_kg", 1},
                             {"position_m", {-200, 3}},
                             {"velocity_m_s", {10000, 0}}});
  scene["steps_per_frame"] = 1;
  std::ofstream(folder / "01-fast.json") << scene;
  const std::string said = "method cable: cable 'rope' was stretched by ";
  const RunResult simulated =
      run_program(folder, {"simulate", "01-fast.json", "--method", "cable", "--out", "x.csv"});
  EXPECT_EQ(simulated.exit_code, 0);
  EXPECT_NE(simulated.err.find("01-fast.json: note: " + said), std::string::npos) << simulated.err;
  const RunResult still = run_program(folder, {"still", "01-fast.json", "--method", "cable",
                                               "--time", "1", "--out", "x.png", "--size", "64x64"});
  EXPECT_EQ(still.exit_code, 0);
  EXPECT_NE(still.err.find("01-fast.json: note: " + said), std::string::npos) << still.err;
  for (const char* made : {"1 made, 0 up to date", "0 made, 1 up to date"}) {
    const RunResult rendered =
        run_program(folder, {"render", "01-fast.json", "--method", "cable", "--size", "64x64"});
    EXPECT_EQ(rendered.exit_code, 0);
    EXPECT_NE(rendered.err.find("clips/01-fast.cable.mp4: note: " + said), std::string::npos)
        << rendered.err;
    EXPECT_NE(rendered.err.find(made), std::string::npos) << rendered.err;
  }
}

// Width and height from a PNG's header.
std::pair<int, int> png_size(const fs::path& path) {
  const std::string bytes = text_of(path);
  EXPECT_TRUE(bytes.starts_with("\x89PNG")) << path;
  const auto number = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      value = 256 * value + static_cast<unsigned char>(bytes.at(at + i));
    }
    return value;
  };
  return {number(16), number(20)};
}

TEST(Still, OneTimeIsAFrameSeveralAreASheet) {
  const fs::path folder = folder_with_scene();
  const auto still = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"still", "01-small.json", "--size",
                                          "64x48", "--out",         "x.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const RunResult run = run_program(folder, arguments);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return png_size(folder / "x.png");
  };
  EXPECT_EQ(still({"--time", "0.5"}), (std::pair{64, 48}));
  const auto row = still({"--time", "1.5,0.5", "--both"});
  EXPECT_GE(row.first, 2 * 64);
  EXPECT_LT(row.first, 3 * 64);
  EXPECT_GE(row.second, 2 * 48);
  const std::string list = text_of(folder / "x.png");
  still({"--time", "1.5", "--time", "0.5", "--both"});
  EXPECT_EQ(text_of(folder / "x.png"), list);
  still({"--time", "0.5,1.5", "--both"});
  EXPECT_NE(text_of(folder / "x.png"), list);
}

TEST(Bench, OddSizesAreRefusedAtTheDoor) {
  const fs::path folder = folder_with_scene();
  const RunResult run =
      run_program(folder, {"bench", "render", "01-small.json", "--size", "63x64"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err, "h264 needs an even size, not 63x64; change --size\n");
}

TEST(Bench, PrintsWhatAFrameCosts) {
  const fs::path folder = folder_with_scene();
  const RunResult run = run_program(
      folder, {"bench", "render", "01-small.json", "--size", "64x64", "--frames", "10"});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("simulate"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("encode"), std::string::npos) << run.out;
}

TEST(WorkerPool, ResultsErrorsAndDeathsComeBack) {
  const std::vector<Work> work = {
      [](const auto& tick) {
        tick();
        tick();
        return std::string("+-.\nresult");
      },
      [](const auto&) -> std::string { throw std::runtime_error("no luck"); },
      [](const auto&) -> std::string {
        ::raise(SIGKILL);
        return "";
      },
      [](const auto&) { return std::string(); },
  };
  std::map<std::size_t, std::string> results, errors;
  int ticks = 0;
  const int signal = run_in_processes(
      work, 2,
      {.tick = [&](std::size_t) { ++ticks; },
       .done = [&](std::size_t i, const std::string& text) { results[i] = text; },
       .failed = [&](std::size_t i, const std::string& text) { errors[i] = text; }});
  EXPECT_EQ(signal, 0);
  EXPECT_EQ(ticks, 2);
  EXPECT_EQ(results, (std::map<std::size_t, std::string>{{0, "+-.\nresult"}, {3, ""}}));
  EXPECT_EQ(errors, (std::map<std::size_t, std::string>{
                        {1, "no luck"},
                        {2, "its process was ended by signal 9 (Killed); was memory short?"}}));
}

// The process ends while it writes its result, which is more than a pipe holds.
TEST(WorkerPool, HalfAResultIsNone) {
  const std::vector<Work> work = {[](const auto&) {
    const itimerval soon = {{}, {0, 200'000}};
    ::setitimer(ITIMER_REAL, &soon, nullptr);
    return std::string(std::size_t{1} << 18U, 'x');
  }};
  std::string result, error;
  run_in_processes(work, 1,
                   {.tick = [](std::size_t) {},
                    .done = [&](std::size_t, const std::string& text) { result = text; },
                    .failed = [&](std::size_t, const std::string& text) { error = text; },
                    .idle = [] { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }});
  EXPECT_EQ(result.size(), 0U);
  EXPECT_EQ(error, "its process was ended by signal 14 (Alarm clock)");
}

}  // namespace
}  // namespace pinchlab
