// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace pinchlab {

/// The word of `known` that `word` was probably meant to be: one that only lacks its end (a unit,
/// say), or else the one with the fewest typing errors, at most a third of the word's length. Empty
/// if none.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& known);

}  // namespace pinchlab
