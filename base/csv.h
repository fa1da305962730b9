// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace pinchlab {

/// A cell of a CSV file (RFC 4180): in quotes where it holds a comma, a quote or an end of line.
std::string csv_cell(std::string_view text);

}  // namespace pinchlab
