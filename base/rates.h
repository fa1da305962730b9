// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Rates of guesses and of lapses of psychometric functions, and what they can be.

#include <optional>
#include <string>

namespace pinchlab {

/// The most that they may be where they are given.
inline constexpr double most_fixed_guess = 0.9, most_fixed_lapse = 0.5;

/// The most that they may be where they are estimated: who misses more often than that is not
/// watching.
inline constexpr double most_free_guess = 0.5, most_free_lapse = 0.1;

/// Why the two leave a function no room to rise between them, wherever free ones (none) come to
/// lie; empty if they leave some.
std::string why_no_room(std::optional<double> guess, std::optional<double> lapse);

}  // namespace pinchlab
