// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Checks of options for programs that read their command line with CLI11. Nothing of the library
// needs them.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "base/text_checks.h"

namespace pinchlab {

/// A finite number from low to high, ends included. CLI11's own Range lets NaN pass where it takes
/// numbers with a fraction.
inline CLI::Validator number_in(double low, double high) {
  return {[low, high](const std::string& text) {
            const std::optional<double> value = parse_number(text);
            if (value && low <= *value && *value <= high) return std::string();
            return fmt::format("{} is not a number from {:g} to {:g}", text, low, high);
          },
          fmt::format("{:g} to {:g}", low, high)};
}

/// A finite number whose range is looked at elsewhere.
inline CLI::Validator number() {
  return {[](const std::string& text) {
            return parse_number(text) ? std::string() : fmt::format("{} is not a number", text);
          },
          ""};
}

/// A whole number from low to high, ends included. CLI11's own Range says of 1.5 that it is not in
/// the range, and reads 010 as 8.
inline CLI::Validator whole_in(long low, long high) {
  return {[low, high](const std::string& text) {
            const std::optional<long> value = parse_whole(text, low, high);
            if (value && std::to_string(*value) == text) return std::string();
            return fmt::format("{} is not a whole number from {} to {}", text, low, high);
          },
          fmt::format("{} to {}", low, high)};
}

}  // namespace pinchlab
