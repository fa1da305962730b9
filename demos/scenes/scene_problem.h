// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace pinchlab {

/// One thing wrong with a scene file: a JSON pointer (or line and column), and what it is and its
/// cure.
struct SceneProblem {
  std::string place, message;
};

}  // namespace pinchlab
