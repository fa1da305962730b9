// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <regex>
#include <stdexcept>

#include "base/did_you_mean.h"
#include "render/canvas.h"

namespace pinchlab {

namespace {

// "960x540" to a size. Returns what is wrong with it, or nothing.
std::string read_size(const std::string& text, Size& size) {
  char rest = 0;
  const int found = std::sscanf(text.c_str(), "%5dx%5d%c", &size.width, &size.height, &rest);
  if (found == 2 && std::min(size.width, size.height) >= smallest_frame &&
      std::max(size.width, size.height) <= largest_frame) {
    return "";
  }
  return fmt::format("{} is not WIDTHxHEIGHT in pixels, each {} to {}, such as 960x960", text,
                     smallest_frame, largest_frame);
}

std::string full_name(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return (parent == nullptr ? "" : full_name(*parent) + " ") + command.get_name();
}

// Groups of options are commands without a name.
void add_option_names(const CLI::App& command, std::vector<std::string>& names) {
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (const CLI::App* group : command.get_subcommands({})) {
    if (group->get_name().empty()) add_option_names(*group, names);
  }
}

}  // namespace

void add_size(CLI::App& command, Size& size, const std::string& help) {
  command
      .add_option_function<std::string>(
          "--size", [&size](const std::string& text) { read_size(text, size); }, help)
      ->type_name("WxH")
      ->check([](const std::string& text) {
        Size ignored;
        return read_size(text, ignored);
      });
}

void add_time_limit(CLI::App& command, std::optional<double>& seconds, const std::string& what) {
  command.add_option("--time-limit", seconds, what + " after so many seconds, and fail [none]")
      ->type_name("S")
      ->check(number_in(1e-6, 1e9));
}

void add_simulation_limit(CLI::App& command, std::optional<double>& seconds,
                          const std::string& whose) {
  add_time_limit(command, seconds,
                 fmt::format("Give up on {} simulation (an error is measured by several)", whose));
}

std::string unknown_words(const CLI::App& app) {
  const CLI::App* command = &app;  // the innermost that was named
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  for (const std::string& word : app.remaining(true)) {
    const bool is_option = word.starts_with("-") && word != "--";
    std::vector<std::string> known;
    if (is_option) {
      add_option_names(*command, known);
    } else {
      for (const CLI::App* one : command->get_subcommands({})) {
        if (!one->get_name().empty()) known.push_back(one->get_name());
      }
    }
    if (!is_option && known.empty()) continue;  // one argument too many
    if (std::ranges::find(known, word) != known.end()) {
      return fmt::format(
          "{}: {} stands where nothing reads it; its place is after the command and "
          "before any --",
          full_name(*command), word);
    }
    return fmt::format("{}: no {} is called {}{}; {} --help lists what there is",
                       full_name(*command), is_option ? "option" : "command", word,
                       did_you_mean(word, known), full_name(*command));
  }
  return "";
}

std::string given_too_often(const CLI::ParseError& error) {
  static const std::regex message("(.*): At Most 1 required but received ([0-9]+)");
  std::smatch found;
  const std::string text = error.what();
  if (!std::regex_match(text, found, message)) return "";
  return fmt::format("{}: is given {} times; give it once", found.str(1), found.str(2));
}

std::optional<std::filesystem::path> find_demos_folder() {
  if (std::filesystem::is_directory("demos")) return "demos";
  // An installed program may lie anywhere, its data always in the same place beside it.
  std::error_code unknown;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  const std::filesystem::path installed =
      (program.parent_path() / PINCHLAB_DATA_FROM_PROGRAM / "demos").lexically_normal();
  if (!unknown && std::filesystem::is_directory(installed)) return installed;
  return std::nullopt;
}

std::filesystem::path demos_folder() {
  if (const auto folder = find_demos_folder()) return *folder;
  throw std::runtime_error(
      "demos: there is no such folder here; go to the project's folder, or name scene files");
}

}  // namespace pinchlab
