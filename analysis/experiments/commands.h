// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CLI/App.hpp>

namespace pinchlab::experiments {

/// Adds `bench` with its experiments.
void add_bench_commands(CLI::App& app);

}  // namespace pinchlab::experiments
