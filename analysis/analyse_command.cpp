// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/analyse_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "analysis/csv_columns.h"
#include "analysis/csv_inputs.h"
#include "analysis/design_check.h"
#include "analysis/report.h"
#include "analysis/scale_report.h"
#include "analysis/threshold_report.h"
#include "base/did_you_mean.h"
#include "base/number_option.h"
#include "base/rates.h"
#include "base/text_checks.h"

namespace pinchlab::analysis {
namespace {

const std::map<std::string, Shape> shapes{
    {"logistic", Shape::logistic}, {"normal", Shape::normal}, {"weibull", Shape::weibull}};
const std::map<std::string, ScaleModel> scales{{"bradley-terry", ScaleModel::bradley_terry},
                                               {"thurstone", ScaleModel::thurstone}};

// A resample of thresholds fits every participant again; 399 are enough for percentiles.
constexpr int threshold_resamples = 399;

struct Arguments {
  std::vector<std::filesystem::path> inputs;
  std::filesystem::path out, design_file;
  std::vector<std::string> mapped;
  std::string separator = ",";
  bool no_figures = false;
  ReadOptions read;
  AnalysisOptions analyse;
  double threshold_at = 0.5;
  std::string function = "logistic", scale = "bradley-terry";
  std::string guess = "0.5 of correct answers, 0 of choices", lapse = "free";
  CLI::App* command = nullptr;
  std::optional<Design> design;

