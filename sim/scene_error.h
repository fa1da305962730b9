// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace pinchlab {

/// Something in a scene cannot be: `place` is a JSON pointer into the scene ("/cables/0/wraps/1"),
/// the message says what is wrong and how to cure it. Whoever knows the file adds its name.
class SceneError : public std::runtime_error {
 public:
  SceneError(std::string place_, const std::string& message)
      : std::runtime_error(place_ + ": " + message), place(std::move(place_)) {}
  std::string place;
};

}  // namespace pinchlab
