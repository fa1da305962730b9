// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/instructions.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "analysis/experiments/counted_scenes.h"

namespace pinchlab::experiments {

namespace {

/// The program that makes the steps (count_main.cpp): where this one was built, or as installed.
std::filesystem::path program_of_steps() {
  const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const std::filesystem::path built = own / "pinchlab_steps";
  const std::filesystem::path installed = own / PINCHLAB_STEPS_INSTALLED;
  for (const std::filesystem::path& path : {built, installed}) {
    if (std::filesystem::exists(path)) return path;
  }
  throw std::runtime_error(fmt::format("there is neither {} nor {}: build or install all of it",
                                       built.string(), installed.string()));
}

/// Instructions inside of a function for so many calls of it.
double count(const char* function, const std::string& what, int calls,
             const std::filesystem::path& file) {
  const std::string command = fmt::format(
      "valgrind --tool=callgrind --callgrind-out-file='{}' --toggle-collect='pinchlab::{}(*' "
      "'{}' {} {}",
      file.string(), function, program_of_steps().string(), what, calls);
  if (std::system((command + " > /dev/null 2>&1").c_str()) != 0) {
    std::filesystem::remove(file);
    throw std::runtime_error("valgrind cannot run this program here; to see why: " + command);
  }
  std::ifstream in(file);
  constexpr const char* key = "totals: ";
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(key, 0) == 0) return std::stod(line.substr(std::string(key).size()));
  }
  throw std::runtime_error(file.string() + ": no totals in what callgrind wrote");
}

/// A call's, from the difference between few and many of them.
double count_each(const char* function, const std::string& what, int few, int many,
                  const std::filesystem::path& file) {
  return (count(function, what, many, file) - count(function, what, few, file)) / (many - few);
}

std::string page_of_growth(const std::vector<std::vector<std::string>>& rows) {
  return "\n## Growth\n\nInstructions a unit (cable, disc, pulley, load) at each size, and the "
         "power of the size that the whole grows with: 1 is linear, whatever caches hold.\n\n" +
         markdown_table({"what", "sizes", "instructions a unit", "exponent"}, rows);
}

/// The scenes of the stress test that grow; quickly, but for the largest.
std::string count_growth(const std::filesystem::path& file, bool quick, Csv& csv) {
  constexpr int few = 5, many = 15;  // steps of scenes that move
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < growing_scenes().size(); ++i) {
    GrowingScene growing = growing_scenes()[i];
    if (quick && growing.sizes.size() > 2) growing.sizes.pop_back();
    std::string sizes, units;
    std::vector<double> counts;
    for (const int size : growing.sizes) {
      const std::string what = fmt::format("growing {} {}", i, size);
      counts.push_back(growing.steps == 0 ? count_each("make_world", what, 1, 2, file)
                                          : count_each("step", what, few, many, file));
      csv.row({std::string(growing.what), std::int64_t{size}, counts.back()});
      sizes += (sizes.empty() ? "" : ", ") + fmt::format("{}", size);
      units += (units.empty() ? "" : ", ") + fmt::format("{:.0f}", counts.back() / size);
    }
    const double exponent = growth_exponent({growing.sizes.begin(), growing.sizes.end()}, counts);
    rows.push_back({growing.what, sizes, units, fmt::format("{:.3f}", exponent)});
  }
  return page_of_growth(rows);
}

}  // namespace

bool can_count_instructions() {
  return std::system("valgrind --version > /dev/null 2>&1") == 0;
}

void run_instructions(const Options& options) {
  if (!can_count_instructions()) {
    throw std::runtime_error("instructions are counted by valgrind: apt-get install valgrind");
  }
  Output output(options.out);
  const std::filesystem::path file = options.out / ".instructions.callgrind";
  const int few = options.quick ? 5 : 50, many = 3 * few;
  Csv csv({"scene", "configuration", "segments", "instructions_per_step"});
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < counted_scenes().size(); ++i) {
    const CountedScene& one = counted_scenes()[i];
    const double each = count_each("step", fmt::format("scene {}", i), few, many, file);
    csv.row(
        {std::string(one.name), std::string(one.configuration), std::int64_t{one.segments}, each});
    rows.push_back({one.name, fmt::format("`{}`", one.configuration), fmt::format("{:.0f}", each),
                    fmt::format("{:.0f}", each / one.segments)});
  }
  Csv growth({"what", "size", "instructions"});
  const std::string growth_text = count_growth(file, options.quick, growth);
  std::filesystem::remove(file);
  output.csv("instructions", csv, options.command);
  output.csv("instructions-growth", growth, options.command);
  output.page("instructions",
              fmt::format("# Instructions a step\n\nWhat the processor executes inside of a step "
                          "(`sim/step.h`), counted by valgrind's callgrind: the same on a busy "
                          "machine as on a quiet one. {} steps less {}, sleep off.\n\n",
                          many, few) +
                  markdown_table({"scene", "method", "instructions a step", "a segment"}, rows) +
                  growth_text,
              options.command);
  fmt::print("{}: what a step executes\n", (options.out / "instructions.md").string());
}

}  // namespace pinchlab::experiments
