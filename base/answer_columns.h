// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace pinchlab {

/// Whether `study export --csv` writes a column of this name that tells about an answer's
/// circumstances, or what a questionnaire asked: analyses of a CSV file do without it.
bool is_column_beside_answers(std::string_view name);

}  // namespace pinchlab
