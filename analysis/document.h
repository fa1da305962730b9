// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A report as a list of blocks, so that the HTML page and the Markdown appendix say the same.

#include <string>
#include <variant>
#include <vector>

#include "analysis/report.h"

namespace pinchlab::analysis {

struct Heading {
  std::string text;
};

struct Paragraph {
  std::string text;
};

struct TextCell {
  std::string text;
  bool bold = false;
};

/// A table whose first column names the rows.
struct TableBlock {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<TextCell>> rows;
};

/// The place of a figure, by its name.
struct FigureBlock {
  std::string name;
};

using Block = std::variant<Heading, Paragraph, TableBlock, FigureBlock>;

struct Document {
  std::string title;
  std::vector<Block> blocks;
};

Document make_document(const Report& report, const AnswersTable& table);

/// What there is to say of graded preferences; nothing where there are none.
std::vector<Block> graded_blocks(const Report& report);

/// "0.0455", "4.7e-04", "1": for tables that readers look numbers up in.
std::string p_text(double p);
/// Thesis style: rounded to `decimals`, "<0.001" below the last digit, "1" at one.
std::string p_rounded(double p, int decimals);
/// `p_text`, or a dash where there is no value.
std::string p_text(const Estimate& p);
/// "83.3 %".
std::string percent(double share);

}  // namespace pinchlab::analysis
