// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/crate.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>

#include "base/answer_file.h"
#include "base/durable_file.h"
#include "base/input_error.h"
#include "base/read_file.h"
#include "base/sha256.h"
#include "study/tables.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using nlohmann::ordered_json;

constexpr const char* process_run = "https://w3id.org/ro/wfrun/process/0.4";

struct Shown {
  std::set<std::string> clips;   // file names
  std::set<std::string> hashes;  // of all that was shown in main trials
  std::string last_day;          // on which answers were saved
};

Shown what_was_shown(const fs::path& answers) {
  Shown shown;
  for (const fs::path& path : answer_files(answers)) {
    const json file = read_answer_json(path);
    shown.last_day = std::max(shown.last_day, file["saved_utc"].get<std::string>().substr(0, 10));
    const json hashes = file.value("clips_sha256", json::object());
    for (const auto& [demonstration, variants] : hashes.items()) {
      for (const auto& [variant, hash] : variants.items()) shown.hashes.insert(hash);
    }
    for (const json& trial : file["trials"]) {
      if (trial["kind"] == "main" && trial.contains("clip")) shown.clips.insert(trial["clip"]);
    }
  }
  return shown;
}

ordered_json reference(const std::string& id) {
  return {{"@id", id}};
}

std::string media_type(const std::string& name) {
  const std::map<std::string, std::string> types = {{".csv", "text/csv"},
                                                    {".json", "application/json"},
                                                    {".mp4", "video/mp4"},
                                                    {".webm", "video/webm"}};
  return types.at(fs::path(name).extension().string());
}

// The crate's own description. `files`: path in the crate -> bytes.
ordered_json metadata(const std::map<std::string, std::string>& files, const std::string& day) {
  ordered_json parts = ordered_json::array(), objects = parts, results = parts, entities = parts;
  for (const auto& [name, bytes] : files) {
    const bool is_data = name.starts_with("data/");
    parts.push_back(reference(name));
    (is_data ? results : objects).push_back(reference(name));
    const char* what = name == "data/answers.csv"        ? "Answers, one row a trial"
                       : name == "data/participants.csv" ? "Participants, one row each"
                       : name.ends_with(".json")         ? "What made each clip, by its file"
                                                         : "Two clips side by side, as shown";
    entities.push_back({{"@id", name},
                        {"@type", "File"},
                        {"name", fs::path(name).filename().string()},
                        {"description", what},
                        {"encodingFormat", media_type(name)},
                        {"contentSize", std::to_string(bytes.size())},
                        {"sha256", sha256(bytes)}});
  }
  ordered_json graph = {{{"@id", "ro-crate-metadata.json"},
                         {"@type", "CreativeWork"},
                         {"conformsTo", reference("https://w3id.org/ro/crate/1.1")},
                         {"about", reference("./")}},
                        {{"@id", "./"},
                         {"@type", "Dataset"},
                         {"name", "Which cable looks most realistic?"},
                         {"description",
                          "Forced choices between simulations of cables, shown side by side: the "
                          "answers, and the clips that they were given to."},
                         {"datePublished", day},
                         {"conformsTo", reference(process_run)},
                         {"hasPart", parts},
                         {"mentions", ordered_json::array({reference("#study")})}},
                        {{"@id", process_run},
                         {"@type", "CreativeWork"},
                         {"name", "Process Run Crate"},
                         {"version", "0.4"}},
                        {{"@id", "#pinchlab"},
                         {"@type", "SoftwareApplication"},
                         {"name", "Pinchlab"},
                         {"softwareVersion", PINCHLAB_VERSION}},
                        {{"@id", "#study"},
                         {"@type", "CreateAction"},
                         {"name", "Perception study"},
                         {"instrument", reference("#pinchlab")},
                         {"object", objects},
                         {"result", results}}};
  for (ordered_json& entity : entities) graph.push_back(std::move(entity));
  return {{"@context", "https://w3id.org/ro/crate/1.1/context"}, {"@graph", graph}};
}

}  // namespace

void write_ro_crate(const fs::path& answers, const fs::path& clips, const fs::path& out) {
  std::map<std::string, std::string> files = {{"data/answers.csv", answers_csv(answers)},
                                              {"data/participants.csv", shared_csv(answers)}};
  const Shown shown = what_was_shown(answers);
  for (const std::string& name : shown.clips) {
    if (fs::path(name).filename() != name) {
      throw InputError(answers.string(), fmt::format("`{}` is no name of a clip", name));
    }
    const fs::path path = clips / name;
    if (!fs::is_regular_file(path)) {
      throw InputError(path.string(), "is not there, but was shown; name the study's own clips");
    }
    std::string bytes = read_whole(path);
    if (!shown.hashes.contains(sha256(bytes))) {
      throw InputError(path.string(), "is not the clip that was shown (other SHA-256)");
    }
    files["stimuli/" + name] = std::move(bytes);
  }
  if (fs::is_regular_file(clips / "manifest.json")) {
    files["stimuli/manifest.json"] = read_whole(clips / "manifest.json");
  }
  const std::string description = metadata(files, shown.last_day).dump(2) + "\n";
  files["ro-crate-metadata.json"] = description;
  write_new_folder(files, out);
}

}  // namespace pinchlab::study
