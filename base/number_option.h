// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A check of options for programs that read their command line with CLI11. Nothing of the library
// needs it.

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

}  // namespace pinchlab
