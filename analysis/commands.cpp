// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/commands.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "analysis/analyse_command.h"
#include "analysis/power.h"
#include "analysis/sequential.h"
#include "base/input_error.h"
#include "base/number_option.h"
#include "base/output_file.h"
#include "base/text_checks.h"

namespace pinchlab::analysis {
namespace {

// What a study is simulated from.
void add_truth(CLI::App& command, PowerQuestion& truth, const char* share) {
  command.add_option("--share", truth.share, share)->required()->check(number());
  command.add_option("--alpha", truth.alpha, "Significance level, two-sided")
      ->capture_default_str()
      ->check(number());
  command.add_option("--trials", truth.trials, "Answers of one participant")
      ->capture_default_str()
      ->check(whole_in(1, 1000));
  command
      .add_option("--icc", truth.icc,
                  "Intraclass correlation of one participant's answers, 0 to 1; for an estimate "
                  "below 0 give 0, for one above 1 give 1")
      ->capture_default_str()
      ->check(number());
}

std::vector<std::int64_t> looks_of(const std::string& text) {
  std::vector<std::int64_t> looks;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const auto count = parse_whole(text.substr(begin, end - begin), 1, 10000);
    if (!count) {
      throw CLI::ValidationError(
          "--participants",
          text + " is not one whole number of 1 to 10000, or several with commas between");
    }
    looks.push_back(*count);
    begin = end + 1;
  }
  return looks;
}

// Who gives an option that nothing reads expects something of it.
void refuse_idle_correlation(const CLI::App& command, const PowerQuestion& truth) {
  if (command.count("--icc") > 0 && truth.trials == 1) {
    throw CLI::ValidationError(
        "--icc", "is about several answers of one participant; give --trials too, or leave it out");
  }
}

void refuse_idle_options(const CLI::App& command, const StoppingQuestion& question) {
  refuse_idle_correlation(command, question.truth);
  const bool is_bayes = question.rule == StoppingRule::bayes_factor;
  if (command.count("--bayes-factor") > 0 && !is_bayes) {
    throw CLI::ValidationError("--bayes-factor", "goes with --rule bayes-factor");
  }
  if (command.count("--alpha") > 0 && is_bayes) {
    throw CLI::ValidationError(
        "--alpha",
        "has no effect on --rule bayes-factor, which stops by --bayes-factor; leave it "
        "out");
  }
  if (question.rule == StoppingRule::fixed && question.participants.size() > 1) {
    throw CLI::ValidationError("--participants",
                               "--rule fixed looks once, at the last; name that number alone");
  }
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
  add_truth(*command, *question, "True share of answers for one method, above 0 and below 1");
  command->add_option("--power", question->power, "Probability of finding the difference")
      ->capture_default_str()
      ->check(number());
  command->callback([question, command] {
    refuse_idle_correlation(*command, *question);
    try {
      print_result(power_text(*question, participants_needed(*question)));
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
      "  pinchlab stopping --participants 20,40,80 --share 0.7 --rule bayes-factor\n"
      "  pinchlab stopping --participants 16,32,48 --share 0.65 --trials 8 --icc 0.1 --json "
      "rule.json");
  const std::map<std::string, StoppingRule> rules{{"fixed", StoppingRule::fixed},
                                                  {"obrien-fleming", StoppingRule::obrien_fleming},
                                                  {"pocock", StoppingRule::pocock},
                                                  {"bayes-factor", StoppingRule::bayes_factor}};
  command
      ->add_option_function<std::vector<std::string>>(
          "--participants",
          [question](const std::vector<std::string>& looks) {
            question->participants = looks_of(fmt::format("{}", fmt::join(looks, ",")));
          },
          "At each look: 16,32,48")
      ->type_name("N,N,...")
      ->required();
  command
      ->add_option_function<std::string>(
          "--rule", [question, rules](const std::string& name) { question->rule = rules.at(name); },
          "fixed, obrien-fleming, pocock (Lan and DeMets' spending) or bayes-factor "
          "[obrien-fleming]")
      ->check(CLI::IsMember(rules));
  command->add_option("--bayes-factor", question->bayes_factor, "Stop from it on, and from 1 / it")
      ->capture_default_str()
      ->check(number());
  add_truth(*command, question->truth, "True share to try it with, above 0 and below 1");
  auto json = std::make_shared<std::filesystem::path>();
  command
      ->add_option("--json", *json,
                   "File to write the rule to, for `pinchlab study freeze --stopping`; - is "
                   "standard output, instead of the table")
      ->type_name("FILE.json");
  command->callback([question, command, json] {
    refuse_idle_options(*command, *question);
    try {
      if (!json->empty()) check_can_be_written(*json);
      constexpr int studies = 4000;
      const StoppingAnswer answer = stopping_rule(*question, studies, 1);
      if (*json != "-") print_result(stopping_text(*question, answer));
      if (!json->empty()) write_result(*json, stopping_json(*question, answer));
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
