// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A document printed.

#include <string>
#include <vector>

#include "analysis/document.h"
#include "base/partial_file.h"

namespace pinchlab::analysis {

/// One self-contained page; shows those of `figures` that the document names.
std::string html_page(const Document& document, const std::vector<Figure>& figures);
/// The same as Markdown.
std::string markdown_page(const Document& document, const std::vector<Figure>& figures);

/// Its tables for a LaTeX document, numbered and with their captions; needs the package booktabs,
/// and UTF-8.
std::string latex_tables(const Document& document);

/// Draws the figures and writes the document to the folder: report.html, report.md and tables.tex,
/// of each figure its script, SVG and PDF. Throws std::runtime_error.
void write_pages(const Document& document, std::vector<Figure> figures, StagingFolder& folder);

/// Adds report.json, `json` with a list of all files of the report, and puts the report in place.
/// Of the report that was there before, the files that its list has and this one's has not are
/// removed, but for `sources`, which this one was made from. Returns the files' names. Throws
/// InputError where it would replace one of these, or lie among answer files, and otherwise
/// std::runtime_error.
std::vector<std::string> keep_report(const std::string& json, StagingFolder& folder,
                                     const std::vector<std::string>& sources);

}  // namespace pinchlab::analysis
