// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The command line of the statistics.

#include <CLI/App.hpp>

namespace pinchlab::analysis {

/// Adds `analyse`, `power` and `stopping`.
void add_commands(CLI::App& app);

}  // namespace pinchlab::analysis
