// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <stdexcept>

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
      ->check(CLI::PositiveNumber);
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
