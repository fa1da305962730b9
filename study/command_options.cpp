// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/command_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <stdexcept>

#include "base/number_option.h"
#include "base/output_file.h"
#include "study/plan.h"

namespace pinchlab::study {

namespace fs = std::filesystem;

CLI::Option* add_seed(CLI::App& command, std::uint64_t& seed, const std::string& help) {
  return command.add_option("--seed", seed, help)->type_name("S")->check(whole_in(0, largest_seed));
}

CLI::Option* add_config(CLI::App& command, fs::path& config) {
  return command
      .add_option("--config", config, "What to show and say; study/README.md has the keys [all]")
      ->type_name("study.json");
}

CLI::Option* add_no_webm(CLI::App& command, bool& no_webm) {
  return command.add_flag("--no-webm", no_webm,
                          "Do not render a second encoding for browsers without H.264");
}

CLI::Option* add_clips(CLI::App& command, fs::path& clips) {
  return command
      .add_option(
          "--clips", clips,
          "Folder of the clips; missing ones of demonstrations are rendered, not those of methods "
          "and series")
      ->type_name("DIR")
      ->required();
}

CLI::Option* add_answers(CLI::App& command, fs::path& answers) {
  return command.add_option("--answers", answers, "Folder for the answers, made if missing")
      ->type_name("DIR")
      ->required();
}

void refuse_to_overwrite(const fs::path& config, const fs::path& out, const char* what) {
  if (!is_same_file(out, config)) return;
  throw std::invalid_argument(
      fmt::format("{}: is the configuration; give the {} another name", out.string(), what));
}

}  // namespace pinchlab::study
