// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace pinchlab {

/// Something that comes from outside cannot be. `what()` reads "place: message": the place is a
/// file, alone or with a line ("answers.csv:17") or with a JSON pointer ("p3.json:
/// /trials/0/choice"), the message says what is wrong and how to cure it.
struct InputError : std::runtime_error {
  InputError(const std::string& place_, const std::string& message_)
      : std::runtime_error(place_ + ": " + message_), place(place_), message(message_) {}
  std::string place, message;
};

}  // namespace pinchlab
