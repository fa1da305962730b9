// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a sweep is to make: from template, table and options to the stimuli and their names. Pure,
// but for the reading of two files.

#include <deque>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "demos/batch.h"
#include "demos/scenes/parameter_table.h"

namespace pinchlab {

/// Which rows one process of several makes: every `count`-th from the `number`-th on, from 1.
struct Shard {
  int number = 1, count = 1;
};

/// "3/7". Throws std::invalid_argument.
Shard shard_from(const std::string& text);

/// Columns that need no placeholder: they choose how a row's scene is simulated.
inline const std::vector<std::string> sweep_columns = {"method", "sweeps"};

/// A sweep as its files describe it.
struct Sweep {
  SceneTemplate scene;
  ParameterTable table;
};

/// `table` is one CSV file, or ranges. Throws InputError or std::invalid_argument.
Sweep read_sweep(const std::filesystem::path& scene, const std::vector<std::string>& table);

/// One stimulus: all that its files depend on.
struct Stimulus {
  std::size_t row = 0;  // the first that asks for it
  std::string name;     // of its files, without endings
  nlohmann::ordered_json parameters, settings;
  std::string filled;  // the scene as JSON
  SceneFile source;
  ClipPlan plan;
};

struct Stimuli {
  std::deque<Stimulus> list;             // each once, in the table's order; a plan points into it
  std::vector<std::string> name_of_row;  // of the shard's rows; "" for the others
};

/// The stimuli of a shard's rows. Throws InputError with the row's place where one cannot be.
///
/// A name is the template's and 16 digits of the SHA-256 of the filled scene, the parameters, the
/// settings and the program's version.
Stimuli stimuli_of(const Sweep& sweep, const BatchOptions& render, const Shard& shard);

}  // namespace pinchlab
