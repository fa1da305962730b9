// SPDX-License-Identifier: GPL-3.0-or-later
// Simulates threshold studies of a known truth and tells how well it is recovered, for
// analysis/results: pinchlab_threshold_study --out analysis/results

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "analysis/result_main.h"
#include "analysis/threshold_study.h"
#include "base/number_option.h"
#include "base/partial_file.h"

using namespace pinchlab::analysis;
using pinchlab::whole_in;

namespace {

struct Settings : ResultSettings {
  int studies = 1000;
  int resamples = 0;
};

struct Named {
  const char* name;
  ThresholdCondition condition;
};

const std::vector<Named> conditions{
    {"logistic, one participant", {Shape::logistic, 1, 7, 40, {0.0, 1.2, 0.5, 0.02}, 0.0}},
    {"normal, one participant", {Shape::normal, 1, 7, 100, {0.0, 1.2, 0.5, 0.02}, 0.0}},
    {"Weibull, one participant", {Shape::weibull, 1, 9, 60, {0.1, 1.5, 0.5, 0.02}, 0.0}},
    {"logistic, 12 participants", {Shape::logistic, 12, 7, 10, {0.0, 1.0, 0.5, 0.02}, 0.25}}};

void run(const Settings& settings) {
  std::string csv =
      "condition,participants,levels,trials,bias,rms_error,ln_slope_bias,mean_spread,true_spread,"
      "threshold_coverage,slope_coverage,bootstrap_threshold_coverage,misfit,without_slope,"
      "not_estimable\n";
  std::string page = fmt::format(
      "# Thresholds of a known truth\n\n"
      "Written by `pinchlab_threshold_study --out analysis/results --studies {} --resamples {} "
      "--seed {}`.\n\n"
      "{} simulated two-alternative studies a line: levels evenly spaced from -1 to 1 (Weibull: "
      "the "
      "logarithm of the level), guesses fixed at 0.5, lapses of 2 % that the fit has to find. Bias "
      "and error are of the threshold. Coverage is the share of 95 % intervals that hold the "
      "truth; "
      "three standard errors of the simulation are {:.1f} percentage points. Without slope are "
      "studies in which a function that jumps from one level to the next fits as well; the bias of "
      "the slope leaves them out.\n\n"
      "| | levels × trials | bias | rms error | ln slope, bias | spread (truth) | threshold "
      "covered "
      "| slope covered | bootstrap covers threshold | fit rejected | without slope | not estimable "
      "|\n"
      "|:--|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
      settings.studies, settings.resamples, settings.seed, settings.studies,
      300.0 * std::sqrt(0.05 * 0.95 / settings.studies));
  for (const auto& [name, condition] : conditions) {
    std::fprintf(stderr, "%s\n", name);
    const Recovery r =
        recovery(condition, settings.studies, {0.05, settings.resamples, settings.seed});
    csv += fmt::format("\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", name,
                       condition.participants, condition.levels, condition.trials, r.bias, r.error,
                       r.slope_bias, r.mean_spread, condition.spread, r.threshold_coverage,
                       r.slope_coverage, r.bootstrap_coverage, r.misfit, r.without_slope,
                       r.not_estimable);
    const bool resampled = settings.resamples > 0;
    page += fmt::format(
        "| {} | {} × {} | {:.3f} | {:.3f} | {:.3f} | {} | {:.1f} % | {:.1f} % | {} | {} | {} | {} "
        "|\n",
        name, condition.levels, condition.trials, r.bias, r.error, r.slope_bias,
        condition.participants > 1 ? fmt::format("{:.3f} ({})", r.mean_spread, condition.spread)
                                   : "–",
        100.0 * r.threshold_coverage, 100.0 * r.slope_coverage,
        resampled ? fmt::format("{:.1f} %", 100.0 * r.bootstrap_coverage) : "–",
        resampled ? fmt::format("{:.1f} %", 100.0 * r.misfit) : "–", r.without_slope,
        r.not_estimable);
  }
  pinchlab::StagingFolder staging(settings.out);
  staging.write("threshold-recovery.csv", csv);
  staging.write("threshold-recovery.md", page);
  staging.keep();
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  return result_main(
      argc, argv, "pinchlab_threshold_study",
      "Simulates threshold studies and tells how well their truth is recovered", settings,
      [&](CLI::App& app) {
        app.add_option("--studies", settings.studies, "Simulated studies a condition")
            ->capture_default_str()
            ->check(whole_in(100, 1000000));
        app.add_option("--resamples", settings.resamples,
                       "Bootstrap resamples a study (0: none, which is much faster)")
            ->capture_default_str()
            ->check(whole_in(0, 10000));
      },
      [&] { run(settings); });
}
