// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace CLI {
class App;
}

namespace pinchlab::analysis {

/// Adds `pinchlab analyse`.
void add_analyse(CLI::App& app);

}  // namespace pinchlab::analysis
