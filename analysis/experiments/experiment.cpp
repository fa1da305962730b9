// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/experiment.h"

#include <fmt/format.h>
#include <gsl/gsl_fit.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <stdexcept>

#include "analysis/gnuplot.h"
#include "base/csv.h"
#include "base/output_file.h"
#include "base/partial_file.h"
#include "base/progress.h"
#include "demos/version.h"

namespace pinchlab::experiments {

namespace fs = std::filesystem;

std::vector<int> loads_of(const Options& options, std::vector<int> fewer) {
  if (options.quick && options.loads == Options().loads) return fewer;
  std::vector<int> loads = options.loads;
  std::sort(loads.begin(), loads.end());
  loads.erase(std::unique(loads.begin(), loads.end()), loads.end());
  return loads;
}

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

namespace {

/// Value at `share` (0 to 1) of sorted samples, interpolated between neighbours.
double quantile(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double part = place - static_cast<double>(below);
  return (1.0 - part) * sorted[below] + part * sorted[above];
}

}  // namespace

Spread spread(std::vector<double> samples) {
  if (samples.empty()) throw std::logic_error("spread: there are no samples");
  std::sort(samples.begin(), samples.end());
  return {quantile(samples, 0.1), quantile(samples, 0.5), quantile(samples, 0.9)};
}

double growth_exponent(const std::vector<double>& sizes, const std::vector<double>& costs) {
  if (sizes.size() != costs.size() || sizes.size() < 2) {
    throw std::logic_error("growth_exponent: two or more pairs are needed");
  }
  std::vector<double> x, y;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    x.push_back(std::log(sizes[i]));
    y.push_back(std::log(costs[i]));
  }
  double offset = 0.0, slope = 0.0, cov00 = 0.0, cov01 = 0.0, cov11 = 0.0, residual = 0.0;
  gsl_fit_linear(x.data(), 1, y.data(), 1, x.size(), &offset, &slope, &cov00, &cov01, &cov11,
                 &residual);
  return slope;
}

namespace {

std::string csv_text(const Csv::Cell& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return csv_cell(*text);
  if (const auto* number = std::get_if<double>(&cell)) return fmt::format("{}", *number);
  return fmt::format("{}", std::get<std::int64_t>(cell));
}

/// The processor's name as the system tells it.
std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown processor";
}

/// Machine, compiler, version and command, a line each.
std::vector<std::string> origin(const std::string& command) {
  return {fmt::format("machine: {}, {} cores", processor(), ::sysconf(_SC_NPROCESSORS_ONLN)),
#ifdef __clang__
          std::string("compiler: ") + __VERSION__,
#else
          std::string("compiler: GCC ") + __VERSION__,
#endif
          std::string("version: pinchlab ") + pinchlab::version, "command: " + command};
}

}  // namespace

Csv::Csv(std::vector<std::string> columns) : columns_(std::move(columns)) {}

void Csv::row(std::vector<Cell> cells) {
  if (cells.size() != columns_.size()) {
    throw std::logic_error(
        fmt::format("Csv: {} cells in a row of {}", cells.size(), columns_.size()));
  }
  rows_.push_back(std::move(cells));
}

std::string Csv::text() const {
  std::string text;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    text += (c > 0 ? "," : "") + csv_cell(columns_[c]);
  }
  text += '\n';
  for (const std::vector<Cell>& row : rows_) {
    for (std::size_t c = 0; c < row.size(); ++c) text += (c > 0 ? "," : "") + csv_text(row[c]);
    text += '\n';
  }
  return text;
}

std::string markdown_table(const std::vector<std::string>& header,
                           const std::vector<std::vector<std::string>>& rows) {
  const auto line = [](const std::vector<std::string>& cells) {
    return fmt::format("| {} |\n", fmt::join(cells, " | "));
  };
  std::string text = line(header) + '|';
  for (std::size_t c = 0; c < header.size(); ++c) text += c == 0 ? ":--|" : "--:|";
  text += '\n';
  for (const std::vector<std::string>& row : rows) text += line(row);
  return text;
}

Output::Output(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) {
    throw std::runtime_error(fmt::format("{}: cannot be made: {}; name another folder with --out",
                                         folder_.string(), error.message()));
  }
}

void Output::write(const std::string& name, const std::string& text) const {
  OutputFile file(folder_ / name);
  file.write(text);
  file.finish();
}

void Output::csv(const std::string& name, const Csv& table, const std::string& command) {
  std::string text;
  for (const std::string& line : origin(command)) text += "# " + line + '\n';
  write(name + ".csv", text + table.text());
}

void Output::page(const std::string& name, const std::string& text, const std::string& command) {
  write(name + ".md", fmt::format("{}\n---\n{}\n", text, fmt::join(origin(command), "; ")));
}

const char* const figure_preamble =
    "set datafile separator comma\n"
    "set datafile commentschars '#'\n"
    "set datafile columnheaders\n"
    "set datafile missing NaN\n"
    "set grid lc rgb '#e0e0e0' lt 1\n"
    "set border 3 lc rgb '#888888'\n"
    "set tics nomirror scale 0.5 tc rgb '#333333'\n"
    "set style line 1 lc rgb '#0072B2' lw 2 pt 7 ps 0.7\n"
    "set style line 2 lc rgb '#D55E00' lw 2 pt 5 ps 0.7\n"
    "set style line 3 lc rgb '#009E73' lw 2 pt 9 ps 0.8\n"
    "set style line 4 lc rgb '#CC79A7' lw 2 pt 11 ps 0.8\n"
    "set style line 5 lc rgb '#E69F00' lw 2 pt 13 ps 0.8\n"
    "set style line 6 lc rgb '#56B4E9' lw 2 pt 6 ps 0.8\n"
    "set style line 7 lc rgb '#555555' lw 2 pt 4 ps 0.8\n"
    "set style line 8 lc rgb '#000000' lw 2 pt 8 ps 0.8\n";

std::string column_where(const std::string& column,
                         const std::vector<std::pair<std::string, std::string>>& where) {
  std::string condition;
  for (const auto& [name, text] : where) {
    condition += fmt::format("{}strcol('{}') eq {}", condition.empty() ? "" : " && ", name,
                             analysis::gnuplot_quote(text));
  }
  return fmt::format("({} ? column('{}') : NaN)", condition, column);
}

void Output::figure(const std::string& name, int width_px, int height_px,
                    const std::string& commands) {
  const std::string body = figure_preamble + commands + '\n';
  StagingFolder staging(folder_);
  // It draws beside what is finished, and reads tables of this folder.
  const std::string draft = (staging.path().filename() / name).string();
  write(draft + ".gp", analysis::gnuplot_script(draft, width_px, height_px, body));
  analysis::run_gnuplot(folder_, draft + ".gp");
  fs::remove(folder_ / "gnuplot.log");
  staging.write(name + ".gp", analysis::gnuplot_script(name, width_px, height_px, body));
  for (const char* ending : {".svg", ".pdf"}) staging.add(name + ending);
  staging.keep();
}

Progress::Progress(const std::string& what, double total)
    : progress_(std::make_unique<pinchlab::Progress>(what, "", 1000)), total_(total) {}

Progress::~Progress() = default;

void Progress::done(double amount) {
  done_ += amount;
  const auto thousandths = static_cast<std::int64_t>(1000.0 * std::min(done_ / total_, 1.0));
  progress_->add(thousandths - told_);
  told_ = thousandths;
}

}  // namespace pinchlab::experiments
