// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the features that a scene does not use cost it, and what sleep saves.

#include "analysis/experiments/experiment.h"

namespace pinchlab::experiments {

/// Measures, and writes features.csv, sleep.csv and features.md.
void run_features(const Options& options);

}  // namespace pinchlab::experiments
