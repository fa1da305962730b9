// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <thread>

#include "base/counted.h"
#include "base/csv.h"
#include "base/output_file.h"
#include "base/partial_file.h"
#include "base/progress.h"
#include "base/read_file.h"
#include "base/sha256.h"
#include "base/unfinished_folder.h"
#include "demos/clip.h"
#include "demos/legibility.h"
#include "demos/manifest.h"
#include "demos/pair_report.h"
#include "demos/scenes/trajectory.h"
#include "demos/worker_pool.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* format_name = "pinchlab stimulus 1";

ordered_json file_entry(const fs::path& folder, const std::string& name) {
  return {{"file", name}, {"sha256", sha256_of_file(folder / name)}};
}

void write_file(const fs::path& path, const std::string& text) {
  OutputFile out(path);
  out.write(text);
  out.finish();
}

/// The clip's entry in the manifest.
ordered_json clip_entry(const Stimulus& stimulus, const ordered_json& made) {
  ordered_json entry = made;
  entry["methods"] = {stimulus.plan.role};  // as the row calls it
  entry["parameters"] = stimulus.parameters;
  if (stimulus.parameters.contains("sweeps")) {
    entry["solver_sweeps"] = stimulus.plan.methods[0].iterations;
  }
  return entry;
}

/// Makes all files of a stimulus and puts them into the folder, the one that vouches for the others
/// last.
void make_stimulus(const Stimulus& stimulus, const BatchOptions& render) {
  const UnfinishedFolder row(render.out);
  const auto no_tick = [] {};
  std::vector<std::string> files = {stimulus.plan.file, stimulus.name + ".csv"};
  ordered_json record = {{"format", format_name},
                         {"parameters", stimulus.parameters},
                         {"settings", stimulus.settings}};
  record["clip"] =
      clip_entry(stimulus, make_clip(stimulus.plan, row.path(), no_tick, render.time_limit));

  TrajectoryOptions motion;
  motion.configuration = stimulus.plan.methods[0];
  motion.timing = render.timing;
  motion.time_limit = render.time_limit;
  motion.out = row.path() / files[1];
  motion.quiet = true;
  write_trajectory(stimulus.source, motion);
  record["motion"] = file_entry(row.path(), files[1]);

  if (render.report) {
    files.push_back(stimulus.name + ".png");
    const std::string strip = (row.path() / files.back()).string();
    record["report"] = to_json(report_pair(stimulus.source, stimulus.plan.scene, render.width,
                                           render.height, strip, no_tick, render.time_limit));
    record["strip"] = file_entry(row.path(), files.back());
  }
  record["scene"] = ordered_json::parse(stimulus.filled);
  files.push_back(stimulus.name + ".json");
  write_file(row.path() / files.back(), record.dump(1) + "\n");
  for (const std::string& file : files) row.keep(file);
}

/// The record of a stimulus that is there, each of its files with the bytes that it had; or null.
ordered_json record_of(const Stimulus& stimulus, const fs::path& folder) {
  const fs::path path = folder / (stimulus.name + ".json");
  if (!fs::is_regular_file(path)) return nullptr;
  ordered_json record = ordered_json::parse(read_whole(path), nullptr, /*allow_exceptions=*/false);
  if (!record.is_object() || record.value("format", ordered_json()) != format_name ||
      record.value("settings", ordered_json()) != stimulus.settings) {
    return nullptr;
  }
  const auto is_there = [&](const char* what, const std::string& name) {
    const ordered_json entry = record.value(what, ordered_json());
    return entry.is_object() && entry.value("file", ordered_json()) == name &&
           fs::is_regular_file(folder / name) &&
           entry.value("sha256", ordered_json()) == sha256_of_file(folder / name);
  };
  const bool whole = is_there("clip", stimulus.plan.file) &&
                     is_there("motion", stimulus.name + ".csv") &&
                     (!record.contains("report") || is_there("strip", stimulus.name + ".png"));
  return whole ? record : nullptr;
}

struct Outcome {
  int signal = 0, made = 0, failed = 0;
};

