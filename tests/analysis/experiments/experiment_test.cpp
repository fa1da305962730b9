// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/experiment.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace pinchlab::experiments {
namespace {

namespace fs = std::filesystem;

/// A folder of its own, removed at the end.
struct Folder {
  fs::path path = fs::path(::testing::TempDir()) / ("experiments-" + std::to_string(::getpid()));
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream file(path / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST(Experiment, SpreadIsMedianAndDeciles) {
  std::vector<double> samples;
  for (int i = 100; i >= 0; --i) samples.push_back(i);
  const Spread found = spread(samples);
  EXPECT_DOUBLE_EQ(found.low, 10.0);
  EXPECT_DOUBLE_EQ(found.median, 50.0);
  EXPECT_DOUBLE_EQ(found.high, 90.0);
  EXPECT_DOUBLE_EQ(spread({1.0, 2.0}).median, 1.5);
  EXPECT_DOUBLE_EQ(spread({3.0}).high, 3.0);
  EXPECT_THROW(spread({}), std::logic_error);
}

TEST(Experiment, GrowthExponentOfAPower) {
  std::vector<double> sizes{20.0, 50.0, 100.0, 2000.0}, costs;
  costs.reserve(sizes.size());
  for (const double size : sizes) costs.push_back(3e-6 * std::pow(size, 1.7));
  EXPECT_NEAR(growth_exponent(sizes, costs), 1.7, 1e-12);
  EXPECT_THROW(growth_exponent({1.0}, {1.0}), std::logic_error);
}

TEST(Experiment, CsvReadsBackExactlyAndQuotes) {
  Csv csv({"name", "cost, s", "count"});
  csv.row({"plain", 0.1 + 0.2, std::int64_t{7}});
  csv.row({"a \"quoted\", one", 1e-300, std::int64_t{-1}});
  EXPECT_EQ(csv.text(),
            "name,\"cost, s\",count\nplain,0.30000000000000004,7\n"
            "\"a \"\"quoted\"\", one\",1e-300,-1\n");
  EXPECT_THROW(csv.row({"too short"}), std::logic_error);
}

TEST(Experiment, ProcessorTimeRunsWhileWorking) {
  const double start = cpu_seconds();
  double sum = 0.0;
  while (cpu_seconds() < start + 0.01) sum += std::sqrt(sum + 1.0);
  EXPECT_GT(sum, 0.0);
}

TEST(Experiment, OutputHasOriginFigureAndNoLeftovers) {
  const Folder folder;
  Output output(folder.path);
  Csv csv({"kind", "load", "cost_s"});
  for (const int load : {1, 2, 4}) {
    csv.row({"ours", std::int64_t{load}, 1e-6 * load});
    csv.row({"theirs", std::int64_t{load}, 2e-6 * load});
  }
  output.csv("costs", csv, "pinchlab bench costs");
  const std::string text = folder.read("costs.csv");
  for (const char* line :
       {"# machine: ", "# compiler: ", "# version: pinchlab ", "# command: pinchlab bench costs\n",
        "\nkind,load,cost_s\nours,1,1e-06"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line;
  }
  output.figure("costs", 400, 300,
                "set logscale xy\nplot 'costs.csv' using 'load':" +
                    column_where("cost_s", {{"kind", "ours"}}) + " with linespoints ls 1");
  output.page("costs", "# Costs\n", "pinchlab bench costs");
  EXPECT_NE(folder.read("costs.md").find("command: pinchlab bench costs"), std::string::npos);
  EXPECT_NE(folder.read("costs.svg").find("<svg"), std::string::npos);
  EXPECT_EQ(folder.read("costs.pdf").substr(0, 4), "%PDF");
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder.path)) {
    names.push_back(entry.path().filename().string());
  }
  EXPECT_EQ(names.size(), 5U);  // csv, gp, md, pdf, svg
  // A figure that fails leaves what there was, and nothing of its own but what gnuplot said.
  const std::string drawn = folder.read("costs.svg"), script = folder.read("costs.gp");
  EXPECT_THROW(output.figure("costs", 400, 300, "plot 'missing.csv'"), std::runtime_error);
  EXPECT_EQ(folder.read("costs.svg"), drawn);
  EXPECT_EQ(folder.read("costs.gp"), script);
  for (const auto& entry : fs::directory_iterator(folder.path)) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(std::ranges::count(names, name) == 1 || name == "gnuplot.log") << name;
  }
}

TEST(Experiment, OutputNamesAFolderThatCannotBeMade) {
  const Folder folder;
  fs::create_directories(folder.path);
  std::ofstream(folder.path / "file") << "x";
  try {
    Output output(folder.path / "file" / "in");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("--out"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace pinchlab::experiments
