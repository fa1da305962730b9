// SPDX-License-Identifier: GPL-3.0-or-later
// How well thresholds are found by chosen levels and by constant stimuli, against the number of
// trials: participants of a known truth take part over HTTP, as `pinchlab study simulate` lets
// them. For analysis/results: pinchlab_adaptive_study --out analysis/results

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <utility>

#include "analysis/psychometric.h"
#include "analysis/result_main.h"
#include "base/answer_file.h"
#include "base/number_option.h"
#include "base/partial_file.h"
#include "study/adaptive.h"
#include "study/simulate.h"

using namespace pinchlab;
namespace fs = std::filesystem;
using nlohmann::json;

namespace {

struct Settings : analysis::ResultSettings {
  int participants = 60;
};

constexpr int most_trials = 80;
constexpr int levels = 11;
constexpr double lowest = 0.05, highest = 0.30, width = 0.15, lapses = 0.02;
constexpr const char* series = "squeeze";

struct Condition {
  const char* name;
  bool is_adaptive;
  double threshold;
};
const std::vector<Condition> conditions{{"chosen levels", true, 0.16},
                                        {"constant stimuli", false, 0.16},
                                        {"chosen levels", true, 0.25},
                                        {"constant stimuli", false, 0.25}};

// A study whose clips are no videos; the server does not look into them.
study::DeskOptions study_in(const fs::path& folder, const Condition& condition,
                            std::uint64_t seed) {
  fs::create_directories(folder / "clips");
  json clips = json::array();
  for (int i = 0; i < levels; ++i) {
    json clip = {{"level", lowest + (highest - lowest) * i / (levels - 1)}};
    for (const char* side : {"left", "right"}) {
      const std::string name = fmt::format("{}-{}.mp4", i, side);
      std::ofstream(folder / "clips" / name) << name;
      clip[side] = name;
    }
    clips.push_back(clip);
  }
  json document = {{"format", "pinchlab-study 1"},
                   {"series", {{{"name", series}, {"clips", clips}}}}};
  // Constant stimuli: whole rounds of all levels.
  const char* how_many = condition.is_adaptive ? "adaptive_trials" : "repetitions";
  document[how_many] = condition.is_adaptive ? most_trials : (most_trials + levels - 1) / levels;
  study::DeskOptions options;
  options.config = study::parse_config(document, "study.json");
  options.config.is_pilot = true;
  options.clips = study::open_clips(folder / "clips", options.config);
  options.answers = folder / "answers";
  options.seed = seed;
  return options;
}

using Answers = std::vector<study::GradedAnswer>;

std::vector<Answers> simulated(const Condition& condition, const Settings& settings) {
  const fs::path folder =
      fs::temp_directory_path() / fmt::format("pinchlab-adaptive-{}", ::getpid());
  fs::remove_all(folder);
  std::vector<Answers> people;
  {
    study::Desk desk(study_in(folder, condition, settings.seed));
    study::Truth truth;
    truth.series[series] = {condition.threshold, width, 0.0};
    truth.lapses = lapses;
    study::SimulationOptions options;
    options.participants = settings.participants;
    options.seed = settings.seed;
    study::simulate(desk, truth, options);
    SameStudy same;
    for (const NamedAnswerFile& named : read_answer_files(
             folder / "answers", false, same, [](const std::string&) { return false; })) {
      Answers& answers = people.emplace_back();
      for (const Trial& trial : named.file.trials) {
        const std::string& chosen = trial.choice == Side::left ? trial.left : trial.right;
        answers.push_back({trial.level, chosen == "reference"});
      }
    }
  }
  fs::remove_all(folder);
  // Files have random names: in their order the figures would change from run to run.
  const auto as_numbers = [](const study::GradedAnswer& answer) {
    return std::pair(answer.level, answer.is_hit);
  };
  std::ranges::sort(people, [&as_numbers](const Answers& a, const Answers& b) {
    return std::ranges::lexicographical_compare(a, b, {}, as_numbers, as_numbers);
  });
  return people;
}

// What the first trials of everybody say.
struct Found {
  double bias = 0, spread = 0, error = 0;  // of each participant's posterior mean
  double deviation = 0;                    // of the posterior, on average
  analysis::PsychometricFit fit;           // of all together
};

Found found_after(std::size_t trials, const std::vector<Answers>& people, double truth,
                  const std::vector<double>& all_levels, std::uint64_t seed) {
  Found found;
  std::vector<analysis::Observer> observers;
  double sum = 0, squares = 0;
  for (const Answers& all : people) {
    const Answers first(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(trials));
    const study::ThresholdEstimate one = study::estimate_threshold(all_levels, first);
    sum += one.mean - truth;
    squares += (one.mean - truth) * (one.mean - truth);
    found.deviation += one.deviation;
    std::map<double, analysis::LevelCell> cells;
    for (const study::GradedAnswer& answer : first) {
      analysis::LevelCell& cell = cells[answer.level];
      cell.level = answer.level;
      ++cell.trials;
      cell.hits += answer.is_hit ? 1 : 0;
    }
    analysis::Observer& observer = observers.emplace_back();
    observer.name = std::to_string(observers.size());
    for (const auto& [level, cell] : cells) observer.cells.push_back(cell);
  }
  const auto n = static_cast<double>(people.size());
  found.bias = sum / n;
  found.error = std::sqrt(squares / n);
  found.spread = std::sqrt((squares - sum * sum / n) / (n - 1));
  found.deviation /= n;
  found.fit = analysis::fit_psychometric({}, observers, {0.05, 0, seed});
  return found;
}

std::string number(const analysis::Estimate& value) {
  return value ? fmt::format("{:.4f}", value.value) : "–";
}

std::string cell(const analysis::Estimate& value) {
  return value ? fmt::format("{}", value.value) : "";
}

std::string page_head(const Settings& settings) {
  return fmt::format(
      "# Thresholds by chosen levels and by constant stimuli\n\n"
      "Written by `pinchlab_adaptive_study --out analysis/results --participants {} --seed {}`.\n\n"
      "{} simulated participants a study take part over HTTP, as `pinchlab study simulate` lets "
      "them. {} levels from {} to {}, one truth for all: the width is {}, {:g} % of answers are "
      "throws of a coin. Each line looks at everybody's first trials. Bias, spread (standard "
      "deviation) and root mean square error are of the single participant's threshold: the mean "
      "of the posterior that chooses the levels, which starts at {:g}, so that few trials are "
      "drawn towards it. Its own standard deviation, on average, stands beside them. The last "
      "column is the threshold that `pinchlab analyse` fits to all together, with its 95 % "
      "profile-likelihood interval. Three standard errors of a bias are {:.2f} of the spread.\n",
      settings.participants, settings.seed, settings.participants, levels, lowest, highest, width,
      100 * lapses, (lowest + highest) / 2, 3 / std::sqrt(settings.participants));
}

void run(const Settings& settings) {
  std::string csv =
      "levels,threshold,trials,participants,bias,spread,rms_error,posterior_deviation,fitted,"
      "fitted_low,fitted_high\n";
  std::string page = page_head(settings);
  std::vector<double> all_levels;
  all_levels.reserve(levels);
  for (int i = 0; i < levels; ++i) {
    all_levels.push_back(lowest + (highest - lowest) * i / (levels - 1));
  }
  for (const Condition& condition : conditions) {
    fmt::print(stderr, "{}, {}\n", condition.name, condition.threshold);
    page += fmt::format(
        "\n## {}, true threshold {}\n\n"
        "| trials | bias | spread | rms error | posterior's deviation | fitted to all |\n"
        "|--:|--:|--:|--:|--:|:--|\n",
        condition.is_adaptive ? "Chosen levels (Psi method)" : "Constant stimuli",
        condition.threshold);
    const std::vector<Answers> people = simulated(condition, settings);
    for (const std::size_t trials : {10U, 20U, 40U, 80U}) {
      const Found found =
          found_after(trials, people, condition.threshold, all_levels, settings.seed);
      page += fmt::format("| {} | {:.4f} | {:.4f} | {:.4f} | {:.4f} | {} ({} to {}) |\n", trials,
                          found.bias, found.spread, found.error, found.deviation,
                          number(found.fit.threshold), number(found.fit.threshold_low),
                          number(found.fit.threshold_high));
      csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", condition.name, condition.threshold,
                         trials, people.size(), found.bias, found.spread, found.error,
                         found.deviation, cell(found.fit.threshold), cell(found.fit.threshold_low),
                         cell(found.fit.threshold_high));
    }
  }
  StagingFolder staging(settings.out);
  staging.write("adaptive-recovery.csv", csv);
  staging.write("adaptive-recovery.md", page);
  staging.keep();
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  return analysis::result_main(
      argc, argv, "pinchlab_adaptive_study",
      "Simulates threshold studies with chosen levels and with constant stimuli, over HTTP",
      settings,
      [&](CLI::App& app) {
        app.add_option("--participants", settings.participants, "Of each study")
            ->capture_default_str()
            ->check(whole_in(10, 10000));
      },
      [&] { run(settings); });
}