Outcome make_all(const Sweep& sweep, const std::vector<const Stimulus*>& stimuli,
                 const BatchOptions& render) {
  std::vector<Work> work;
  work.reserve(stimuli.size());
  for (const Stimulus* stimulus : stimuli) {
    work.emplace_back([stimulus, &render](const std::function<void()>&) {
      make_stimulus(*stimulus, render);
      return std::string();
    });
  }
  Outcome outcome;
  Progress progress("sweep", "stimuli", static_cast<std::int64_t>(stimuli.size()));
  const WorkerPoolEvents events = {.tick = [](std::size_t) {},
                                   .done =
                                       [&](std::size_t, const std::string&) {
                                         progress.add(1);
                                         ++outcome.made;
                                       },
                                   .failed =
                                       [&](std::size_t i, const std::string& error) {
                                         progress.clear();
                                         fmt::print(stderr, "{}: not made: {}\n",
                                                    sweep.table.place(stimuli[i]->row),
                                                    failure_of_row(error));
                                         ++outcome.failed;
                                       },
                                   .idle = [&] { progress.add(0); }};
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  outcome.signal = run_in_processes(work, render.jobs > 0 ? render.jobs : cores, events);
  return outcome;
}

/// The table, with the names of each row's files, and how the pair differs where that is known.
std::string stimuli_table(const Sweep& sweep, const Stimuli& stimuli,
                          const std::map<std::string, ordered_json>& records) {
  std::string text;
  for (const std::string& column : sweep.table.columns) text += column + ",";
  const bool report = records.begin()->second.contains("report");
  text += report ? "clip_file,motion_file,record_file,first_difference_s,largest_distance_px\n"
                 : "clip_file,motion_file,record_file\n";
  for (std::size_t row = 0; row < sweep.table.rows.size(); ++row) {
    const std::string& name = stimuli.name_of_row[row];
    const ordered_json& record = records.at(name);
    for (const std::string& cell : sweep.table.rows[row]) text += csv_cell(cell) + ",";
    text += fmt::format("{},{}.csv,{}.json", record["clip"]["file"].get<std::string>(), name, name);
    if (report) {
      const ordered_json& first = record["report"]["first_difference_s"];
      text += fmt::format(",{},{}", first.is_null() ? "" : first.dump(),
                          record["report"]["largest_distance_px"].dump());
    }
    text += "\n";
  }
  return text;
}

const char* media_type(Codec codec) {
  switch (codec) {
    case Codec::h264:
      return "video/mp4";
    case Codec::vp9:
      return "video/webm";
    case Codec::ffv1:
      return "video/x-matroska";
    default:
      return "image/*";  // previews
  }
}

std::string in_words(const Stimulus& stimulus) {
  const VideoSettings& video = stimulus.plan.video;
  std::string parameters;
  for (const auto& [name, value] : stimulus.parameters.items()) {
    parameters += fmt::format("{}{}={}", parameters.empty() ? "" : ", ", name, value.dump());
  }
  return fmt::format(
      "pinchlab sweep: {}; method {}, {}x{} pixels, {} frames a second, {} steps a "
      "frame",
      parameters, stimulus.plan.role, video.width, video.height, video.frames_per_second,
      stimulus.plan.scene.steps_per_frame);
}

void merge(const Sweep& sweep, const Stimuli& stimuli, const SweepOptions& options) {
  const fs::path& out = options.render.out;
  if (!fs::is_directory(out)) {
    throw std::runtime_error(out.string() +
                             ": there is no such folder; make the stimuli first, by the same "
                             "command without --merge");
  }
  UnfinishedFolder::remove_left_over(out);
  std::map<std::string, ordered_json> records;
  std::vector<const Stimulus*> missing;
  for (const Stimulus& stimulus : stimuli.list) {
    ordered_json record = record_of(stimulus, out);
    if (record.is_null()) {
      missing.push_back(&stimulus);
    } else {
      records.emplace(stimulus.name, std::move(record));
    }
  }
  if (!missing.empty()) {
    throw std::runtime_error(fmt::format(
        "{}: {} of {} stimuli are missing, the first for {}; make them by the same command without "
        "--merge (the same options and the same version of the program give the same names)",
        out.string(), missing.size(), stimuli.list.size(),
        sweep.table.place(missing.front()->row)));
  }
  Manifest manifest;
  Crate crate{.publication = options.publication};
  const std::string scene = sweep.scene.path.filename().string();
  crate.inputs = {{scene, "application/json", "Scene with placeholders"},
                  {"parameters.csv", "text/csv", "Values for the placeholders, a row a stimulus"}};
  crate.others = {
      {"stimuli.csv", "text/csv", "The values and the files of each row"},
      {"manifest.json", "application/json", "What each clip shows and how it was made"}};
  for (const Stimulus& stimulus : stimuli.list) {
    const ordered_json& record = records.at(stimulus.name);
    put(manifest, record["clip"]);
    CrateRun run{stimulus.name, in_words(stimulus), stimulus.parameters, {}};
    run.results = {
        {stimulus.plan.file, media_type(stimulus.plan.video.codec), "Clip"},
        {stimulus.name + ".csv", "text/csv", "Motion of every body, a row a frame"},
        {stimulus.name + ".json", "application/json", "Parameters, settings and hashes"}};
    if (record.contains("strip")) {
      run.results.push_back(
          {stimulus.name + ".png", "image/png", "The pair of clips and their difference"});
    }
    crate.runs.push_back(std::move(run));
  }
  write_file(out / scene, sweep.scene.text);
  write_file(out / "parameters.csv", to_csv(sweep.table));
  write_file(out / "stimuli.csv", stimuli_table(sweep, stimuli, records));
  write_manifest(out, manifest);
  write_crate(out, crate);
}

