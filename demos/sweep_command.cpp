// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/sweep_command.h"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <regex>

#include "demos/command_line.h"
#include "demos/sweep.h"

namespace pinchlab {
namespace {

void add_publication(CLI::App& command, Publication& publication) {
  command.add_option("--title", publication.title, "Name of the set, for ro-crate-metadata.json")
      ->type_name("TEXT");
  CLI::Option* author =
      command.add_option("--author", publication.author, "Who made it, for the same");
  author->type_name("NAME");
  command.add_option("--orcid", publication.orcid, "https://orcid.org/... of the author")
      ->type_name("URL")
      ->needs(author)
      ->check([](const std::string& url) -> std::string {
        static const std::regex orcid(R"(https://orcid\.org/(\d{4}-){3}\d{3}[\dX])");
        return std::regex_match(url, orcid) ? ""
                                            : url + " is not https://orcid.org/ and its digits";
      });
  command
      .add_option("--licence", publication.licence,
                  "What others may do with it: https://spdx.org/licenses/CC-BY-4.0")
      ->type_name("URL")
      ->check([](const std::string& url) -> std::string {
        static const std::regex web(R"(https?://[!-~]+[^/])");
        return std::regex_match(url, web) ? "" : url + " is no web address";
      });
  command
      .add_option("--date", publication.date,
                  "Day of publication [that of SOURCE_DATE_EPOCH, or today]")
      ->type_name("YYYY-MM-DD")
      ->check([](const std::string& day) -> std::string {
        static const std::regex form(R"((\d{4})-(\d\d)-(\d\d))");
        std::smatch part;
        const bool has_form = std::regex_match(day, part, form);
        const auto number = [&part](std::size_t i) { return std::stoi(part[i].str()); };
        const bool is_day = has_form && (std::chrono::year(number(1)) / number(2) / number(3)).ok();
        return is_day ? "" : day + " is no day as YYYY-MM-DD";
      });
}

void add_rendering(CLI::App& command, BatchOptions& render, Size& size, bool& burn_time) {
  add_method(
      command, render.method,
      "pinch, pinch_no_contact, cable, baseline (the scene's own) or thesis, where the table "
      "has no column called method [pinch]");
  add_size(command, size, "Pixels of a clip [960x960]");
  command
      .add_option("--fps", render.timing.frames_per_second,
                  "Frames a second [the scene's]; the steps get no longer than the scene's")
      ->type_name("N")
      ->check(whole_in(1, 1000));
  command
      .add_option_function<std::string>(
          "--codec", [&render](const std::string& name) { render.codec = codec_from_string(name); },
          "h264 (MP4), vp9 (WebM) or ffv1 (Matroska, lossless) [h264]")
      ->type_name("C")
      ->check(CLI::IsMember({"h264", "vp9", "ffv1"}));
  command
      .add_option_function<std::string>(
          "--theme", [&render](const std::string& file) { render.theme = read_theme_file(file); },
          "Colours and line widths: a file as in demos/themes [the default]")
      ->type_name("FILE");
  command.add_flag("--burn-time", burn_time, "Write the time into a corner of each picture");
  command.add_flag(
      "--report", render.report,
      "Also how each row's scene differs from its baseline, and when, in figures and a "
      "strip of pictures");
  add_simulation_limit(command, render.time_limit, "a row's");
  command.add_option("--jobs", render.jobs, "Rows made at a time [one a core]")
      ->type_name("N")
      ->check(whole_in(1, 1024));
}

void add_sweep(CLI::App& app) {
  auto options = std::make_shared<SweepOptions>();
  options->render.out.clear();
  auto size = std::make_shared<Size>(Size{options->render.width, options->render.height});
  CLI::App* command = app.add_subcommand(
      "sweep", "A set of stimuli: a scene with placeholders, a table of values, a clip a row");
  command
      ->add_option("template", options->scene,
                   "Scene in which texts such as \"${squeeze}\" "
                   "stand for values")
      ->type_name("TEMPLATE")
      ->required();
  command
      ->add_option(
          "table", options->table,
          "CSV file, its first line the placeholders' names; or ranges: squeeze=0:1:5 (five "
          "values from 0 to 1), width=0.02,0.05; of several ranges all combinations")
      ->type_name("TABLE")
      ->required();
  command->add_option("--out", options->render.out, "Folder for the files, made if missing")
      ->type_name("DIR")
      ->required();
  CLI::Option* shard = command->add_option_function<std::string>(
      "--shard", [options](const std::string& text) { options->shard = shard_from(text); },
      "Make only every N-th row from the I-th on, for one of N processes; then --merge");
  shard->type_name("I/N");
  command
      ->add_flag("--merge", options->merge,
                 "Make nothing; where all rows are there, write stimuli.csv, manifest.json and "
                 "ro-crate-metadata.json (without --shard done in the end anyway)")
      ->excludes(shard);
  add_rendering(*command, options->render, *size, options->render.burn_time);
  add_publication(*command, options->publication);
  command->footer(
      "Each row gives NAME.mp4, NAME.csv (its motion) and NAME.json (parameters, settings, hashes, "
      "promises);\n"
      "NAME ends in a hash of scene, parameters, settings and version. What is there is kept. The "
      "same rows\n"
      "give the same bytes, for any shards, order, machines and --jobs. Columns called method and "
      "sweeps (of\n"
      "the method thesis) need no placeholder. demos/sweep/ has a scene, and how to use a "
      "cluster.\n\n"
      "Examples:\n"
      "  pinchlab sweep demos/sweep/drop.json squeeze=0:1:5 mass=1 height=0.9 --out graded\n"
      "  pinchlab sweep demos/sweep/drop.json demos/sweep/grid.csv --out set --shard 3/7\n"
      "  pinchlab sweep demos/sweep/drop.json demos/sweep/grid.csv --out set --merge --author 'A "
      "Name'");
  command->callback([options, size] {
    options->render.width = size->width;
    options->render.height = size->height;
    if (options->publication.date.empty()) options->publication.date = day_of_publication();
    if (run_sweep(*options) > 0) throw CLI::RuntimeError(1);
  });
}

void add_crate(CLI::App& app) {
  auto folder = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand(
      "crate", "Check a published set of stimuli against its ro-crate-metadata.json");
  command->add_option("folder", *folder, "The set's folder")->type_name("DIR")->required();
  command->footer(
      "Rules of RO-Crate 1.1 and of the Process Run Crate 0.4, and every file's size and SHA-256.\n"
      "Prints what is wrong; exit code 1 if anything is.\n\n"
      "Examples:\n"
      "  pinchlab crate set");
  command->callback([folder] {
    const std::vector<std::string> problems = problems_of_crate(*folder);
    for (const std::string& problem : problems) fmt::print("{}/{}\n", *folder, problem);
    if (!problems.empty()) throw CLI::RuntimeError(1);
    fmt::print(stderr, "{}: nothing is wrong\n", *folder);
  });
}

}  // namespace

void add_sweep_commands(CLI::App& app) {
  add_sweep(app);
  add_crate(app);
}

}  // namespace pinchlab
