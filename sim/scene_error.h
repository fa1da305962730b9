// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace pinchlab {

/// Something in a scene cannot be: `place` is a JSON pointer into the scene ("/cables/0/wraps/1"),
/// the message says what is wrong and how to cure it. Whoever knows the file adds its name.
class SceneError : public std::runtime_error {
 public:
  SceneError(std::string place_, const std::string& message_)
      : std::runtime_error(place_ + ": " + message_), place(std::move(place_)), message(message_) {}
  std::string place, message;
};

}  // namespace pinchlab
