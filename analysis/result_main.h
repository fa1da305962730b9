// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The main() of programs that write to analysis/results.

#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>

namespace pinchlab::analysis {

struct ResultSettings {
  std::filesystem::path out;
  std::uint64_t seed = 1;
};

/// Reads --out, --seed and what `add_options` adds, and calls `run`. Returns main's exit code.
inline int result_main(int argc, char** argv, const char* name, const char* description,
                       ResultSettings& settings, const std::function<void(CLI::App&)>& add_options,
                       const std::function<void()>& run) {
  try {
    CLI::App app{description};
    app.add_option("--out", settings.out, "Folder for the page and its data")->required();
    app.add_option("--seed", settings.seed, "Seed of all random numbers")->capture_default_str();
    add_options(app);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : 2;
    }
    run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
  return 0;
}

}  // namespace pinchlab::analysis
