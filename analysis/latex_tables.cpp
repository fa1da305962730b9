// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <map>

#include "analysis/pages.h"

namespace pinchlab::analysis {
namespace {

// As LaTeX shows it; what LaTeX takes for its own, and the signs beyond Latin 1 that reports use. A
// bracket or star at the start of a row would belong to the line's end before.
std::string escaped(const std::string& text) {
  static const std::map<char, const char*> own = {{'\\', "\\textbackslash{}"},
                                                  {'{', "\\{"},
                                                  {'}', "\\}"},
                                                  {'$', "\\$"},
                                                  {'&', "\\&"},
                                                  {'#', "\\#"},
                                                  {'_', "\\_"},
                                                  {'%', "\\%"},
                                                  {'^', "\\textasciicircum{}"},
                                                  {'~', "\\textasciitilde{}"},
                                                  {'<', "$<$"},
                                                  {'>', "$>$"},
                                                  {'|', "\\textbar{}"},
                                                  {'"', "''"},
                                                  {'`', "\\textasciigrave{}"},
                                                  {'[', "{[}"},
                                                  {'*', "{*}"},
                                                  {'\n', " "}};
  static const std::map<std::string, std::string> signs = {
      {"–", "--"},        {"—", "---"},       {"−", "$-$"},      {"×", "$\\times$"},
      {"χ", "$\\chi$"},   {"²", "$^2$"},      {"≤", "$\\leq$"},  {"≥", "$\\geq$"},
      {"κ", "$\\kappa$"}, {"σ", "$\\sigma$"}, {"…", "\\dots{}"}, {"’", "'"}};
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (const auto found = own.find(text[i]); found != own.end()) {
      result += found->second;
      continue;
    }
    bool is_sign = false;
    for (const auto& [sign, latex] : signs) {
      if (text.compare(i, sign.size(), sign) != 0) continue;
      result += latex;
      i += sign.size() - 1;
      is_sign = true;
      break;
    }
    if (!is_sign) result += text[i];
  }
  return result;
}

std::string line_of(const std::vector<std::string>& cells, std::size_t columns) {
  std::string line = "  ";
  for (std::size_t i = 0; i < columns; ++i) {
    line += (i == 0 ? "" : " & ") + (i < cells.size() ? cells[i] : "");
  }
  return line + " \\\\\n";
}

std::string table_of(const TableBlock& table, std::size_t number) {
  const std::size_t columns = table.header.size();
  std::vector<std::string> header;
  header.reserve(columns);
  for (const std::string& cell : table.header) header.push_back(escaped(cell));
  std::string text = fmt::format(
      "\\begin{{table}}\n  \\centering\n  \\caption{{{}}}\n  \\label{{tab:pinchlab-{}}}\n"
      "  \\begin{{tabular}}{{l{}}}\n  \\toprule\n",
      escaped(table.caption), number, std::string(columns - 1, 'r'));
  text += line_of(header, columns) + "  \\midrule\n";
  for (const std::vector<TextCell>& row : table.rows) {
    std::vector<std::string> cells;
    cells.reserve(row.size());
    for (const TextCell& cell : row) {
      cells.push_back(cell.bold ? "\\textbf{" + escaped(cell.text) + "}" : escaped(cell.text));
    }
    text += line_of(cells, columns);
  }
  return text + "  \\bottomrule\n  \\end{tabular}\n\\end{table}\n";
}

}  // namespace

std::string latex_tables(const Document& document) {
  std::string text = "% " + escaped(document.title) + ". Needs \\usepackage{booktabs}.\n";
  std::size_t number = 0;
  for (const Block& block : document.blocks) {
    const auto* table = std::get_if<TableBlock>(&block);
    if (table != nullptr && !table->header.empty()) text += "\n" + table_of(*table, ++number);
  }
  return text;
}

}  // namespace pinchlab::analysis
