// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/gnuplot.h"
#include "analysis/report.h"
#include "base/partial_file.h"
#include "base/read_file.h"

namespace pinchlab::analysis {

namespace fs = std::filesystem;

std::vector<std::string> write_report(const Report& report, const AnswersTable& table,
                                      const fs::path& folder, bool with_figures) {
  StagingFolder staging(folder);
  std::vector<Figure> figures = with_figures ? make_figures(report) : std::vector<Figure>{};
  for (Figure& figure : figures) {
    staging.write(figure.name + ".gp", figure.script);
    run_gnuplot(staging.path(), figure.name + ".gp");
    staging.add(figure.name + ".svg");
    staging.add(figure.name + ".pdf");
    figure.svg = read_whole(staging.path() / (figure.name + ".svg"));
  }
  staging.write("report.html", report_html(report, table, figures));
  staging.write("report.md", report_markdown(report, table, figures));
  staging.write("report.json", report_json(report, table));
  for (const CsvTable& csv : report_csv(report, table)) staging.write(csv.name, csv.content);
  if (!table.answers.empty()) {
    staging.write("answers.csv", [&](std::ostream& file) { write_tidy_csv(table, file); });
  }
  return staging.keep();
}

}  // namespace pinchlab::analysis
