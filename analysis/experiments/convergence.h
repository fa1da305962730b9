// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How motions through events converge as steps get shorter, with events at their time and at the
// steps.

#include "analysis/experiments/experiment.h"

namespace pinchlab::experiments {

/// Writes convergence.csv, convergence.md and a figure.
void run_convergence(const Options& options);

}  // namespace pinchlab::experiments
