// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/commands.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

namespace pinchlab::experiments {
namespace {

void parse(const std::string& line) {
  CLI::App app;
  add_bench_commands(app);
  app.parse(line);
}

TEST(BenchCommand, RefusesWhatItCannotMeasure) {
  for (const char* line :
       {"bench", "bench nothing", "bench stress --loads 0", "bench stress --loads 1,two",
        "bench stress --loads -5", "bench features --loads 1", "bench pinch-detection extra",
        "bench all --loads 1", "bench render --frames 0", "bench render --method best",
        "bench render --size 3"}) {
    EXPECT_THROW(parse(line), CLI::ParseError) << line;
  }
}

TEST(BenchCommand, HelpNamesEveryExperiment) {
  CLI::App app;
  add_bench_commands(app);
  const std::string help = app.get_subcommand("bench")->help();
  for (const char* name : {"stress", "pinch-detection", "features", "shapes", "render", "all"}) {
    EXPECT_NE(help.find(name), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace pinchlab::experiments
