// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/commands.h"

#include <fmt/format.h>
#include <pthread.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>

#include "base/answer_file.h"
#include "base/counted.h"
#include "base/design_file.h"
#include "base/durable_file.h"
#include "base/number_option.h"
#include "base/output_file.h"
#include "base/progress.h"
#include "study/answers.h"
#include "study/command_options.h"
#include "study/config.h"
#include "study/crate.h"
#include "study/desk.h"
#include "study/freeze_command.h"
#include "study/http.h"
#include "study/jatos.h"
#include "study/server.h"
#include "study/simulate.h"
#include "study/study_file.h"
#include "study/tables.h"
#include "study/utc.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;

struct ServeOptions {
  fs::path clips, answers, config;
  ServerOptions server{.host = "127.0.0.1", .port = 8080, .names = {}, .limits = {}};
  int participants = 0;
  int release_after = 24 * 60;  // min
  std::uint64_t seed = 0;
  bool has_seed = false, no_webm = false, pilot = false;
};

// Ctrl-C ends the server; everything that was confirmed is on the disk already.
class StopOnSignal {
 public:
  explicit StopOnSignal(Server& server) {
    sigemptyset(&signals_);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      sigaddset(&signals_, signal);
    }
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);  // in every thread that is begun from here on
    waiter_ = std::thread([this, &server] {
      int signal = 0;
      sigwait(&signals_, &signal);
      server.stop();
    });
  }
  ~StopOnSignal() {
    // The waiter has SIGTERM blocked and takes it by sigwait.
    ::pthread_kill(waiter_.native_handle(), SIGTERM);  // NOLINT(bugprone-bad-signal-to-kill-thread)
    waiter_.join();
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

 private:
  sigset_t signals_{};
  std::thread waiter_;
};

void tell(const std::string& line) {
  fmt::print("{} {}\n", utc_now().substr(11, 8), line);
  std::fflush(stdout);
}

void serve(const ServeOptions& options, const Stimuli& stimuli) {
  DeskOptions desk_options;
  desk_options.config = read_or_default(options.config);
  Config& config = desk_options.config;
  if (options.participants > 0) config.participant_limit = options.participants;
  if (config.one_time_links && config.participant_limit == 0) {
    throw std::invalid_argument(
        "one-time links need to know for how many: give --participants, or participant_limit in "
        "the configuration");
  }
  config.is_pilot = options.pilot;
  check_address(options.server.host, options.server.port);
  check_answers_folder(options.answers);  // before clips, which may take minutes
  desk_options.clips = prepare(config, stimuli, options.clips, options.no_webm);
  desk_options.answers = options.answers;
  if (options.has_seed) {
    desk_options.seed = options.seed;
  }
  desk_options.longest_idle = std::chrono::minutes(options.release_after);
  desk_options.tell = tell;

  Desk desk(std::move(desk_options));
  Server server(desk, options.server);
  const StopOnSignal stop(server);
  if (options.pilot) {
    fmt::print("This is a pilot: its answers are marked, and are never analysed with others\n");
  }
  if (fs::exists(design_path(options.answers))) {
    fmt::print("Frozen design      {}\n", read_design(design_path(options.answers)).sha256);
  }
  fmt::print("Participants open  {}/\nYou can watch at   {}/researcher#{}\n", server.address(),
             server.address(), server.researcher_token());
  fmt::print("Seed {}; {}; answers go to {}; Ctrl-C ends\n", desk.seed(),
             counted(make_plan(desk.seed(), 0, plan_options(desk.config())).size(), "trial"),
             options.answers.string());
  for (const std::string& link : desk.links()) {
    fmt::print("One-time link      {}/?link={}\n", server.address(), link);
  }
  const std::size_t running = desk.overview().running.size();
  if (running > 0) {
    fmt::print("{} running before the last stop can go on\n", running);
  }
  std::fflush(stdout);
  server.run();
  const Overview end = desk.overview();
  fmt::print("Stopped: {} finished, {} running can go on at the next start\n", end.finished,
             end.running.size());
}

