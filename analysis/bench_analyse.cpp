// SPDX-License-Identifier: GPL-3.0-or-later
// How long do a million answers take, next to reading their file alone, and how much memory?
//   pinchlab_bench_analyse
// Peak memory is that of the process so far, so the benchmarks stand in order of appetite.

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <gsl/gsl_randist.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include "analysis/gsl_support.h"
#include "analysis/report.h"

namespace pinchlab::analysis {
namespace {

namespace fs = std::filesystem;

// A tidy CSV of `participants` with eight answers each, in a file that vanishes with the program.
class Log {
 public:
  explicit Log(int participants)
      : path_(fs::temp_directory_path() /
              fmt::format("pinchlab-bench-{}-{}.csv", getpid(), participants)) {
    const Rng rng = make_rng(RandomUse::study, 1);
    std::ofstream file(path_);
    file << "participant,demonstration,choice,side,position,reaction_time_s\n";
    for (int p = 0; p < participants; ++p) {
      const double share = gsl_ran_beta(rng.get(), 8.0, 4.0);
      for (int j = 1; j <= 8; ++j) {
        const bool pinch = gsl_rng_uniform(rng.get()) < share;
        const bool left = gsl_rng_uniform(rng.get()) < 0.5;
        file << fmt::format("p{:06},{},{},{},{},{:.3f}\n", p, j, pinch ? "pinch" : "cable",
                            left ? "left" : "right", j, gsl_ran_lognormal(rng.get(), 1.0, 0.5));
      }
    }
  }
  ~Log() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

const fs::path& log_of(std::int64_t participants) {
  static const Log small(12500);
  static const Log large(125000);
  return participants == 12500 ? small.path() : large.path();
}

void report_memory(benchmark::State& state) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["peak_MB"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
  state.counters["answers/s"] = benchmark::Counter(static_cast<double>(8 * state.range(0)),
                                                   benchmark::Counter::kIsIterationInvariantRate);
}

void read_file_alone(benchmark::State& state) {
  const fs::path& path = log_of(state.range(0));
  std::vector<char> buffer(size_t{1} << 20);
  while (state.KeepRunning()) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                               std::fclose);
    size_t lines = 0;
    for (size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), file.get())) > 0;) {
      lines += static_cast<size_t>(std::count(buffer.data(), buffer.data() + n, '\n'));
    }
    benchmark::DoNotOptimize(lines);
  }
  report_memory(state);
}

void read_into_table(benchmark::State& state) {
  const fs::path& path = log_of(state.range(0));
  while (state.KeepRunning()) benchmark::DoNotOptimize(read_answers({path}, {}));
  report_memory(state);
}

void read_and_analyse(benchmark::State& state) {
  const fs::path& path = log_of(state.range(0));
  while (state.KeepRunning()) {
    const AnswersTable table = read_answers({path}, {});
    benchmark::DoNotOptimize(report_json(analyse_table(table, {}), table));
  }
  report_memory(state);
}

BENCHMARK(read_file_alone)->Arg(12500)->Arg(125000)->Unit(benchmark::kMillisecond);
BENCHMARK(read_into_table)->Arg(12500)->Unit(benchmark::kMillisecond);
BENCHMARK(read_and_analyse)->Arg(12500)->Unit(benchmark::kMillisecond);
BENCHMARK(read_into_table)->Arg(125000)->Unit(benchmark::kMillisecond);
BENCHMARK(read_and_analyse)->Arg(125000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pinchlab::analysis

BENCHMARK_MAIN();
