// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/freeze_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <stdexcept>

#include "base/number_option.h"
#include "base/strict_json.h"
#include "study/command_options.h"
#include "study/freeze.h"
#include "study/utc.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_file = 1U << 20U;  // bytes

struct Options {
  fs::path clips, answers, config, stopping, rules, pilot, out;
  std::uint64_t seed = 0;
  std::int64_t participants = 0;
  bool has_seed = false, no_webm = false;
};

constexpr const char* footer =
    "Fixes what is asked and shown (by hash), plan and seed, sample size, exclusions and analysis, "
    "before\nthe first participant, and writes a preregistration text with their figures. `study "
    "serve` then serves\nnothing else from this --answers, and `analyse` says whether the design "
    "was followed. Register the\ntext: its hash shows later that nothing was changed.\n\n"
    "Examples:\n"
    "  pinchlab stopping --participants 16,32,48 --share 0.65 --trials 8 --icc 0.1 --json "
    "rule.json\n"
    "  pinchlab study freeze --clips clips --answers answers --stopping rule.json --rules "
    "rules.json "
    "\\\n"
    "      --out preregistration\n"
    "  pinchlab study serve --clips clips --answers answers\n"
    "  pinchlab analyse answers --out report";

void run(const Options& options, const Stimuli& stimuli) {
  FreezeOptions design;
  design.config = read_or_default(options.config);
  design.answers = options.answers;
  if (options.has_seed) design.seed = options.seed;
  if (options.stopping.empty()) {
    design.sample.looks = {options.participants};
  } else {
    design.sample =
        parse_stopping(read_json_file(options.stopping, largest_file), options.stopping.string());
  }
  const AnswersKind kind = kind_of(design.config);
  design.rules.analysis = usual_analysis(kind);
  if (!options.rules.empty()) {
    design.rules =
        parse_rules(read_json_file(options.rules, largest_file), options.rules.string(), kind);
  }
  // Clips may take minutes: what is wrong with the files above has been told.
  design.clips = prepare(design.config, stimuli, options.clips, options.no_webm);
  check_sample(design);
  check_rules(design);
  design.pilot = options.pilot;
  design.out = options.out;
  design.utc = utc_now();
  const std::string hash = freeze(design);
  fmt::print("{}: register this text\n{}: the design\nSHA-256 {}\n",
             (options.out / "preregistration.md").string(), (options.out / "design.json").string(),
             hash);
}

}  // namespace

void add_freeze(CLI::App& study, const Stimuli& stimuli) {
  auto options = std::make_shared<Options>();
  CLI::App* command = study.add_subcommand(
      "freeze", "Fix a study's design before the first participant, and write its preregistration");
  add_clips(*command, options->clips);
  add_answers(*command, options->answers);
  command->add_option("--out", options->out, "Folder for preregistration.md and design.json")
      ->type_name("DIR")
      ->required();
  CLI::Option_group* size = command->add_option_group("sample size");
  size->add_option("--participants", options->participants, "How many are analysed, looked at once")
      ->type_name("N")
      ->check(whole_in(1, 100000));
  size->add_option("--stopping", options->stopping, "Rule that `pinchlab stopping --json` wrote")
      ->type_name("FILE.json");
  size->require_option(1);
  command
      ->add_option("--rules", options->rules,
                   "Hypotheses, exclusions, analysis; study/README.md has the keys [no hypotheses, "
                   "nobody is left out, the usual analysis]")
      ->type_name("rules.json");
  command
      ->add_option("--pilot", options->pilot, "Folder of the answers of a pilot that went before")
      ->type_name("DIR")
      ->check(CLI::ExistingDirectory);
  add_seed(*command, options->seed, "Seed of the plan [the answers folder's, or a random one]");
  add_config(*command, options->config);
  add_no_webm(*command, options->no_webm);
  command->footer(footer);
  command->callback([options, command, stimuli] {
    options->has_seed = command->count("--seed") > 0;
    run(*options, stimuli);
  });
}

}  // namespace pinchlab::study
