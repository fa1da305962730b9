// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace pinchlab {

/// The text as it stands in HTML, in an element or between double quotes.
std::string html_escaped(std::string_view text);

}  // namespace pinchlab
