// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/instructions.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "demos/scenes/library.h"
#include "sim/step.h"

namespace pinchlab::experiments {

namespace {

struct Counted {
  const char* name;
  const char* configuration;
  int segments;
  Scene (*scene)();
};

const Counted counted[] = {
    {"weights over 81 light pulleys, where all moves", "pinch", 82, [] { return chain_scene(81); }},
    {"a weight that swings beside 81 pulleys", "pinch", 82, [] { return swinging_scene(81); }},
    {"81 segments over fixed pulleys, where nothing moves", "pinch", 81,
     [] { return stress_scene(20, free_spacing); }},
    {"stress scene with pinches, load 20", "pinch", 277,
     [] { return stress_scene(20, pinched_spacing); }},
    {"stress scene with pinches, load 20", "thesis", 277,
     [] { return stress_scene(20, pinched_spacing); }},
};

/// Instructions inside of pinchlab::step for so many steps.
double count(int scene, int steps, const std::filesystem::path& file) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string command = fmt::format(
      "valgrind --tool=callgrind --callgrind-out-file='{}' --toggle-collect='pinchlab::step(*' "
      "'{}' bench instructions --scene {} --steps {} > /dev/null 2>&1",
      file.string(), program, scene, steps);
  if (std::system(command.c_str()) != 0) {
    throw std::runtime_error("valgrind failed; to see why: " + command);
  }
  std::ifstream in(file);
  constexpr const char* key = "totals: ";
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(key, 0) == 0) return std::stod(line.substr(std::string(key).size()));
  }
  throw std::runtime_error(file.string() + ": no totals in what callgrind wrote");
}

}  // namespace

bool can_count_instructions() {
  return std::system("valgrind --version > /dev/null 2>&1") == 0;
}

bool step_scene(int scene, int steps) {
  if (scene < 0 || scene >= static_cast<int>(std::size(counted))) return false;
  const Counted& one = counted[scene];
  const Scene built = one.scene();
  Configuration configuration = *configuration_from_string(one.configuration);
  configuration.sleep = false;
  World world = make_world(built, configuration);
  Workspace work;
  for (int i = 0; i < steps; ++i) {
    if (step(built, world, work) != StepStatus::ok) throw std::runtime_error(world.failure);
  }
  return true;
}

void run_instructions(const Options& options) {
  if (!can_count_instructions()) {
    throw std::runtime_error("instructions are counted by valgrind: apt-get install valgrind");
  }
  Output output(options.out);
  const std::filesystem::path file = options.out / ".instructions.callgrind";
  constexpr int few = 50, many = 150;
  Csv csv({"scene", "configuration", "segments", "instructions_per_step"});
  std::vector<std::vector<std::string>> rows;
  for (int i = 0; i < static_cast<int>(std::size(counted)); ++i) {
    const Counted& one = counted[i];
    const double each = (count(i, many, file) - count(i, few, file)) / (many - few);
    csv.row(
        {std::string(one.name), std::string(one.configuration), std::int64_t{one.segments}, each});
    rows.push_back({one.name, fmt::format("`{}`", one.configuration), fmt::format("{:.0f}", each),
                    fmt::format("{:.0f}", each / one.segments)});
  }
  std::filesystem::remove(file);
  output.csv("instructions", csv, options.command);
  output.page("instructions",
              fmt::format("# Instructions a step\n\nWhat the processor executes inside of a step "
                          "(`sim/step.h`), counted by valgrind's callgrind: the same on a busy "
                          "machine as on a quiet one. {} steps less {}, sleep off.\n\n",
                          many, few) +
                  markdown_table({"scene", "method", "instructions a step", "a segment"}, rows),
              options.command);
  fmt::print("{}: what a step executes\n", (options.out / "instructions.md").string());
}

}  // namespace pinchlab::experiments
