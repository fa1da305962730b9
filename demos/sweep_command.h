// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/CLI.hpp>

namespace pinchlab {

/// `pinchlab sweep` and `pinchlab crate`.
void add_sweep_commands(CLI::App& app);

}  // namespace pinchlab
