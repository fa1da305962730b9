// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/rates.h"

#include <fmt/format.h>

namespace pinchlab {

std::string why_no_room(std::optional<double> guess, std::optional<double> lapse) {
  const double most_guess = guess.value_or(most_free_guess);
  const double most_lapse = lapse.value_or(most_free_lapse);
  if (most_guess + most_lapse < 1.0) return "";
  return fmt::format(
      "guesses of {}{:g} and lapses of {}{:g} leave no room for a function that rises between "
      "them; give rates with a sum below 1",
      guess ? "" : "up to ", most_guess, lapse ? "" : "up to ", most_lapse);
}

}  // namespace pinchlab