/// Clips of other values, which stimuli.csv and the crate do not have any more.
void tell_of_others(const Stimuli& stimuli, const fs::path& out) {
  if (stimuli.list.empty()) return;
  std::set<fs::path> own;
  for (const Stimulus& stimulus : stimuli.list) own.insert(stimulus.plan.file);
  const fs::path ending = own.begin()->extension();
  std::set<fs::path> others;
  for (const fs::directory_entry& entry : fs::directory_iterator(out)) {
    const fs::path name = entry.path().filename();
    if (name.extension() == ending && !own.contains(name)) others.insert(name);
  }
  if (others.empty()) return;
  fmt::print(
      stderr,
      "{}: note: {} of other values {} there, {} the first, and {} not in stimuli.csv nor in "
      "the crate; sweep one table of all values, or each into a folder of its own\n",
      out.string(), counted(others.size(), "clip"), others.size() == 1 ? "is" : "are",
      others.begin()->string(), others.size() == 1 ? "is" : "are");
}

void tell_notes(const Stimuli& stimuli, const fs::path& out) {
  for (const Stimulus& stimulus : stimuli.list) {
    const ordered_json record = record_of(stimulus, out);
    if (record.is_null()) continue;
    const std::string path = (out / stimulus.plan.file).string();
    const ordered_json& clip = record["clip"];
    if (clip.contains("hard_to_see")) tell_hard_to_see(path, clip["hard_to_see"]);
    if (clip.contains("broken_promises")) tell_broken_promises(path, clip["broken_promises"]);
  }
}

}  // namespace

std::string failure_of_row(const std::string& error) {
  const std::size_t command = error.find("; to see it again: ");
  if (command == std::string::npos) return error;
  return error.substr(0, command) + "; to see it again, sweep a table that holds this row alone";
}

int run_sweep(const SweepOptions& options) {
  const Sweep sweep = read_sweep(options.scene, options.table);
  const fs::path& out = options.render.out;
  const Stimuli stimuli = stimuli_of(sweep, options.render, options.shard.value_or(Shard{}));
  if (options.merge) {
    merge(sweep, stimuli, options);
    fmt::print(stderr, "{}: {} stimuli merged\n", out.string(), stimuli.list.size());
    return 0;
  }
  make_folders(out);
  std::vector<const Stimulus*> to_make;
  for (const Stimulus& stimulus : stimuli.list) {
    if (record_of(stimulus, out).is_null()) to_make.push_back(&stimulus);
  }
  const Outcome outcome = make_all(sweep, to_make, options.render);
  if (outcome.signal != 0) {
    UnfinishedFolder::remove_left_over(out);
    end_by(outcome.signal);
  }
  tell_notes(stimuli, out);
  fmt::print(stderr, "{}: {} made, {} there already, {} failed\n", out.string(), outcome.made,
             stimuli.list.size() - to_make.size(), outcome.failed);
  if (!options.shard && outcome.failed == 0) {
    merge(sweep, stimuli, options);
    tell_of_others(stimuli, out);
  }
  return outcome.failed;
}

}  // namespace pinchlab
