// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace pinchlab::analysis {

/// Something in an input of the analysis cannot be. `what()` reads "place: message": the place is a
/// file with a line ("answers.csv:17") or with a JSON pointer ("p3.json: /trials/0/choice"), the
/// message says what is wrong and how to cure it.
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& place, const std::string& message)
      : std::runtime_error(place + ": " + message) {}
};

}  // namespace pinchlab::analysis
