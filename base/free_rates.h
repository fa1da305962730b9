// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pinchlab {

/// The most that the rates of guesses and of lapses may be where they are estimated: who misses
/// more often than that is not watching.
inline constexpr double most_free_guess = 0.5, most_free_lapse = 0.1;

}  // namespace pinchlab
