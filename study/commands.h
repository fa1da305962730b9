// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The command line of the study.

#include <CLI/App.hpp>

#include "study/prepare.h"

namespace pinchlab::study {

/// Adds `study` with its commands.
void add_commands(CLI::App& app, const Stimuli& stimuli);

}  // namespace pinchlab::study