  [[nodiscard]] bool is_given(const char* flag) const { return command->count(flag) > 0; }
};

// "ours=theirs" pairs of --map-column, each for a column of ours.
std::map<std::string, std::string> column_map(const std::vector<std::string>& pairs) {
  const std::vector<std::string> known = input_columns();
  std::map<std::string, std::string> columns;
  for (const std::string& pair : pairs) {
    const size_t equals = pair.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == pair.size()) {
      throw CLI::ValidationError("--map-column",
                                 fmt::format("`{}` is not of the form OURS=THEIRS", pair));
    }
    const std::string ours = pair.substr(0, equals);
    if (std::ranges::find(known, ours) == known.end()) {
      throw CLI::ValidationError("--map-column",
                                 fmt::format("we have no column `{}`{}; ours are `{}`", ours,
                                             did_you_mean(ours, known), fmt::join(known, "`, `")));
    }
    const std::string theirs = pair.substr(equals + 1);
    if (std::ranges::any_of(columns, [&](const auto& other) { return other.second == theirs; })) {
      throw CLI::ValidationError("--map-column", fmt::format("`{}` is mapped to twice", theirs));
    }
    if (!columns.emplace(ours, theirs).second) {
      throw CLI::ValidationError("--map-column", fmt::format("column `{}` is mapped twice", ours));
    }
  }
  return columns;
}

// "free", or a rate from 0 to `most_fixed`; a free one is estimated up to `most_free`.
Rate rate_of(const char* flag, const std::string& text, double most_fixed, double most_free) {
  if (text == "free") return {true, 0.0, most_free};
  const auto value = parse_number(text);
  if (!value || !(*value >= 0.0 && *value <= most_fixed)) {
    throw CLI::ValidationError(
        flag, fmt::format("`{}` is neither `free` nor a number from 0 to {}", text, most_fixed));
  }
  return {false, *value, most_free};
}

/// What rate_of takes.
CLI::Validator rate_up_to(double most) {
  return {[most](const std::string& text) {
            if (text == "free") return std::string();
            if (number_in(0.0, most)(text).empty()) return std::string();
            return fmt::format("{} is neither `free` nor a number from 0 to {}", text, most);
          },
          ""};
}

constexpr std::uint64_t largest_seed = (1ULL << 53U) - 1;  // that JSON keeps exactly

constexpr const char* footer =
    "Answers come as files or folders of the study page (.json), as tidy CSV with the columns\n"
    "participant, demonstration, choice and, if known, group, side, position, reaction_time_s, "
    "kind,\n"
    "preference (-3, left by far, to 3; 0 with the choice `tie`), pilot (true: of a trial run, "
    "never\nanalysed with others), as `study export --csv` writes it,\n"
    "or as a CSV table of counts with the columns demonstration, pinch, cable.\n"
    "With a column `level` (graded stimuli) and `correct` (0 or 1; a count beside `trials`) or "
    "`choice`\n"
    "psychometric functions are fitted: thresholds and slopes with intervals.\n"
    "With the columns `left`, `right` and `choice` (or `left_wins`, `right_wins`, `ties`) "
    "methods "
    "are put on\none scale (Bradley and Terry's, or Thurstone's case V).\n"
    "Answers in a folder that `pinchlab study freeze` prepared are analysed as its design says, "
    "who its\nrules leave out is left out, and the report says whether the design was followed.\n"
    "Written to --out: report.html, report.md, report.json, tables.tex (LaTeX), CSV tables, "
    "figures "
    "as SVG and PDF.\n\n"
    "  pinchlab analyse answers/ --out report\n"
    "  pinchlab analyse analysis/data/thesis-table-5.3.csv --out report\n"
    "  pinchlab analyse other.csv --map-column participant=subject --map-column "
    "demonstration=scene \\\n"
    "      --map-column choice=picked --pinch-value ours --cable-value theirs --out report\n"
    "  pinchlab analyse squeeze.csv --function weibull --guess 0.5 --out report\n"
    "  pinchlab analyse analysis/data/citations.csv --scale thurstone --out report";

void add_input_options(CLI::App& command, Arguments& args) {
  command.add_option("answers", args.inputs, "Answer files (.json), folders of them, CSV files")
      ->required();
  command.add_option("--out", args.out, "Folder to write the report to (made if need be)")
      ->required();
  command
      .add_option("--design", args.design_file,
                  "Frozen design to hold the answers against [the folder's own, if there is one]")
      ->type_name("design.json");
  command.add_option(
      "--groups", args.read.groups_file,
      "CSV demonstration,group: what is analysed together (default: a column `group`, or names "
      "that begin with 1 to 6: clipping, 7 and 8: friction)");
  command.add_option("--exclude", args.read.exclude_file,
                     "CSV participant,reason: who is left out; the report names them");
  command
      .add_option("--repetitions", args.read.repetitions,
                  "Answers that each participant gives to each demonstration (CSV)")
      ->capture_default_str()
      ->check(whole_in(1, 100));
  command.add_flag("--allow-missing", args.read.allow_missing,
                   "Accept participants with answers missing");
}

void add_column_options(CLI::App& command, Arguments& args) {
  command
      .add_option("--map-column", args.mapped,
                  "OURS=THEIRS: the name that a column has in the CSV files")
      ->allow_extra_args(false);
  command
      .add_option(
          "--pinch-value", args.read.pinch_value,
          "What column `choice` says for the method under test; also its name in the report")
      ->capture_default_str();
  command
      .add_option("--cable-value", args.read.cable_value,
                  "The same for the method it is compared with")
      ->capture_default_str();
  command.add_option("--separator", args.separator, "Character between CSV columns, or `tab`")
      ->capture_default_str();
  command.add_flag("--ignore-other-columns", args.read.ignore_other_columns,
                   "Accept CSV columns that are not known");
}

void add_statistics_options(CLI::App& command, Arguments& args) {
  command.add_option("--alpha", args.analyse.alpha, "Significance level")
      ->capture_default_str()
      ->check(number_in(1e-6, 0.5));
  command.add_option("--bootstrap", args.analyse.bootstrap, "Resamples of the cluster bootstrap")
      ->capture_default_str()
      ->check(whole_in(99, 1000000));
  command.add_option("--seed", args.analyse.seed, "Seed of all random numbers")
      ->capture_default_str()
      ->check(whole_in(0, largest_seed));
  command
      .add_option("--function", args.function,
                  "Psychometric function of graded stimuli: logistic, normal or weibull")
      ->type_name("F")
      ->capture_default_str()
      ->check(CLI::IsMember(shapes));
  command
      .add_option(
          "--guess", args.guess,
          fmt::format("Rate of hits by guessing, 0 to {:g}, or `free`: estimated up to {:g}",
                      most_fixed_guess, most_free_guess))
      ->capture_default_str()
      ->check(rate_up_to(most_fixed_guess));
  command
      .add_option(
          "--lapse", args.lapse,
          fmt::format("Rate of misses by inattention, 0 to {:g}, or `free`: estimated up to {:g}",
                      most_fixed_lapse, most_free_lapse))
      ->capture_default_str()
      ->check(rate_up_to(most_fixed_lapse));
  command
      .add_option("--threshold-at", args.threshold_at,
                  "Share of the function's height at the threshold")
      ->capture_default_str()
      ->check(number_in(0.01, 0.99));
  command
      .add_option("--scale", args.scale,
                  "Scale of three methods and more: bradley-terry or thurstone")
      ->type_name("S")
      ->capture_default_str()
      ->check(CLI::IsMember(scales));
  command.add_flag("--no-figures", args.no_figures, "Do without figures (and without gnuplot)");
}

void check_columns(Arguments& args) {
  args.read.columns = column_map(args.mapped);
  if (args.separator != "tab" && args.separator.size() != 1) {
    throw CLI::ValidationError("--separator", "must be one character or `tab`");
  }
  args.read.separator = args.separator == "tab" ? '\t' : args.separator[0];
  if (args.read.pinch_value == args.read.cable_value) {
    throw CLI::ValidationError("--pinch-value", "must differ from --cable-value");
  }
  for (const std::string& label : {args.read.pinch_value, args.read.cable_value}) {
    const std::string why = why_not_a_name(label);
    if (!why.empty())
      throw CLI::ValidationError("--pinch-value, --cable-value", "bad name: " + why);
  }
  args.analyse.pinch_label = args.read.pinch_value;
  args.analyse.cable_label = args.read.cable_value;
}

// What the command line does not say, the design does.
void take_design(Arguments& args) {
  args.design = design_of(args.inputs, args.design_file);
  if (!args.design) return;
  args.read.by_rule = exclusions_by_rule(*args.design, args.inputs);
  const auto frozen = [&](const char* flag, const char* key, const auto& take) {
    const auto found = args.design->rules.analysis.find(key);
    if (found != args.design->rules.analysis.end() && !args.is_given(flag)) take(found->second);
  };
  frozen("--alpha", "alpha", [&](const std::string& v) { args.analyse.alpha = *parse_number(v); });
  frozen("--bootstrap", "bootstrap",
         [&](const std::string& v) { args.analyse.bootstrap = std::stoi(v); });
  frozen("--seed", "seed", [&](const std::string& v) { args.analyse.seed = std::stoull(v); });
  frozen("--function", "function", [&](const std::string& v) { args.function = v; });
  frozen("--guess", "guess", [&](const std::string& v) { args.guess = v; });
  frozen("--lapse", "lapse", [&](const std::string& v) { args.lapse = v; });
  frozen("--threshold-at", "threshold_at",
         [&](const std::string& v) { args.threshold_at = *parse_number(v); });
  frozen("--scale", "scale", [&](const std::string& v) { args.scale = v; });
}

// A rate as a design holds it.
std::string text_of(const Rate& rate) {
  return rate.free ? "free" : fmt::format("{}", rate.value);
}

// What every kind of analysis tells the check of the design.
UsedAnalysis used_of(const Arguments& args, const std::vector<Exclusion>& exclusions) {
  UsedAnalysis used;
  used.options = {{"alpha", fmt::format("{}", args.analyse.alpha)},
                  {"bootstrap", std::to_string(args.analyse.bootstrap)},
                  {"seed", std::to_string(args.analyse.seed)}};
  used.exclusions = exclusions;
  return used;
}

template <class Table>
void hold_against_design(const Arguments& args, const UsedAnalysis& used, Table& table) {
  if (args.design) table.design = check_design(*args.design, args.inputs, used);
}

void tell(const Arguments& args, const std::string& words,
          const std::vector<std::string>& written) {
  fmt::print("{}\n\nWritten to {}: {}\n", words, args.out.string(), fmt::join(written, ", "));
}

void analyse_levels(Arguments& args) {
  LevelsTable levels = read_levels(args.inputs, args.read);
  const bool has_guess = args.is_given("--guess") || args.design;
  PsychometricModel model;
  model.shape = shapes.at(args.function);
  model.threshold_at = args.threshold_at;
  model.guess = rate_of("--guess",
                        has_guess        ? args.guess
                        : levels.correct ? "0.5"
                                         : "0",
                        most_fixed_guess, most_free_guess);
  model.lapse = rate_of("--lapse", args.lapse, most_fixed_lapse, most_free_lapse);
  const auto fixed = [](const Rate& rate) {
    return rate.free ? std::nullopt : std::optional(rate.value);
  };
  const std::string why = why_no_room(fixed(model.guess), fixed(model.lapse));
  if (!why.empty()) throw CLI::ValidationError("--guess, --lapse", why);
  if (!args.is_given("--bootstrap") && !args.design) args.analyse.bootstrap = threshold_resamples;
  const ThresholdReport report = analyse_thresholds(
      levels, model, {args.analyse.alpha, args.analyse.bootstrap, args.analyse.seed});
  UsedAnalysis used = used_of(args, levels.exclusions);
  used.options.insert({{"function", args.function},
                       {"guess", text_of(model.guess)},
                       {"lapse", text_of(model.lapse)},
                       {"threshold_at", fmt::format("{}", args.threshold_at)}});
  hold_against_design(args, used, levels);
  const std::vector<std::string> written =
      write_threshold_report(report, levels, args.out, !args.no_figures);
  tell(args, threshold_words(report, levels), written);
}

void analyse_comparisons(const Arguments& args) {
  ComparisonsTable comparisons = read_comparisons(args.inputs, args.read);
  const ScaleReport report = analyse_scale(comparisons, {args.analyse.alpha, args.analyse.bootstrap,
                                                         args.analyse.seed, scales.at(args.scale)});
  UsedAnalysis used = used_of(args, comparisons.exclusions);
  used.options["scale"] = args.scale;
  hold_against_design(args, used, comparisons);
  const std::vector<std::string> written =
      write_scale_report(report, comparisons, args.out, !args.no_figures);
  tell(args, scale_words(report, comparisons), written);
}

void analyse_two_methods(const Arguments& args) {
  AnswersTable table = read_answers(args.inputs, args.read);
  const Report report = analyse_table(table, args.analyse);
  UsedAnalysis used = used_of(args, table.exclusions);
  const Estimate& p = report.all().row.read.p;
  if (p) used.p = p.value;
  used.log_bayes_factor = report.all().row.log_bayes_factor;
  hold_against_design(args, used, table);
  const std::vector<std::string> written = write_report(report, table, args.out, !args.no_figures);
  tell(args, plain_words(report, table), written);
}

enum class Kind { levels, comparisons, two_methods };

/// Answers that options may be about.
struct Given {
  Kind kind = Kind::two_methods;
  bool csv = false;     // some inputs are tables
  bool single = false;  // some of these hold single answers of two methods, not counts
  bool files = false;   // some inputs are answer files
};

Given given_inputs(const Arguments& args) {
  const auto is_any = [&](const auto& has) {
    return std::ranges::any_of(args.inputs,
                               [&](const auto& input) { return has(input, args.read); });
  };
  const auto is_csv = [](const std::filesystem::path& input, const ReadOptions&) {
    return input.extension() == ".csv" || input.extension() == ".tsv";
  };
  Given given;
  given.kind = is_any(has_levels)        ? Kind::levels
               : is_any(has_comparisons) ? Kind::comparisons
                                         : Kind::two_methods;
  given.csv = is_any(is_csv);
  given.files = is_any([&](const auto& input, const auto& read) { return !is_csv(input, read); });
  given.single =
      given.kind == Kind::two_methods && is_any([&](const auto& input, const auto& read) {
        return is_csv(input, read) && !has_counts(input, read);
      });
  return given;
}

/// Throws for options that nothing here reads: who gives them expects something of them.
void refuse_idle_options(const Arguments& args, const Given& given) {
  struct Rule {
    const char* flag;
    bool is_read;
    const char* of_what;
  };
  const bool levels = given.kind == Kind::levels, comparisons = given.kind == Kind::comparisons;
  const bool two_methods = given.kind == Kind::two_methods;
  const char* const of_levels = "psychometric functions (a column `level`)";
  const char* const of_names = "the names of two methods";
  const char* const of_csv = "CSV files";
  const Rule rules[] = {
      {"--function", levels, of_levels},
      {"--guess", levels, of_levels},
      {"--lapse", levels, of_levels},
      {"--threshold-at", levels, of_levels},
      {"--scale", comparisons, "comparisons of several methods (columns `left` and `right`)"},
      {"--groups", two_methods, "answers about two methods"},
      {"--repetitions", given.single, "single answers about two methods in CSV files"},
      {"--allow-missing", given.single || given.files, "single answers of participants"},
      {"--pinch-value", two_methods || (levels && given.csv), of_names},
      {"--cable-value", two_methods || (levels && given.csv), of_names},
      {"--map-column", given.csv, of_csv},
      {"--separator", given.csv, of_csv},
      {"--ignore-other-columns", given.csv, of_csv},
  };
  for (const Rule& rule : rules) {
    if (rule.is_read || !args.is_given(rule.flag)) continue;
    throw CLI::ValidationError(
        rule.flag, fmt::format("is about {}, which are not what is analysed here; leave it out",
                               rule.of_what));
  }
}

void run(Arguments& args) {
  check_columns(args);
  const Given given = given_inputs(args);
  refuse_idle_options(args, given);
  check_mapped_columns(args.inputs, args.read);
  take_design(args);
  if (given.kind == Kind::levels) return analyse_levels(args);
  if (given.kind == Kind::comparisons) return analyse_comparisons(args);
  analyse_two_methods(args);
}

}  // namespace

void add_analyse(CLI::App& app) {
  auto args = std::make_shared<Arguments>();
  args->command =
      app.add_subcommand("analyse", "Statistics and a report from the answers of a study");
  args->command->footer(footer);
  add_input_options(*args->command, *args);
  add_column_options(*args->command, *args);
  add_statistics_options(*args->command, *args);
  args->command->callback([args] { run(*args); });
}

}  // namespace pinchlab::analysis
