// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace pinchlab {

/// "1 trial", "2 trials": a number with its noun; `ending` makes the plural.
template <class Number>
std::string counted(Number count, std::string_view noun, std::string_view ending = "s") {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : ending);
}

}  // namespace pinchlab
