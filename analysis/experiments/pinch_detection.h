// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What finding pinches costs, phase by phase: thesis 3.2.2 and 5.1.3, Figure 5.4.

#include "analysis/experiments/experiment.h"

namespace pinchlab::experiments {

/// Measures, and writes pinch-detection.csv, figures and pinch-detection.md.
void run_pinch_detection(const Options& options);

}  // namespace pinchlab::experiments
