// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>

namespace pinchlab {

/// A text that is not JSON. `place` is "line 3, column 5", or a JSON pointer for a key given twice.
struct JsonError : std::runtime_error {
  JsonError(std::string place_, const std::string& message)
      : std::runtime_error(message), place(std::move(place_)) {}
  std::string place;
};

/// JSON as RFC 8259 has it, and stricter: a key given twice, a number that does not fit a double,
/// and nesting deeper than `max_depth` levels are errors too. Throws JsonError at the first.
nlohmann::json parse_strict_json(std::string_view text, std::size_t max_depth = 16);

/// The same from a file of at most `limit_bytes`. Throws InputError with the file and the place in
/// it.
nlohmann::json read_json_file(const std::filesystem::path& path, std::size_t limit_bytes);

/// `key` as one reference token of a JSON pointer (RFC 6901), printable and at most 64 bytes or so.
std::string pointer_token(const std::string& key);

}  // namespace pinchlab
