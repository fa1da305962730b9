// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "analysis/experiments/experiment.h"

namespace pinchlab::experiments {

/// Corners, layers and cables with mass against known solutions: writes shapes.csv and shapes.md.
void run_shapes(const Options& options);

}  // namespace pinchlab::experiments
