// SPDX-License-Identifier: GPL-3.0-or-later
// What the experiments write. Times are not judged here.
#include "analysis/experiments/stress.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "analysis/experiments/chart.h"
#include "analysis/experiments/counted_scenes.h"
#include "analysis/experiments/growth.h"
#include "analysis/experiments/pinch_detection.h"

namespace pinchlab::experiments {
namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::size_t lines_with(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

Options quick_options(const char* name) {
  Options options;
  options.quick = true;
  options.out = fs::path(::testing::TempDir()) / (std::string(name) + std::to_string(::getpid()));
  options.command = "pinchlab bench test";
  options.loads = {2, 1, 2};
  return options;
}

TEST(Stress, CasesAreWhatTheirNamesSay) {
  for (const StressCase& one : stress_cases()) EXPECT_FALSE(one.configuration.sleep) << one.name;
  EXPECT_EQ(stress_cases()[1].configuration.solver, Solver::iterative);
  EXPECT_EQ(stress_cases()[1].configuration.detection, Detection::all_pairs);
  EXPECT_EQ(stress_cases()[1].configuration.pinch_rows, PinchRows::three);
  EXPECT_EQ(stress_cases()[3].configuration.method, Method::cable);
  EXPECT_EQ(stress_cases()[3].configuration.solver, Solver::iterative);
}

TEST(Stress, WritesTablesFiguresAndPage) {
  const Options options = quick_options("stress");
  run_stress(options);
  const std::string table = read(options.out / "stress.csv");
  EXPECT_EQ(lines_with(table, "\n"), 4 + 1 + 2 * stress_cases().size());
  EXPECT_NE(table.find("\npinch,2,8,22,21,6,4,7,16,"), std::string::npos) << table;
  EXPECT_NE(table.find("\ncable,1,4,6,5,0,0,0,6,"), std::string::npos) << table;
  EXPECT_EQ(lines_with(read(options.out / "stress-stages.csv"), "\n"),
            4 + 1 + 2 * stress_cases().size() * stage_count);
  const std::string page = read(options.out / "stress.md");
  for (const char* figure : {"stress-step", "stress-stages", "stress-shared", "stress-choices"}) {
    EXPECT_NE(page.find(std::string("](") + figure + ".svg)"), std::string::npos) << figure;
    EXPECT_TRUE(fs::exists(options.out / (std::string(figure) + ".svg"))) << figure;
    EXPECT_TRUE(fs::exists(options.out / (std::string(figure) + ".pdf"))) << figure;
  }
  EXPECT_EQ(page.find("nan"), std::string::npos);
  EXPECT_EQ(page.find("inf "), std::string::npos);
  fs::remove_all(options.out);
  // What a virtual machine tells of its caches can be what all cores of its host have together:
  // three times that, gigabytes, was emptied before each cold call.
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss, 1L << 20) << "kB";
}

TEST(Growth, EachSceneIsThereAtItsSizes) {
  for (std::size_t i = 0; i < growing_scenes().size(); ++i) {
    const GrowingScene& growing = growing_scenes()[i];
    EXPECT_GE(growing.sizes.back(), 91 * growing.sizes.front()) << growing.what;
    EXPECT_TRUE(step_growing_scene(static_cast<int>(i), growing.sizes.front(), 2)) << growing.what;
  }
  EXPECT_FALSE(step_growing_scene(static_cast<int>(growing_scenes().size()), 1, 1));
  EXPECT_FALSE(step_growing_scene(0, 0, 1));
}

// From 100 units of 100 ns to 10000, or of 200 where caches are empty: a copy grows from 10 ns a
// unit to 40, and an exponent of 1.05 leaves 100 ns (100^0.05 - 1) = 25.9 ns.
TEST(Growth, TellsWhatACopyTakesOfWhatAnExponentLeaves) {
  const GrowthResult growth{"units", {100, 10000}, {1e-5, 2e-3}, {2e-5, 2e-3}, {1e-6, 4e-4}};
  EXPECT_NEAR(growth.exponent(), 1.0 + std::log10(2.0) / 2.0, 1e-12);
  EXPECT_NEAR(growth.cold_exponent(), 1.0, 1e-12);
  EXPECT_NEAR(growth.taken_by_copy(), 30e-9, 1e-15);
  EXPECT_NEAR(growth.left_by(1.05), 100e-9 * (std::pow(10.0, 0.1) - 1.0), 1e-15);
  EXPECT_NEAR(growth.left_by(growth.exponent()), 100e-9, 1e-15);
}

// Valgrind does not know the instructions of every library that encoders bring with them.
TEST(Instructions, AreCountedInAProgramOfTheSimulatorAlone) {
  const std::string program = PINCHLAB_STEPS;
  const auto status = [](const std::string& command) {
    return WEXITSTATUS(std::system((command + " > /dev/null 2>&1").c_str()));
  };
  EXPECT_EQ(status(program + " scene 0 2"), 0);
  EXPECT_EQ(status(program + " growing 0 3 2"), 0);
  for (const char* wrong : {"", " scene", " scene 0", " scene 99 1", " scene 0 -1", " scene 0 1x",
                            " growing 0 0 1", " growing 0 3", " --help"}) {
    EXPECT_EQ(status(program + wrong), 2) << wrong;
  }
  EXPECT_EQ(status("ldd " + program), 0);
  EXPECT_NE(status("ldd " + program + " | grep -E 'libav|libhwy|libcairo|libOSMesa'"), 0);
}

TEST(PinchDetection, WritesTablesFiguresAndPage) {
  const Options options = quick_options("pinch-detection");
  run_pinch_detection(options);
  const std::string table = read(options.out / "pinch-detection.csv");
  // Bodies, near pairs, contacts and pinches of both methods in all variants.
  for (const char* row :
       {"both,2,8,4,4,2,", "pinching,2,6,2,2,2,", "other,2,6,2,2,0,", "none,2,4,0,0,0,"}) {
    for (const char* method : {"\npinch,", "\nthesis,"}) {
      EXPECT_NE(table.find(std::string(method) + row), std::string::npos) << method << row << table;
    }
  }
  EXPECT_TRUE(fs::exists(options.out / "pinch-detection-per-load.pdf"));
  EXPECT_NE(read(options.out / "pinch-detection.md").find("| `thesis`, none |"), std::string::npos);
  fs::remove_all(options.out);
}

TEST(TimeText, HasThreeDigitsAndAUnit) {
  EXPECT_EQ(time_text(1.5), "1.50 s");
  EXPECT_EQ(time_text(0.0123), "12.3 ms");
  EXPECT_EQ(time_text(999.9e-6), "1.00 ms");
  EXPECT_EQ(time_text(456e-6), "456 µs");
  EXPECT_EQ(time_text(7.891e-9), "7.89 ns");
  EXPECT_EQ(time_text(0.0), "0.00 ns");
}

TEST(Chart, KeepsLabelsApartAndLeavesOutWhatIsNotPositive) {
  const auto curve = [](const char* label, double y) {
    return Curve{label, 1, false, false, {{1.0, {0.0, 0.0, 0.0}}, {10.0, {y, y, y}}}};
  };
  const std::string text =
      charts({{"title", "x", "y", {curve("one", 5.0), curve("two", 5.0)}}}, 400);
  EXPECT_EQ(lines_with(text, "\n1,0"), 0U);
  EXPECT_EQ(lines_with(text, "\n10,5,5,5\n"), 2U);
  const auto label_y = [&text](const char* label) {
    const std::size_t at = text.find(std::string("'") + label + "' at first ");
    return std::stod(text.substr(text.find("first ", text.find(',', at)) + 6));
  };
  EXPECT_GT(label_y("two") / label_y("one"), 1.01);
}

}  // namespace
}  // namespace pinchlab::experiments
