// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/sweep_plan.h"

#include <fmt/format.h>

#include <cstdio>
#include <set>
#include <stdexcept>

#include "base/input_error.h"
#include "base/sha256.h"
#include "base/text_checks.h"
#include "demos/clip.h"

namespace pinchlab {
namespace {

using nlohmann::ordered_json;

constexpr int most_shards = 1'000'000, most_sweeps = 100'000;

ordered_json parameters_of(const ParameterTable& table, std::size_t row) {
  ordered_json parameters = ordered_json::object();
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    parameters[table.columns[c]] = value_of_cell(table.rows[row][c]);
  }
  return parameters;
}

/// What `method` stands for, with the row's number of sweeps.
Configuration configuration_of(const Sweep& sweep, std::size_t row, const Scene& scene,
                               const std::string& method) {
  Configuration configuration = method_of(scene, method);
  const std::string* sweeps = sweep.table.cell(row, "sweeps");
  if (sweeps == nullptr) return configuration;
  const auto count = parse_whole(*sweeps, 1, most_sweeps);
  if (!count) {
    throw std::invalid_argument(
        fmt::format("sweeps must be a whole number of 1 to {}, not {}", most_sweeps, *sweeps));
  }
  if (configuration.solver != Solver::iterative) {
    throw std::invalid_argument(
        "the column sweeps has an effect with the method thesis only; leave it out, or give the "
        "row this method");
  }
  configuration.iterations = static_cast<int>(*count);
  return configuration;
}

ClipPlan plan_of(const Sweep& sweep, std::size_t row, const SceneFile& source,
                 BatchOptions options) {
  const std::string* column = sweep.table.cell(row, "method");
  options.method = column ? *column : options.method.value_or("pinch");
  options.report = false;  // made beside the clip
  ClipPlan plan = plan_clips(source, options).front();
  plan.methods = {configuration_of(sweep, row, source.scene, *options.method)};
  return plan;
}

Stimulus stimulus_of(const Sweep& sweep, const BatchOptions& render, std::size_t row) {
  Stimulus stimulus;
  stimulus.row = row;
  stimulus.filled = fill(sweep.scene, sweep.table, row).dump(1) + "\n";
  try {
    stimulus.source = parse_scene(stimulus.filled, sweep.scene.path, render.timing);
    stimulus.plan = plan_of(sweep, row, stimulus.source, render);
  } catch (const std::exception& error) {
    throw InputError(sweep.table.place(row), error.what());
  }
  stimulus.parameters = parameters_of(sweep.table, row);
  stimulus.settings = plan_entry(stimulus.plan);
  for (const char* not_a_setting : {"file", "scene", "title", "methods"}) {
    stimulus.settings.erase(not_a_setting);
  }
  stimulus.settings["solver_sweeps"] = stimulus.plan.methods[0].iterations;
  stimulus.settings["report"] = render.report;
  const ordered_json known = {{"parameters", stimulus.parameters}, {"settings", stimulus.settings}};
  stimulus.name = fmt::format("{}-{}", sweep.scene.path.stem().string(),
                              sha256(known.dump() + stimulus.filled).substr(0, 16));
  stimulus.plan.file = stimulus.name + file_ending(render.codec);
  return stimulus;
}

}  // namespace

Shard shard_from(const std::string& text) {
  Shard shard;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%7d/%7d%c", &shard.number, &shard.count, &rest) != 2 ||
      shard.number < 1 || shard.number > shard.count || shard.count > most_shards) {
    throw std::invalid_argument(
        fmt::format("--shard: {} is not I/N with I from 1 to N, such as 3/7", text));
  }
  return shard;
}

Sweep read_sweep(const std::filesystem::path& scene, const std::vector<std::string>& table) {
  const bool ranges = table.front().find('=') != std::string::npos;
  if (!ranges && table.size() > 1) {
    throw std::invalid_argument("give one CSV file, or ranges such as squeeze=0:1:5");
  }
  Sweep sweep{read_template(scene),
              ranges ? table_of_ranges(table) : read_parameter_table(table.front())};
  check_columns(sweep.scene, sweep.table, sweep_columns);
  const std::string name = scene.filename().string();
  if (name == "manifest.json" || name == "ro-crate-metadata.json") {
    throw std::invalid_argument(name +
                                " is what the set's own file is called; rename the template");
  }
  return sweep;
}

Stimuli stimuli_of(const Sweep& sweep, const BatchOptions& render, const Shard& shard) {
  Stimuli stimuli;
  std::set<std::string> names;
  const auto count = static_cast<std::size_t>(shard.count);
  for (std::size_t row = 0; row < sweep.table.rows.size(); ++row) {
    stimuli.name_of_row.emplace_back();
    if (row % count + 1 != static_cast<std::size_t>(shard.number)) continue;
    Stimulus stimulus = stimulus_of(sweep, render, row);
    stimuli.name_of_row.back() = stimulus.name;
    if (!names.insert(stimulus.name).second) continue;
    stimuli.list.push_back(std::move(stimulus));
    stimuli.list.back().plan.source = &stimuli.list.back().source;
  }
  return stimuli;
}

}  // namespace pinchlab
