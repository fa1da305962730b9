// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace pinchlab {

/// The word of `known` that `word` was probably meant to be: one that only lacks its end (a unit,
/// say), or else the one with the fewest typing errors, at most a third of the word's length, or
/// two if that is more (one in a word of three letters). Empty if none.
std::string nearest_word(std::string_view word, std::span<const std::string> known);

/// " (did you mean `x`?)" with the nearest word, or "" if none is near.
std::string did_you_mean(std::string_view word, std::span<const std::string> known);

}  // namespace pinchlab
