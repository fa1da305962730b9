// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "analysis/pages.h"

namespace pinchlab::analysis {

namespace {

// Text from outside must not break out of its table cell or become markup.
std::string escape(const std::string& text) {
  std::string escaped;
  for (char c : text) {
    if (c == '\n') {
      escaped += "<br>";
    } else if (c != '\r') {
      if (c == '<') {
        escaped += "&lt;";
        continue;
      }
      if (c == '|' || c == '*' || c == '_' || c == '`' || c == '\\' || c == '[' || c == ']' ||
          c == '#') {
        escaped += '\\';
      }
      escaped += c;
    }
  }
  return escaped;
}

class Printer {
 public:
  explicit Printer(const std::vector<Figure>& figures) : figures_(figures) {}
  std::string text;

  void operator()(const Heading& heading) { text += fmt::format("\n## {}\n", heading.text); }
  void operator()(const Paragraph& paragraph) {
    text += fmt::format("\n{}\n", escape(paragraph.text));
  }

  void operator()(const FigureBlock& block) {
    for (const Figure& figure : figures_) {
      if (figure.name == block.name)
        text += fmt::format("\n![{}]({}.svg)\n", escape(figure.caption), figure.name);
    }
  }

  void operator()(const TableBlock& table) {
    text += fmt::format("\nTable {}: {}\n\n|", ++tables_, escape(table.caption));
    for (const std::string& name : table.header) text += fmt::format(" {} |", escape(name));
    text += "\n|:--|";
    for (size_t i = 1; i < table.header.size(); ++i) text += "--:|";
    text += "\n";
    for (const auto& row : table.rows) {
      text += "|";
      for (const TextCell& cell : row) {
        const std::string content = escape(cell.text);
        text += cell.bold ? " **" + content + "** |" : " " + content + " |";
      }
      text += "\n";
    }
  }

 private:
  const std::vector<Figure>& figures_;
  int tables_ = 0;
};

}  // namespace

std::string markdown_page(const Document& document, const std::vector<Figure>& figures) {
  Printer printer(figures);
  printer.text = fmt::format("# {}\n", escape(document.title));
  for (const Block& block : document.blocks) std::visit(printer, block);
  return printer.text;
}

}  // namespace pinchlab::analysis