void add_serve(CLI::App& study, const Stimuli& stimuli) {
  auto options = std::make_shared<ServeOptions>();
  CLI::App* command = study.add_subcommand("serve", "Run the study for participants' browsers");
  add_clips(*command, options->clips);
  add_answers(*command, options->answers);
  command->add_option("--port", options->server.port, "Port to listen on; 0: any that is free")
      ->type_name("N")
      ->capture_default_str()
      ->check(whole_in(0, 65535));
  command
      ->add_option("--host", options->server.host,
                   "Address to listen on; 0.0.0.0: all, for participants on other computers")
      ->type_name("H")
      ->capture_default_str();
  command
      ->add_option("--name", options->server.names,
                   "Name that participants open the study by, if it is not this computer's own: "
                   "study.example.org")
      ->type_name("NAME")
      ->check([](const std::string& name) {
        return is_host_name(name) ? std::string()
                                  : fmt::format(
                                        "{} is no name of a computer: letters, digits, - "
                                        "and dots, without https:// and port",
                                        name);
      });
  command
      ->add_option("--participants", options->participants,
                   "Most that may take part [the configuration's, or no limit]")
      ->type_name("N")
      ->check(whole_in(1, 100000));
  command
      ->add_option("--release-after", options->release_after,
                   "Minutes without a sign of a participant, after which the place goes to another")
      ->type_name("MIN")
      ->capture_default_str()
      ->check(whole_in(1, 60L * 24 * 365));
  add_seed(*command, options->seed, "Seed of the plan [the answers folder's, or a random one]");
  add_config(*command, options->config);
  add_no_webm(*command, options->no_webm);
  command->add_flag("--pilot", options->pilot,
                    "A trial run: answers are marked, and never analysed with those of the study");
  command->footer(
      "Prints the address to open, and who starts, finishes and leaves. Stop it and start it again "
      "as you\nlike: participants go on where they were.\n\n"
      "Examples:\n"
      "  pinchlab study serve --clips clips --answers answers\n"
      "  pinchlab study serve --clips clips --answers answers --participants 16 --seed 7 --config "
      "study.json\n"
      "  pinchlab analyse answers --out report      afterwards");
  command->callback([options, command, stimuli] {
    options->has_seed = command->count("--seed") > 0;
    serve(*options, stimuli);
  });
}

void add_plan(CLI::App& study, const Stimuli& stimuli) {
  struct Options {
    std::uint64_t participants = 0, seed = 0;
    fs::path config, json, csv;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      study.add_subcommand("plan", "Who will see what, in which order and on which side");
  command->add_option("--participants", options->participants, "For how many")
      ->type_name("N")
      ->required()
      ->check(whole_in(1, 100000));
  add_seed(*command, options->seed, "Seed of the plan")->required();
  add_config(*command, options->config);
  command->add_option("--csv", options->csv, "File for one row a trial; - is standard output [-]")
      ->type_name("FILE.csv");
  command->add_option("--json", options->json, "File for the same as JSON; - is standard output")
      ->type_name("FILE.json");
  command->footer(
      "The plan is the one that `study serve` follows with the same seed and configuration.\n\n"
      "Examples:\n"
      "  pinchlab study plan --participants 16 --seed 7\n"
      "  pinchlab study plan --participants 16 --seed 7 --csv plan.csv --json plan.json");
  command->callback([options, stimuli] {
    const fs::path csv = options->csv.empty() && options->json.empty() ? "-" : options->csv;
    if (is_same_file(csv, options->json)) {
      throw std::invalid_argument("--csv and --json must be different files");
    }
    refuse_to_overwrite(options->config, csv, "plan");
    refuse_to_overwrite(options->config, options->json, "plan");
    Config config = read_or_default(options->config);
    if (config.demonstrations.empty()) {
      config.demonstrations = stimuli.demonstrations();
    }
    if (config.demonstrations.empty()) {
      throw std::runtime_error(
          "there is no folder demos here; go to the project's folder, or name the demonstrations "
          "in a configuration");
    }
    const PlanOptions plan = plan_options(config);
    if (!options->json.empty()) {
      write_result(options->json,
                   plan_json(options->seed, options->participants, plan).dump(2) + "\n");
    }
    if (!csv.empty()) {
      write_result(csv, plan_csv(options->seed, options->participants, plan));
    }
  });
}

fs::path existing_folder(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    throw std::runtime_error(folder.string() + ": there is no such folder");
  }
  return folder;
}

// An export of nothing would be taken for one of something.
fs::path folder_with_answers(const fs::path& folder) {
  if (answer_files(existing_folder(folder)).empty()) {
    throw std::runtime_error(folder.string() +
                             ": there is nothing to export; nobody has saved answers here");
  }
  return folder;
}

struct ExportOptions {
  fs::path answers, csv, participants_csv, psych_ds, bids, ro_crate;
  fs::path jatos, clips, config;
  std::uint64_t participants = 0, seed = 0;
  bool has_seed = false, no_webm = false;
};

