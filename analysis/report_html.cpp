// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "analysis/pages.h"
#include "base/html.h"

namespace pinchlab::analysis {

namespace {

constexpr const char* style = R"(
body { font: 16px/1.5 system-ui, sans-serif; color: #1b1b1b; background: #fff; max-width: 72rem; margin: 2rem auto; padding: 0 1.5rem; }
h1 { font-size: 1.7rem; line-height: 1.2; }
h2 { font-size: 1.25rem; margin-top: 2.2rem; border-bottom: 1px solid #ccc; padding-bottom: .2rem; }
p { max-width: 48rem; }
p.answer { font-size: 1.1rem; background: #f1f5f9; border-left: 4px solid #0072b2; padding: .8rem 1rem; }
.wide { overflow-x: auto; margin: 1.2rem 0; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: #444; padding-bottom: .35rem; }
th, td { padding: .25rem .65rem; text-align: right; border-bottom: 1px solid #e2e2e2; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
thead th { border-bottom: 2px solid #888; vertical-align: bottom; white-space: normal; }
table.text td { text-align: left; white-space: pre-wrap; vertical-align: top; }
table.text th { text-align: left; }
figure { margin: 1.5rem 0; }
figure img { max-width: 100%; height: auto; }
figcaption { color: #444; font-size: .9rem; max-width: 48rem; }
@media print { body { margin: 0; max-width: none; font-size: 11px; } }
)";

std::string base64(const std::string& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    unsigned word = 0;
    for (size_t j = 0; j < 3; ++j) {
      word = word << 8U | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0U);
    }
    for (size_t j = 0; j < 4; ++j) {
      text += i + j > bytes.size() ? '=' : digits[word >> (18U - 6U * j) & 63U];
    }
  }
  return text;
}

class Printer {
 public:
  explicit Printer(const std::vector<Figure>& figures) : figures_(figures) {}
  std::string text;

  void operator()(const Heading& heading) {
    text += fmt::format("<h2>{}</h2>\n", html_escaped(heading.text));
  }

  void operator()(const Paragraph& paragraph) {
    text += fmt::format("<p{}>{}</p>\n", first_ ? " class=\"answer\"" : "",
                        html_escaped(paragraph.text));
    first_ = false;
  }

  void operator()(const TableBlock& table) {
    // Tables of words (exclusions, free texts) wrap; tables of numbers do not.
    const bool words = !table.header.empty() && table.header[0] == "participant";
    text += fmt::format("<div class=\"wide\"><table{}>\n<caption>{}</caption>\n<thead><tr>",
                        words ? " class=\"text\"" : "", html_escaped(table.caption));
    for (const std::string& name : table.header)
      text += fmt::format("<th scope=\"col\">{}</th>", html_escaped(name));
    text += "</tr></thead>\n<tbody>\n";
    for (const auto& row : table.rows) {
      text += "<tr>";
      for (const TextCell& cell : row) {
        const std::string content = html_escaped(cell.text);
        text += cell.bold ? "<td><b>" + content + "</b></td>" : "<td>" + content + "</td>";
      }
      text += "</tr>\n";
    }
    text += "</tbody></table></div>\n";
  }

  void operator()(const FigureBlock& block) {
    for (const Figure& figure : figures_) {
      if (figure.name != block.name) continue;
      // As an image the drawing keeps its own names and styles apart from the page's.
      text += fmt::format(
          "<figure><img alt=\"{0}\" src=\"data:image/svg+xml;base64,{1}\">\n"
          "<figcaption>{0}</figcaption></figure>\n",
          html_escaped(figure.caption), base64(figure.svg));
    }
  }

 private:
  const std::vector<Figure>& figures_;
  bool first_ = true;
};

}  // namespace

std::string html_page(const Document& document, const std::vector<Figure>& figures) {
  Printer printer(figures);
  printer.text = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
      html_escaped(document.title), style);
  for (const Block& block : document.blocks) std::visit(printer, block);
  printer.text += "</body>\n</html>\n";
  return printer.text;
}

}  // namespace pinchlab::analysis
