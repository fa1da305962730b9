// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace pinchlab::analysis {

/// `text` as a gnuplot string that nothing is expanded in.
std::string gnuplot_quote(const std::string& text);

/// The same for the label of a tic, which gnuplot takes as a format.
std::string gnuplot_tic(const std::string& text);

/// A whole script that draws `body` twice, to NAME.svg and NAME.pdf in the current folder. Sizes in
/// pixels (96 to the inch).
std::string gnuplot_script(const std::string& name, int width_px, int height_px,
                           const std::string& body);

/// Runs gnuplot on a script in `folder`. Throws std::runtime_error with what gnuplot said if it
/// fails, or with the cure if it is not installed.
void run_gnuplot(const std::filesystem::path& folder, const std::string& script_name);

}  // namespace pinchlab::analysis