void export_study(const ExportOptions& options, const Stimuli& stimuli) {
  if (!options.ro_crate.empty() && options.clips.empty()) {
    throw CLI::ValidationError("--ro-crate", "holds the clips too: name their folder with --clips");
  }
  if (!options.clips.empty() && options.ro_crate.empty() && options.jatos.empty()) {
    throw CLI::ValidationError("--clips", "goes with --ro-crate or --jatos");
  }
  if (!options.csv.empty()) {
    write_result(options.csv, answers_csv(folder_with_answers(options.answers)), only_the_user);
  }
  if (!options.participants_csv.empty()) {
    write_result(options.participants_csv, participants_csv(folder_with_answers(options.answers)),
                 only_the_user);
  }
  if (!options.bids.empty()) {
    write_bids(folder_with_answers(options.answers), options.bids);
  }
  if (!options.psych_ds.empty()) {
    write_psych_ds(folder_with_answers(options.answers), options.psych_ds);
  }
  if (!options.ro_crate.empty()) {
    write_ro_crate(folder_with_answers(options.answers), existing_folder(options.clips),
                   options.ro_crate);
  }
  if (!options.jatos.empty()) {
    Config config = read_or_default(options.config);
    refuse_to_overwrite(options.config, options.jatos, "archive");
    check_export(config, options.jatos);
    const Clips clips = prepare(config, stimuli, options.clips, options.no_webm);
    export_jatos(config, clips, options.has_seed ? options.seed : random_seed(),
                 options.participants, options.jatos);
    fmt::print("{}: for JATOS, Import Study\n{}: keep it, `study import` needs it\n",
               options.jatos.string(), key_path(options.jatos).string());
  }
}

void add_export(CLI::App& study, const Stimuli& stimuli) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = study.add_subcommand(
      "export", "Answers for other programs; or the study itself, for a JATOS server");
  CLI::Option* answers =
      command->add_option("--answers", options->answers, "Folder of the answers")->type_name("DIR");
  CLI::Option_group* what = command->add_option_group("what");
  what->add_option("--csv", options->csv, "Tidy table, one row a trial; - is standard output")
      ->type_name("FILE.csv")
      ->needs(answers);
  what->add_option("--participants-csv", options->participants_csv,
                   "Table, one row a participant; - is standard output")
      ->type_name("FILE.csv")
      ->needs(answers);
  what->add_option("--bids", options->bids, "BIDS dataset (behaviour); a new folder")
      ->type_name("DIR")
      ->needs(answers);
  what->add_option("--psych-ds", options->psych_ds, "Psych-DS dataset; a new folder")
      ->type_name("DIR")
      ->needs(answers);
  what->add_option("--ro-crate", options->ro_crate,
                   "Research crate (RO-Crate) with the clips that were shown; a new folder")
      ->type_name("DIR")
      ->needs(answers);
  CLI::Option* jatos =
      what->add_option("--jatos", options->jatos, "Study archive; its key goes to FILE.key.json")
          ->type_name("FILE.jzip");
  what->require_option(1);
  CLI::Option* clips =
      command
          ->add_option(
              "--clips", options->clips,
              "Folder of the clips; for --jatos missing ones of demonstrations are rendered")
          ->type_name("DIR");
  CLI::Option* participants =
      command->add_option("--participants", options->participants, "For how many to plan")
          ->type_name("N")
          ->check(whole_in(1, 10000))
          ->needs(jatos);
  jatos->needs(clips)->needs(participants);
  add_seed(*command, options->seed, "Seed of the plan [a random one]")->needs(jatos);
  add_config(*command, options->config)->needs(jatos);
  add_no_webm(*command, options->no_webm)->needs(jatos);
  command->footer(
      "Examples:\n"
      "  pinchlab study export --answers answers --csv answers.csv\n"
      "  pinchlab study export --answers answers --psych-ds dataset\n"
      "  pinchlab study export --answers answers --ro-crate crate --clips clips\n"
      "  pinchlab study export --jatos study.jzip --clips clips --participants 40");
  command->callback([options, command, stimuli] {
    options->has_seed = command->count("--seed") > 0;
    export_study(*options, stimuli);
  });
}

