// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/gnuplot.h"
#include "analysis/pages.h"
#include "analysis/report.h"
#include "base/partial_file.h"
#include "base/read_file.h"

namespace pinchlab::analysis {

namespace fs = std::filesystem;

void write_pages(const Document& document, std::vector<Figure> figures, StagingFolder& folder) {
  for (Figure& figure : figures) {
    folder.write(figure.name + ".gp", figure.script);
    run_gnuplot(folder.path(), figure.name + ".gp");
    folder.add(figure.name + ".svg");
    folder.add(figure.name + ".pdf");
    figure.svg = read_whole(folder.path() / (figure.name + ".svg"));
  }
  folder.write("report.html", html_page(document, figures));
  folder.write("report.md", markdown_page(document, figures));
  folder.write("tables.tex", latex_tables(document));
}

std::vector<std::string> write_report(const Report& report, const AnswersTable& table,
                                      const fs::path& folder, bool with_figures) {
  StagingFolder staging(folder);
  write_pages(make_document(report, table),
              with_figures ? make_figures(report) : std::vector<Figure>{}, staging);
  staging.write("report.json", report_json(report, table));
  for (const CsvTable& csv : report_csv(report, table)) staging.write(csv.name, csv.content);
  if (!table.answers.empty()) {
    staging.write("answers.csv", [&](std::ostream& file) { write_tidy_csv(table, file); });
  }
  return staging.keep();
}

}  // namespace pinchlab::analysis
