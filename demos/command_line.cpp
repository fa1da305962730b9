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

std::filesystem::path demos_folder() {
  if (!std::filesystem::is_directory("demos")) {
    throw std::runtime_error(
        "demos: there is no such folder here; go to the project's folder, or name scene files");
  }
  return "demos";
}

}  // namespace pinchlab
