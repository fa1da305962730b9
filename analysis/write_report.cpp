// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <stdexcept>

#include "analysis/gnuplot.h"
#include "analysis/report.h"

namespace pinchlab::analysis {

namespace fs = std::filesystem;

namespace {

// A folder inside the output folder (so that renaming cannot cross file systems) that takes what is
// not finished yet and vanishes with it.
class Staging {
 public:
  explicit Staging(const fs::path& folder)
      : folder_(folder), staging_(folder / fmt::format(".unfinished-{}", getpid())) {
    if (fs::exists(folder) && !fs::is_directory(folder)) {
      throw std::runtime_error(
          fmt::format("{}: is not a folder; name another one with --out", folder.string()));
    }
    fs::create_directories(staging_);
  }
  ~Staging() {
    std::error_code ignored;
    fs::remove_all(staging_, ignored);
  }
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;

  [[nodiscard]] const fs::path& path() const { return staging_; }

  template <class Write>
  void add(const std::string& name, Write write) {
    std::ofstream file(staging_ / name, std::ios::binary);
    write(file);
    file.close();
    if (!file) {
      throw std::runtime_error(
          fmt::format("{}: cannot be written; is the disk full?", (folder_ / name).string()));
    }
    names_.push_back(name);
  }
  void add_text(const std::string& name, const std::string& text) {
    add(name, [&](std::ofstream& file) { file << text; });
  }
  void add_existing(const std::string& name) { names_.push_back(name); }

  std::vector<std::string> publish() {
    for (const std::string& name : names_) fs::rename(staging_ / name, folder_ / name);
    return names_;
  }

 private:
  fs::path folder_;
  fs::path staging_;
  std::vector<std::string> names_;
};

std::string read_all(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

std::vector<std::string> write_report(const Report& report, const AnswersTable& table,
                                      const fs::path& folder, bool with_figures) {
  Staging staging(folder);
  std::vector<Figure> figures = with_figures ? make_figures(report) : std::vector<Figure>{};
  for (Figure& figure : figures) {
    staging.add_text(figure.name + ".gp", figure.script);
    run_gnuplot(staging.path(), figure.name + ".gp");
    staging.add_existing(figure.name + ".svg");
    staging.add_existing(figure.name + ".pdf");
    figure.svg = read_all(staging.path() / (figure.name + ".svg"));
  }
  staging.add_text("report.html", report_html(report, table, figures));
  staging.add_text("report.md", report_markdown(report, table, figures));
  staging.add_text("report.json", report_json(report, table));
  for (const CsvTable& csv : report_csv(report, table)) staging.add_text(csv.name, csv.content);
  if (!table.answers.empty()) {
    staging.add("answers.csv", [&](std::ofstream& file) { write_tidy_csv(table, file); });
  }
  return staging.publish();
}

}  // namespace pinchlab::analysis
