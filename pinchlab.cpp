// SPDX-License-Identifier: GPL-3.0-or-later
// The front door: reads the command line and calls one function a command.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "analysis/input_error.h"
#include "analysis/power.h"
#include "analysis/report.h"
#include "analysis/text_checks.h"

using namespace pinchlab;

// "ours=theirs" pairs of --map-column, each for a column of ours.
static std::map<std::string, std::string> column_map(const std::vector<std::string>& pairs) {
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

static void add_analyse(CLI::App& app) {
  struct Arguments {
    std::vector<std::filesystem::path> inputs;
    std::filesystem::path out;
    std::vector<std::string> mapped;
    std::string separator = ",";
    bool no_figures = false;
    ReadOptions read;
    AnalysisOptions analysis;
  };
  auto args = std::make_shared<Arguments>();
  CLI::App* command =
      app.add_subcommand("analyse", "Statistics and a report from the answers of a study");
  command->footer(
      "Answers come as files or folders of the study page (.json), as tidy CSV with the columns\n"
      "participant, demonstration, choice and, if known, group, side, position, reaction_time_s, "
      "kind,\n"
      "or as a CSV table of counts with the columns demonstration, pinch, cable.\n"
      "Written to --out: report.html, report.md, report.json, CSV tables, figures as SVG and "
      "PDF.\n\n"
      "  pinchlab analyse answers/ --out report\n"
      "  pinchlab analyse analysis/data/thesis-table-5.3.csv --out report\n"
      "  pinchlab analyse other.csv --map-column participant=subject --map-column "
      "demonstration=scene \\\n"
      "      --map-column choice=picked --pinch-value ours --cable-value theirs --out report");
  command->add_option("answers", args->inputs, "Answer files (.json), folders of them, CSV files")
      ->required();
  command->add_option("--out", args->out, "Folder to write the report to (made if need be)")
      ->required();
  command->add_option("--alpha", args->analysis.alpha, "Significance level")
      ->capture_default_str()
      ->check(CLI::Range(1e-6, 0.5));
  command->add_option("--bootstrap", args->analysis.bootstrap, "Resamples of the cluster bootstrap")
      ->capture_default_str()
      ->check(CLI::Range(99, 1000000));
  command->add_option("--seed", args->analysis.seed, "Seed of all random numbers")
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
  command->add_flag("--no-figures", args->no_figures, "Do without figures (and without gnuplot)");
  command->callback([args] {
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
    args->analysis.pinch_label = args->read.pinch_value;
    args->analysis.cable_label = args->read.cable_value;
    const AnswersTable table = read_answers(args->inputs, args->read);
    const Report report = analyse_table(table, args->analysis);
    const std::vector<std::string> written =
        write_report(report, table, args->out, !args->no_figures);
    fmt::print("{}\n\nWritten to {}: {}\n", plain_words(report, table), args->out.string(),
               fmt::join(written, ", "));
  });
}

static void add_power(CLI::App& app) {
  auto question = std::make_shared<PowerQuestion>();
  CLI::App* command =
      app.add_subcommand("power", "How many participants a study needs (exact binomial)");
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

int main(int argc, char** argv) {
  CLI::App app{"Pinchlab: 2D cable simulation, paired videos and a perception study"};
  app.set_version_flag("--version", PINCHLAB_VERSION);
  app.require_subcommand(1);
  add_analyse(app);
  add_power(app);
  // Exit codes: 0 fine, 1 failed, 2 bad usage.
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "pinchlab: {}\n", error.what());
    return 1;
  }
  return 0;
}
