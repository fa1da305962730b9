// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "demos/still.h"
#include "demos/sweep_plan.h"

namespace pinchlab {

/// A graded series on one sheet: a column of pictures for each row of the sweep's table, one below
/// the other at the times of `options`, under them what tells the columns apart. The method is the
/// row's own, or `method`. Throws as write_still and stimuli_of do.
void write_series(const Sweep& sweep, const std::string& method, const StillOptions& options);

}  // namespace pinchlab
