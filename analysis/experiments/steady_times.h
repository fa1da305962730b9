// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

namespace pinchlab::experiments {

/// Of each sampler (a call of it returns s, > 0) the median of so many samples that their scatter
/// leaves it about 2 % of doubt, or of as many as fit into `most_s` of all samples' sum. They take
/// turns, so that what else the machine does meets all of them alike.
std::vector<double> steady_times(const std::vector<std::function<double()>>& samplers,
                                 double most_s);

}  // namespace pinchlab::experiments
