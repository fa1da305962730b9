// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "analysis/answers_table.h"
#include "analysis/levels_table.h"
#include "base/design_file.h"
#include "base/input_error.h"
#include "demos/scenes/parameter_table.h"
#include "demos/scenes/scene_json.h"
#include "demos/scenes/theme.h"
#include "study/config.h"
#include "study/jatos.h"
#include "study/truth.h"
#include "tests/fuzz/targets.h"

namespace pinchlab::fuzz {
namespace {

namespace fs = std::filesystem;

fs::path source(const char* name) {
  return fs::path(PINCHLAB_SOURCE_DIR) / "tests" / "fuzz" / name;
}

/// A table that was read must be one: indices in range, counts that are those of the answers.
void check(const analysis::AnswersTable& table) {
  std::vector<analysis::Counts> counts(table.demonstrations.size());
  for (const analysis::Answer& answer : table.answers) {
    if (answer.demonstration >= counts.size() || answer.participant >= table.participants.size()) {
      throw Finding("an answer of nobody, or to nothing");
    }
    ++(answer.chose_pinch ? counts[answer.demonstration].pinch
                          : counts[answer.demonstration].cable);
  }
  if (table.counts.size() != counts.size()) throw Finding("counts of what is not there");
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const analysis::Counts& told = table.counts[i];
    if (told.pinch < 0 || told.cable < 0) throw Finding("a negative count");
    const bool same = told.pinch == counts[i].pinch && told.cable == counts[i].cable;
    if (!table.answers.empty() && !same) throw Finding("counts that are not the answers'");
  }
  for (const analysis::Group& group : table.groups) {
    for (const std::uint16_t demonstration : group.demonstrations) {
      if (demonstration >= counts.size()) throw Finding("a group of what is not there");
    }
  }
}

/// Whether `read` takes the file; if it refuses it, it must name it.
template <typename Read>
bool is_used(const fs::path& path, Read read) {
  try {
    read();
    return true;
  } catch (const InputError& error) {
    must_name(error, path.string());
    return false;
  }
}

bool read_table(const fs::path& path) {
  analysis::ReadOptions options;
  options.allow_missing = true;
  return is_used(path, [&] { check(analysis::read_answers({path}, options)); });
}

/// Counts at each level, as threshold studies give them.
bool read_levels(const fs::path& path) {
  return is_used(path, [&] {
    const analysis::LevelsTable table = analysis::read_levels({path}, {});
    if (table.series.empty()) throw Finding("a table without series");
  });
}

/// Imports into a folder that is empty before.
bool import(const fs::path& results, const fs::path& key) {
  const fs::path answers = scratch_folder() / "answers";
  fs::remove_all(answers);
  try {
    const study::Imported imported = study::import_jatos({results}, key, answers);
    if (imported.added == 0) return false;
    // What was taken must be readable.
    if (!read_table(answers)) throw Finding("imported answers that are none");
    return true;
  } catch (const std::runtime_error& error) {
    const std::string_view what = error.what();
    if (!what.starts_with(key.string())) must_name(error, results.string());
    return false;
  }
}

}  // namespace

bool fuzz_answers(std::string_view bytes) {
  return read_table(file_with(bytes, "answers.json"));
}

bool fuzz_counts(std::string_view bytes) {
  const fs::path path = file_with(bytes, "counts.csv");
  bool has_levels = false;
  if (!is_used(path, [&] { has_levels = analysis::has_levels(path, {}); })) return false;
  return has_levels ? read_levels(path) : read_table(path);
}

bool fuzz_study_config(std::string_view bytes) {
  const fs::path path = file_with(bytes, "study.json");
  return is_used(path, [&] {
    const study::Config config = study::read_config(path);
    if (config.texts.empty()) throw Finding("a study without texts");
    if (!config.demonstrations.empty()) study::make_plan(1, 0, study::plan_options(config));
  });
}

bool fuzz_theme(std::string_view bytes) {
  const fs::path path = file_with(bytes, "theme.json");
  try {
    read_theme_file(path);
    return true;
  } catch (const SceneFileError& error) {
    must_name(error, path.string());
    return false;
  }
}

bool fuzz_truth(std::string_view bytes) {
  const fs::path path = file_with(bytes, "truth.json");
  return is_used(path, [&] { study::read_truth(path); });
}

// With its own hash nothing that was changed would come past the first door.
bool fuzz_design(std::string_view bytes) {
  nlohmann::json document = nlohmann::json::parse(bytes, nullptr, false);
  const bool whole = document.is_object();
  if (whole) document["sha256"] = design_hash(document);
  const fs::path path = file_with(whole ? document.dump() : std::string(bytes), "design.json");
  return is_used(path, [&] {
    const Design design = read_design(path);
    if (!whole || design.sha256 != document["sha256"]) throw Finding("a hash that is another's");
  });
}

bool fuzz_sweep(std::string_view bytes) {
  constexpr std::size_t most = 20;  // of its rows
  const fs::path path = file_with(bytes, "table.csv");
  const SceneTemplate scene = read_template(source("sweep.template.json"));
  try {
    const ParameterTable table = read_parameter_table(path);
    check_columns(scene, table, {});
    bool any = false;
    for (std::size_t row = 0; row < std::min(table.rows.size(), most); ++row) {
      try {
        parse_scene(fill(scene, table, row).dump(), "00-row.json");
        any = true;
      } catch (const SceneFileError& error) {
        must_name(error, "00-row.json");
      }
    }
    return any;
  } catch (const InputError& error) {
    const std::string_view what = error.what();
    if (!what.starts_with(scene.path.string())) must_name(error, path.string());
    return false;
  }
}

bool fuzz_jatos(std::string_view bytes) {
  return import(file_with(bytes, "results.txt"), source("jatos.key.json"));
}

bool fuzz_jatos_key(std::string_view bytes) {
  const fs::path key = file_with(bytes, "key.json");
  return import(source("jatos.results.txt"), key);
}

}  // namespace pinchlab::fuzz
