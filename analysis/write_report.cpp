// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "analysis/gnuplot.h"
#include "analysis/pages.h"
#include "analysis/report.h"
#include "base/input_error.h"
#include "base/output_file.h"
#include "base/partial_file.h"
#include "base/read_file.h"

namespace pinchlab::analysis {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

// What the report in a folder lists as its own; nothing if there is none, or one without a list.
std::vector<std::string> listed_files(const fs::path& folder) {
  const fs::path path = folder / "report.json";
  if (!fs::is_regular_file(path)) return {};
  const ordered_json report =
      ordered_json::parse(read_whole(path), nullptr, /*allow_exceptions=*/false);
  std::vector<std::string> names;
  if (!report.is_object() || !report.contains("files") || !report["files"].is_array()) return names;
  for (const ordered_json& entry : report["files"]) {
    if (!entry.is_string()) continue;
    const fs::path name = entry.get<std::string>();
    if (name.has_filename() && name == name.filename()) names.push_back(name);  // no way out of it
  }
  return names;
}

// What is read stays as it is, and gets no report.json beside it that would pass for one more
// answer file.
void check_sources(const StagingFolder& folder, const std::vector<std::string>& sources) {
  for (const std::string& file : sources) {
    const fs::path source = file;
    const bool is_answers = fs::is_directory(source) || source.extension() == ".json";
    const fs::path around = fs::is_directory(source) ? source : source.parent_path() / ".";
    if (is_answers && is_same_file(around, folder.folder())) {
      throw InputError(source.string(),
                       "is among answers, for one of which report.json would be taken there; name "
                       "another folder for the report");
    }
  }
  for (const std::string& name : folder.names()) {
    const fs::path path = folder.folder() / name;
    for (const std::string& source : sources) {
      if (!fs::is_regular_file(path) || !is_same_file(source, path)) continue;
      if (read_whole(path) == read_whole(folder.path() / name)) continue;  // a report's own
      throw InputError(source, fmt::format("is read, and the report's {} would replace "
                                           "it; name another folder for the report",
                                           name));
    }
  }
}

}  // namespace

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

std::vector<std::string> keep_report(const std::string& json, StagingFolder& folder,
                                     const std::vector<std::string>& sources) {
  check_sources(folder, sources);
  ordered_json report = ordered_json::parse(json);
  std::vector<std::string> files = folder.names();
  files.emplace_back("report.json");
  std::ranges::sort(files);
  report["files"] = files;
  folder.write("report.json", report.dump(2) + "\n");
  const std::vector<std::string> before = listed_files(folder.folder());
  std::vector<std::string> written = folder.keep();
  for (const std::string& name : before) {
    const fs::path path = folder.folder() / name;
    const bool is_source = std::ranges::any_of(
        sources, [&](const std::string& source) { return is_same_file(source, path); });
    if (!std::ranges::binary_search(files, name) && !is_source && fs::is_regular_file(path)) {
      fs::remove(path);
    }
  }
  return written;
}

std::vector<std::string> write_report(const Report& report, const AnswersTable& table,
                                      const fs::path& folder, bool with_figures) {
  StagingFolder staging(folder);
  write_pages(make_document(report, table),
              with_figures ? make_figures(report) : std::vector<Figure>{}, staging);
  for (const CsvTable& csv : report_csv(report, table)) staging.write(csv.name, csv.content);
  if (!table.answers.empty()) {
    staging.write("answers.csv", [&](std::ostream& file) { write_tidy_csv(table, file); });
  }
  return keep_report(report_json(report, table), staging, table.sources);
}

}  // namespace pinchlab::analysis
