// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Sets of stimuli: a scene with placeholders and a table of values give a clip, a table of its
// motion and a record a row, and in the end a research crate (research_crate.h).

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "demos/research_crate.h"
#include "demos/sweep_plan.h"

namespace pinchlab {

struct SweepOptions {
  std::filesystem::path scene;     ///< with placeholders
  std::vector<std::string> table;  ///< a CSV file, or ranges
  BatchOptions render;             ///< out, method, size, timing, codec, theme, jobs, report
  std::optional<Shard> shard;      ///< nothing: all rows, then merge
  bool merge = false;              ///< make nothing, only merge
  Publication publication;         ///< what the crate says of people
};

/// Makes what is missing of the shard's rows and keeps the rest. Row by row, the folder gets
///
///   NAME.mp4      the clip,
///   NAME.csv      its motion (trajectory.h),
///   NAME.png      with render.report: a strip of the pair,
///   NAME.json     last: parameters, settings, the scene as it was filled, hashes of the others,
///                 promises that were not kept, and with render.report how the pair differs,
///
/// where NAME is the stimulus' (sweep_plan.h): the same row has the same name and the same bytes in
/// any shard, order and number of jobs, and rows that are alike are made once. Any number of
/// processes, on any machines, may work in one folder.
///
/// Without a shard it then merges: where all rows are there, it writes
///
///   stimuli.csv            the table with the names of each row's files,
///   parameters.csv, and the template under its own name: what went in,
///   manifest.json          as of a batch, for all clips,
///   ro-crate-metadata.json
///
/// and removes what dead processes have left. Returns the number of rows that failed; throws
/// InputError or std::invalid_argument for what cannot be, before anything is made, and
/// std::runtime_error, with the cure, where rows to merge are missing.
int run_sweep(const SweepOptions& options);

/// What is told of a row that failed: a scene with placeholders can be given to no other command.
std::string failure_of_row(const std::string& error);

}  // namespace pinchlab
