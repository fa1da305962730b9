// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Theme files: colours, line widths and font size of every picture. demos/themes/ has some.

#include <filesystem>
#include <string>

#include "render/picture/look.h"

namespace pinchlab {

struct ThemeFile {
  Theme theme;
  std::string name;    ///< of the file, without folder and ending; empty: the default
  std::string sha256;  ///< of its bytes; empty likewise
};

/// Reads and checks a theme; what it does not say is as in the default. Throws SceneFileError with
/// all mistakes.
ThemeFile read_theme_file(const std::filesystem::path& path);

}  // namespace pinchlab
