// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <list>

#include "tests/base/temporary_folder.h"

namespace pinchlab {

/// An empty folder, another in every call, so that tests of several builds and users can run at
/// once. Removed at the end of the program.
inline std::filesystem::path scratch_folder() {
  static std::list<test::TemporaryFolder> folders;
  return folders.emplace_back().path();
}

}  // namespace pinchlab
