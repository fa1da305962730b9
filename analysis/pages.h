// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A document printed.

#include <string>
#include <vector>

#include "analysis/document.h"

namespace pinchlab::analysis {

/// One self-contained page; shows those of `figures` that the document names.
std::string html_page(const Document& document, const std::vector<Figure>& figures);
/// The same as Markdown.
std::string markdown_page(const Document& document, const std::vector<Figure>& figures);

}  // namespace pinchlab::analysis
