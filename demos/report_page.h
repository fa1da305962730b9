// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a folder's manifest says of its pairs (pair_report.h), as a table and as a page.

#include <filesystem>
#include <string>

#include "demos/manifest.h"

namespace pinchlab {

/// One line a pair, aligned, with a heading; empty if there are no reports.
std::string report_table(const Manifest& manifest);

/// Writes report.html into the folder; it needs nothing but the strips beside it. Throws
/// std::runtime_error if it cannot be written.
void write_report_page(const std::filesystem::path& folder, const Manifest& manifest);

}  // namespace pinchlab