void add_import(CLI::App& study) {
  struct Options {
    std::vector<fs::path> results;
    fs::path key, answers;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      study.add_subcommand("import", "Answers that were given on a JATOS server, as answer files");
  command
      ->add_option("--jatos", options->results,
                   "Result data from JATOS as text, or folders that hold it as .txt")
      ->type_name("RESULTS")
      ->required();
  command->add_option("--key", options->key, "What `study export --jatos` wrote beside the archive")
      ->type_name("FILE.key.json")
      ->required();
  add_answers(*command, options->answers);
  command->footer(
      "In JATOS: Results, Export Results, Data Only, Plain Text. Who is in the folder already is "
      "not imported\nagain, and refused with other choices. Remove who withdrew in JATOS too, or "
      "the next import brings\nthe answers back.\n\n"
      "Example:\n"
      "  pinchlab study import --jatos results.txt --key study.key.json --answers answers");
  command->callback([options] {
    const Imported imported = import_jatos(options->results, options->key, options->answers);
    fmt::print("{} imported, {} were there already\n", counted(imported.added, "participant"),
               imported.known);
    for (const std::string& note : imported.notes) fmt::print(stderr, "{}\n", note);
  });
}

struct SimulateOptions {
  fs::path clips, answers, config, truth;
  std::uint64_t seed = 1;
  SimulationOptions simulation;
};

void simulate_participants(SimulateOptions& options, const Stimuli& stimuli) {
  DeskOptions desk_options;
  const Truth truth = read_truth(options.truth);
  desk_options.config = read_or_default(options.config);
  desk_options.config.is_pilot = true;
  desk_options.config.simulated_by = truth.sha256;
  desk_options.config.one_time_links = false;
  desk_options.config.recruiting.reset();
  desk_options.config.participant_limit = 0;
  check_answers_folder(options.answers);
  desk_options.clips = prepare(desk_options.config, stimuli, options.clips, true);
  desk_options.answers = options.answers;
  desk_options.seed = options.simulation.seed = options.seed;
  check_truth(desk_options.config, truth);
  Desk desk(std::move(desk_options));
  std::optional<pinchlab::Progress> progress;
  std::mutex mutex;
  options.simulation.begin = [&](int n) { progress.emplace("simulating", "participants", n); };
  options.simulation.progress = [&](int) {
    const std::scoped_lock lock(mutex);
    progress->add(1);
  };
  const int added = simulate(desk, truth, options.simulation);
  progress.reset();
  const auto all = desk.overview().finished;
  const auto before = all - static_cast<std::size_t>(added);
  fmt::print("{}{}; answers in {}\n", counted(all, "simulated participant"),
             before == 0 ? "" : fmt::format(", {} of them from before", before),
             options.answers.string());
}

void add_simulate(CLI::App& study, const Stimuli& stimuli) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = study.add_subcommand(
      "simulate", "Let participants who are not there take part, by a truth that is known");
  command
      ->add_option("--participants", options->simulation.participants, "How many there are to be")
      ->type_name("N")
      ->required()
      ->check(whole_in(1, 10000));
  command->add_option("--truth", options->truth, "How they choose; study/README.md has the keys")
      ->type_name("FILE")
      ->required();
  add_clips(*command, options->clips);
  add_answers(*command, options->answers);
  add_seed(*command, options->seed, "Seed of the plan and of the participants")
      ->capture_default_str();
  add_config(*command, options->config);
  command->footer(
      "They start, see clips, answer and save over HTTP, at full speed, and their answers are "
      "marked as a pilot's.\nThe same seed gives the same answers, and an interrupted simulation "
      "is continued by the next. Try a design,\nits analysis and its report with it before anybody "
      "comes.\n\n"
      "Example:\n"
      "  pinchlab study simulate --participants 40 --truth truth.json --clips clips --answers "
      "simulated\n"
      "  pinchlab analyse simulated --out report");
  command->callback([options, stimuli] { simulate_participants(*options, stimuli); });
}

void add_withdraw(CLI::App& study) {
  struct Options {
    fs::path answers;
    std::string code;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = study.add_subcommand("withdraw", "Remove one participant's answers");
  command->add_option("--answers", options->answers, "Folder of the answers")
      ->type_name("DIR")
      ->required();
  command->add_option("code", options->code, "What the page showed the participant at the end")
      ->type_name("CODE")
      ->required();
  command->footer("Example:\n  pinchlab study withdraw --answers answers 7K3M-9Q2X-0BVA");
  command->callback([options] {
    const auto withdrawn = withdraw(existing_folder(options->answers), options->code);
    if (!withdrawn) {
      throw std::runtime_error(
          fmt::format("{}: no answers have this code; they were removed already, or it belongs to "
                      "another study",
                      options->answers.string()));
    }
    fmt::print("The answers of {} are removed\n", *withdrawn);
  });
}

}  // namespace

void add_commands(CLI::App& app, const Stimuli& stimuli) {
  CLI::App* study =
      app.add_subcommand("study", "Ask people which clip looks most realistic, in a browser")
          ->require_subcommand(1);
  study->footer(
      "Clips of demonstrations that are missing are rendered. study/README.md tells how a study is "
      "run.\n\n"
      "Examples:\n"
      "  pinchlab study plan --participants 16 --seed 7\n"
      "  pinchlab study serve --clips clips --answers answers\n"
      "  pinchlab study export --answers answers --csv answers.csv");
  add_serve(*study, stimuli);
  add_plan(*study, stimuli);
  add_freeze(*study, stimuli);
  add_export(*study, stimuli);
  add_import(*study);
  add_withdraw(*study);
  add_simulate(*study, stimuli);
}

}  // namespace pinchlab::study
