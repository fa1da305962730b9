// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What all experiments share: clocks, raw tables, figures, pages, progress.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace pinchlab {
class Progress;
}

namespace pinchlab::experiments {

struct Options {
  std::filesystem::path out = "results";  ///< folder of what is written, made if missing
  bool quick = false;   ///< the same figures from fewer points, in a tenth of the time
  std::string command;  ///< what was typed to get this, for the files that are written
  std::vector<int> loads{1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000};  ///< of stress scenes
};

/// The loads to measure, in order and without doubles: with --quick and no --loads the fewer ones.
std::vector<int> loads_of(const Options& options, std::vector<int> fewer);

/// Processor time of the calling thread, s.
double cpu_seconds();

/// Median, and the first and ninth decile.
struct Spread {
  double low = 0.0, median = 0.0, high = 0.0;
};

/// Of one or more finite samples.
Spread spread(std::vector<double> samples);

/// Slope of log(cost) over log(size) by least squares: 1 for cost linear in size. Two or more
/// pairs, all positive.
double growth_exponent(const std::vector<double>& sizes, const std::vector<double>& costs);

/// A raw table. Numbers are written so that they read back exactly; units stand in column names.
class Csv {
 public:
  using Cell = std::variant<std::string, double, std::int64_t>;
  explicit Csv(std::vector<std::string> columns);
  /// Adds a row with one cell a column.
  void row(std::vector<Cell> cells);
  std::string text() const;  ///< header and rows

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<Cell>> rows_;
};

/// Rows of a Markdown table with a header row.
std::string markdown_table(const std::vector<std::string>& header,
                           const std::vector<std::vector<std::string>>& rows);

/// The folder that one experiment writes to. Each file gets its name only when it is whole. All
/// functions throw std::runtime_error with the cure where that fails.
class Output {
 public:
  explicit Output(std::filesystem::path folder);  ///< makes the folder

  /// NAME.csv, opened by `# ` lines that tell machine, compiler, version of Pinchlab and command.
  void csv(const std::string& name, const Csv& table, const std::string& command);

  /// NAME.svg and NAME.pdf, and NAME.gp that draws them, from gnuplot commands that read tables of
  /// this folder by name. `figure_preamble` comes before the commands.
  void figure(const std::string& name, int width_px, int height_px, const std::string& commands);

  /// NAME.md; a line on machine, compiler, version and `command` is put under the text.
  void page(const std::string& name, const std::string& text, const std::string& command);

 private:
  void write(const std::string& name, const std::string& text) const;

  std::filesystem::path folder_;
};

/// What all figures begin with: commas between cells, `# ` before comments, the first row as column
/// names (`using (column("load")):(column("step_s"))`), grid and borders, and line styles 1 to 8 in
/// Okabe and Ito's colours, which colour-blind readers tell apart, with a point type each.
extern const char* const figure_preamble;

/// For gnuplot's `using`: the number in `column` in rows whose cells equal `where` (pairs of column
/// and text), nothing in other rows.
std::string column_where(const std::string& column,
                         const std::vector<std::pair<std::string, std::string>>& where);

/// Tells on stderr how far a long experiment is, with the time left.
class Progress {
 public:
  Progress(const std::string& what, double total);  ///< total in any unit of work
  ~Progress();
  void done(double amount);

 private:
  std::unique_ptr<pinchlab::Progress> progress_;
  double total_ = 0.0, done_ = 0.0;
  std::int64_t told_ = 0;  // thousandths
};

}  // namespace pinchlab::experiments
