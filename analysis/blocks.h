// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A report as a list of blocks, so that the HTML page and the Markdown appendix say the same.

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "analysis/estimate.h"

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
  void add(Block block) { blocks.push_back(std::move(block)); }
  void add(std::vector<Block> more) {
    for (Block& block : more) blocks.push_back(std::move(block));
  }
};

inline constexpr const char* dash = "–";  ///< where there is no value

/// With so many decimals; a value that rounds to zero has no sign.
std::string fixed(double value, int decimals);
std::string fixed(const Estimate& value, int decimals);
/// "0.0455", "4.7e-04", "1": for tables that readers look numbers up in.
std::string p_text(double p);
/// Thesis style: rounded to `decimals`, "<0.001" below the last digit, "1" at one.
std::string p_rounded(double p, int decimals);
/// `p_text`, or a dash where there is no value.
std::string p_text(const Estimate& p);
/// "p = 0.0455", "p < 1e-300": for sentences.
std::string p_equation(const Estimate& p);
/// The same as a cell, bold below alpha.
TextCell p_cell(const Estimate& p, double alpha);
/// "83.3 %".
std::string percent(double share);

/// "1 of them a tie", "2 of them ties".
std::string ties_among(std::int64_t ties);
/// "95 %" of an alpha of 0.05.
std::string confidence_level(double alpha);

}  // namespace pinchlab::analysis
