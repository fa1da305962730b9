// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where along its parameter a method holds, in words.

#include <string>
#include <vector>

#include "analysis/experiments/stability/watch.h"

namespace pinchlab::experiments::stability {

/// A parameter's value as the page shows it: at most 3 digits, "infinite".
std::string value_text(double x);

/// Of results of one series and method: "all", "none (squeezed)", "up to 100 (316: restless)",
/// "from 0.01 (0.003: squeezed)", "0.1 to 10 (restless)" or "7 of 10 (restless)". Results of equal
/// x count as one, which fails if any of them does; after the border comes how the first case
/// beyond it fails.
std::string border_text(std::vector<Result> results);

}  // namespace pinchlab::experiments::stability
