// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/commands.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "analysis/power.h"
#include "analysis/report.h"
#include "analysis/scale_report.h"
#include "analysis/sequential.h"
#include "analysis/threshold_report.h"
#include "base/input_error.h"
#include "base/text_checks.h"

namespace pinchlab::analysis {
namespace {

// "ours=theirs" pairs of --map-column, each for a column of ours.
std::map<std::string, std::string> column_map(const std::vector<std::string>& pairs) {
  std::map<std::string, std::string> columns;
  for (const std::string& pair : pairs) {
    const size_t equals = pair.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == pair.size()) {
      throw CLI::ValidationError("--map-column",
                                 fmt::format("`{}` is not of the form OURS=THEIRS", pair));
    }
    const std::string ours = pair.substr(0, equals);
    if (!is_input_column(ours)) {
      throw CLI::ValidationError("--map-column",
                                 fmt::format("there is no column `{}`; see --help", ours));
    }
    if (!columns.emplace(ours, pair.substr(equals + 1)).second) {
      throw CLI::ValidationError("--map-column", fmt::format("column `{}` is mapped twice", ours));
    }
  }
  return columns;
}

// "free", or a rate from 0 to `most_fixed`; a free one is estimated up to `most_free`.
Rate rate_of(const char* flag, const std::string& text, double most_fixed, double most_free) {
  if (text == "free") return {true, 0.0, most_free};
  const auto value = parse_number(text);
  if (!value || *value < 0.0 || *value > most_fixed) {
    throw CLI::ValidationError(
        flag, fmt::format("`{}` is neither `free` nor a number from 0 to {}", text, most_fixed));
  }
  return {false, *value, most_free};
}

void add_analyse(CLI::App& app) {
  struct Arguments {
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path out;
    std::vector<std::string> mapped;
    std::string separator = ",";
    bool no_figures = false;
    ReadOptions read;
    AnalysisOptions analyse;
    PsychometricModel model;
    std::string guess = "0.5 of correct answers, 0 of choices", lapse = "free";
    ScaleModel scale = ScaleModel::bradley_terry;
  };
  auto args = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("analyse", "Statistics and a report from the answers of a study");
  command->footer(
      "Answers come as files or folders of the study page (.json), as tidy CSV with the columns\n"
      "participant, demonstration, choice and, if known, group, side, position, reaction_time_s, "
      "kind,\n"
      "or as a CSV table of counts with the columns demonstration, pinch, cable.\n"
      "With a column `level` (graded stimuli) and `correct` (0 or 1; a count beside `trials`) or "
      "`choice`\n"
      "psychometric functions are fitted: thresholds and slopes with intervals.\n"
      "With the columns `left`, `right` and `choice` (or `left_wins`, `right_wins`, `ties`) "
      "methods "
      "are put on\none scale (Bradley and Terry's, or Thurstone's case V).\n"
      "Written to --out: report.html, report.md, report.json, CSV tables, figures as SVG and "
      "PDF.\n\n"
      "  pinchlab analyse answers/ --out report\n"
      "  pinchlab analyse analysis/data/thesis-table-5.3.csv --out report\n"
      "  pinchlab analyse other.csv --map-column participant=subject --map-column "
      "demonstration=scene \\\n"
      "      --map-column choice=picked --pinch-value ours --cable-value theirs --out report\n"
      "  pinchlab analyse squeeze.csv --function weibull --guess 0.5 --out report\n"
      "  pinchlab analyse analysis/data/citations.csv --scale thurstone --out report");
  command->add_option("answers", args->inputs, "Answer files (.json), folders of them, CSV files")
      ->required();
  command->add_option("--out", args->out, "Folder to write the report to (made if need be)")
      ->required();
  command->add_option("--alpha", args->analyse.alpha, "Significance level")
      ->capture_default_str()
      ->check(CLI::Range(1e-6, 0.5));
  command->add_option("--bootstrap", args->analyse.bootstrap, "Resamples of the cluster bootstrap")
      ->capture_default_str()
      ->check(CLI::Range(99, 1000000));
  command->add_option("--seed", args->analyse.seed, "Seed of all random numbers")
      ->capture_default_str();
  command->add_option(
      "--groups", args->read.groups_file,
      "CSV demonstration,group: what is analysed together (default: a column `group`, or names "
      "that begin with 1 to 6: clipping, 7 and 8: friction)");
  command->add_option("--exclude", args->read.exclude_file,
                      "CSV participant,reason: who is left out; the report names them");
  command
      ->add_option("--map-column", args->mapped,
                   "OURS=THEIRS: the name that a column has in the CSV files")
      ->allow_extra_args(false);
  command
      ->add_option(
          "--pinch-value", args->read.pinch_value,
          "What column `choice` says for the method under test; also its name in the report")
      ->capture_default_str();
  command
      ->add_option("--cable-value", args->read.cable_value,
                   "The same for the method it is compared with")
      ->capture_default_str();
  command->add_option("--separator", args->separator, "Character between CSV columns, or `tab`")
      ->capture_default_str();
  command
      ->add_option("--repetitions", args->read.repetitions,
                   "Answers that each participant gives to each demonstration (CSV)")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  command->add_flag("--allow-missing", args->read.allow_missing,
                    "Accept participants with answers missing");
  command->add_flag("--ignore-other-columns", args->read.ignore_other_columns,
                    "Accept CSV columns that are not known");
  const std::map<std::string, Shape> shapes{
      {"logistic", Shape::logistic}, {"normal", Shape::normal}, {"weibull", Shape::weibull}};
  command
      ->add_option_function<std::string>(
          "--function",
          [args, shapes](const std::string& name) { args->model.shape = shapes.at(name); },
          "Psychometric function of graded stimuli: logistic, normal or weibull [logistic]")
      ->type_name("F")
      ->check(CLI::IsMember(shapes));
  CLI::Option* guess = command->add_option(
      "--guess", args->guess, "Rate of hits by guessing, 0 to 0.9, or `free`: estimated up to 0.5");
  command
      ->add_option("--lapse", args->lapse,
                   "Rate of misses by inattention, 0 to 0.5, or `free`: estimated up to 0.1")
      ->capture_default_str();
  guess->capture_default_str();
  command
      ->add_option("--threshold-at", args->model.threshold_at,
                   "Share of the function's height at the threshold")
      ->capture_default_str()
      ->check(CLI::Range(0.01, 0.99));
  const std::map<std::string, ScaleModel> scales{{"bradley-terry", ScaleModel::bradley_terry},
                                                 {"thurstone", ScaleModel::thurstone}};
  command
      ->add_option_function<std::string>(
          "--scale", [args, scales](const std::string& name) { args->scale = scales.at(name); },
          "Scale of three methods and more: bradley-terry or thurstone [bradley-terry]")
      ->type_name("S")
      ->check(CLI::IsMember(scales));
  command->add_flag("--no-figures", args->no_figures, "Do without figures (and without gnuplot)");
  const CLI::Option* resamples = command->get_option("--bootstrap");
  command->callback([args, guess, resamples] {
    args->read.columns = column_map(args->mapped);
    if (args->separator != "tab" && args->separator.size() != 1) {
      throw CLI::ValidationError("--separator", "must be one character or `tab`");
    }
    args->read.separator = args->separator == "tab" ? '\t' : args->separator[0];
    if (args->read.pinch_value == args->read.cable_value) {
      throw CLI::ValidationError("--pinch-value", "must differ from --cable-value");
    }
    for (const std::string& label : {args->read.pinch_value, args->read.cable_value}) {
      const std::string why = why_not_a_name(label);
      if (!why.empty())
        throw CLI::ValidationError("--pinch-value, --cable-value", "bad name: " + why);
    }
    args->analyse.pinch_label = args->read.pinch_value;
    args->analyse.cable_label = args->read.cable_value;
    if (std::any_of(args->inputs.begin(), args->inputs.end(),
                    [&](const auto& input) { return has_levels(input, args->read); })) {
      const LevelsTable levels = read_levels(args->inputs, args->read);
      args->model.guess = rate_of("--guess",
                                  guess->count() > 0 ? args->guess
                                  : levels.correct   ? "0.5"
                                                     : "0",
                                  0.9, 0.5);
      args->model.lapse = rate_of("--lapse", args->lapse, 0.5, 0.1);
      // A resample fits every participant again; 399 are enough for percentiles.
      const ThresholdReport report = analyse_thresholds(
          levels, args->model,
          {args->analyse.alpha, resamples->count() > 0 ? args->analyse.bootstrap : 399,
           args->analyse.seed});
      const std::vector<std::string> written =
          write_threshold_report(report, levels, args->out, !args->no_figures);
      fmt::print("{}\n\nWritten to {}: {}\n", threshold_words(report, levels), args->out.string(),
                 fmt::join(written, ", "));
      return;
    }
    if (std::any_of(args->inputs.begin(), args->inputs.end(),
                    [&](const auto& input) { return has_comparisons(input, args->read); })) {
      const ComparisonsTable comparisons = read_comparisons(args->inputs, args->read);
      const ScaleReport report = analyse_scale(
          comparisons,
          {args->analyse.alpha, args->analyse.bootstrap, args->analyse.seed, args->scale});
      const std::vector<std::string> written =
          write_scale_report(report, comparisons, args->out, !args->no_figures);
      fmt::print("{}\n\nWritten to {}: {}\n", scale_words(report, comparisons), args->out.string(),
                 fmt::join(written, ", "));
      return;
    }
    const AnswersTable table = read_answers(args->inputs, args->read);
    const Report report = analyse_table(table, args->analyse);
    const std::vector<std::string> written =
        write_report(report, table, args->out, !args->no_figures);
    fmt::print("{}\n\nWritten to {}: {}\n", plain_words(report, table), args->out.string(),
               fmt::join(written, ", "));
  });
}

void add_power(CLI::App& app) {
  auto question = std::make_shared<PowerQuestion>();
  CLI::App* command =
      app.add_subcommand("power", "How many participants a study needs for the test that is read");
  command->footer(
      "  pinchlab power --share 0.75                         one answer a participant\n"
      "  pinchlab power --share 0.6 --trials 8 --icc 0.1     eight answers a participant that "
      "resemble each other\n"
      "An earlier study's report.json names its intraclass correlation under `pooled`.");
  command->add_option("--share", question->share, "True share of answers for one method, 0 to 1")
      ->required();
  command->add_option("--alpha", question->alpha, "Significance level, two-sided")
      ->capture_default_str();
  command->add_option("--power", question->power, "Probability of finding the difference")
      ->capture_default_str();
  command->add_option("--trials", question->trials, "Answers of one participant")
      ->capture_default_str();
  command
      ->add_option("--icc", question->icc,
                   "Intraclass correlation of one participant's answers, 0 to 1")
      ->capture_default_str();
  command->callback([question] {
    try {
      fmt::print("{}", power_text(*question, participants_needed(*question)));
    } catch (const InputError& error) {
      throw CLI::ValidationError(error.what());  // all of its input stands on the command line
    }
  });
}

void add_stopping(CLI::App& app) {
  auto question = std::make_shared<StoppingQuestion>();
  CLI::App* command = app.add_subcommand(
      "stopping", "When may a study that is looked at several times be stopped?");
  command->footer(
      "Choose a rule before the first participant, and keep to it: the bounds hold for the looks "
      "that are named here.\n\n"
      "  pinchlab stopping --participants 16,32,48,64 --share 0.65 --trials 8 --icc 0.1\n"
      "  pinchlab stopping --participants 20,40,80 --share 0.7 --rule bayes-factor");
  const std::map<std::string, StoppingRule> rules{{"fixed", StoppingRule::fixed},
                                                  {"obrien-fleming", StoppingRule::obrien_fleming},
                                                  {"pocock", StoppingRule::pocock},
                                                  {"bayes-factor", StoppingRule::bayes_factor}};
  command->add_option("--participants", question->participants, "At each look: 16,32,48")
      ->type_name("N,N,...")
      ->delimiter(',')
      ->required();
  command
      ->add_option_function<std::string>(
          "--rule", [question, rules](const std::string& name) { question->rule = rules.at(name); },
          "fixed, obrien-fleming, pocock (Lan and DeMets' spending) or bayes-factor "
          "[obrien-fleming]")
      ->check(CLI::IsMember(rules));
  command->add_option("--bayes-factor", question->bayes_factor, "Stop from it on, and from 1 / it")
      ->capture_default_str();
  command->add_option("--share", question->truth.share, "True share to try it with, 0 to 1")
      ->required();
  command->add_option("--alpha", question->truth.alpha, "Significance level, two-sided")
      ->capture_default_str();
  command->add_option("--trials", question->truth.trials, "Answers of one participant")
      ->capture_default_str();
  command
      ->add_option("--icc", question->truth.icc,
                   "Intraclass correlation of one participant's answers, 0 to 1")
      ->capture_default_str();
  command->callback([question] {
    try {
      constexpr int studies = 4000;
      fmt::print("{}", stopping_text(*question, stopping_rule(*question, studies, 1)));
    } catch (const InputError& error) {
      throw CLI::ValidationError(error.what());  // all of its input stands on the command line
    }
  });
}

}  // namespace

void add_commands(CLI::App& app) {
  add_analyse(app);
  add_power(app);
  add_stopping(app);
}

}  // namespace pinchlab::analysis
