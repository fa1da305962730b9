// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Checks of words and numbers that come from outside, shared by the readers of every input format.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pinchlab {

/// "`a`, `b` or `c`", for messages that list what would be right.
std::string one_of(std::span<const std::string> words);

/// Whether UTF-8 text has a control character: below U+0020, or U+007F to U+009F, which terminals
/// obey, too.
bool has_control_character(std::string_view text);

/// Why `name` cannot name a participant, a demonstration or a group ("" if it can): names have 1 to
/// 128 bytes of valid UTF-8, no control characters and no blanks at the ends.
std::string why_not_a_name(std::string_view name);

/// Whether it is valid UTF-8 throughout.
bool is_utf8(std::string_view text);

/// A finite decimal number that fills `text` whole, or nothing. "nan", "inf" and hexadecimal are
/// refused.
std::optional<double> parse_number(std::string_view text);

/// A whole number in [low, high] that fills `text` whole, or nothing.
std::optional<long> parse_whole(std::string_view text, long low, long high);

/// Order of people: runs of digits compare as numbers, so "2-stack" comes before "10-drop".
bool natural_less(std::string_view a, std::string_view b);

}  // namespace pinchlab
