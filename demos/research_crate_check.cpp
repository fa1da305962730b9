// SPDX-License-Identifier: GPL-3.0-or-later
// Rules of RO-Crate 1.1 and of the Process Run Crate 0.4 (research_crate.h), one after another.

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>

#include "base/sha256.h"
#include "base/strict_json.h"
#include "demos/research_crate.h"

namespace pinchlab {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::size_t max_metadata_bytes = 1'000'000'000;
constexpr const char* metadata_name = "ro-crate-metadata.json";
constexpr const char* process_profile = "https://w3id.org/ro/wfrun/process/";

/// A value that may be one thing or a list of things.
std::vector<json> list_of(const json& entity, const std::string& key) {
  if (!entity.contains(key)) return {};
  const json& value = entity[key];
  return value.is_array() ? value.get<std::vector<json>>() : std::vector<json>{value};
}

bool has_type(const json& entity, const std::string& type) {
  const std::vector<json> types = list_of(entity, "@type");
  return std::ranges::find(types, json(type)) != types.end();
}

class Check {
 public:
  Check(const fs::path& folder, const json& document) : folder_(folder) {
    if (!document.is_object() || !document.contains("@context") || !document.contains("@graph") ||
        !document["@graph"].is_array()) {
      tell("ro-crate-metadata.json", "needs @context and @graph, a list");
      return;
    }
    const std::vector<json> contexts = list_of(document, "@context");
    if (std::ranges::find(contexts, json("https://w3id.org/ro/crate/1.1/context")) ==
        contexts.end()) {
      tell("@context", "does not name RO-Crate 1.1's");
    }
    for (const json& entity : document["@graph"]) add(entity);
    check_descriptor();
    for (const auto& [id, entity] : entities_) check_references(id, entity);
    check_parts();
    check_runs();
  }

  std::vector<std::string> problems;

 private:
  void tell(const std::string& where, const std::string& what) {
    problems.push_back(where + ": " + what);
  }

  void add(const json& entity) {
    if (!entity.is_object() || !entity.contains("@id") || !entity["@id"].is_string() ||
        !entity.contains("@type")) {
      return tell("@graph", "has an entity without @id or @type");
    }
    const std::string id = entity["@id"];
    if (!entities_.emplace(id, entity).second) tell(id, "is there twice");
  }

  const json* find(const json& reference) const {
    if (!reference.is_object() || !reference.contains("@id")) return nullptr;
    const auto found = entities_.find(reference["@id"].get<std::string>());
    return found == entities_.end() ? nullptr : &found->second;
  }

  // RO-Crate 1.1, "Root data entity".
  void check_descriptor() {
    const json* descriptor = find({{"@id", metadata_name}});
    if (!descriptor) return tell(metadata_name, "does not describe itself");
    if (!has_type(*descriptor, "CreativeWork")) tell(metadata_name, "is no CreativeWork");
    if (!(*descriptor).contains("conformsTo") ||
        !(*descriptor)["conformsTo"].value("@id", "").starts_with("https://w3id.org/ro/crate/")) {
      tell(metadata_name, "conforms to no version of RO-Crate");
    }
    root_ = descriptor->contains("about") ? find((*descriptor)["about"]) : nullptr;
    if (!root_) return tell(metadata_name, "is about no root dataset");
    const std::string id = (*root_)["@id"];
    if (!has_type(*root_, "Dataset") || !id.ends_with("/")) tell(id, "is no Dataset with a / last");
    const json date = root_->value("datePublished", json());
    static const std::regex day(R"(\d{4}-\d\d-\d\d(T.+)?)");
    if (!date.is_string() || !std::regex_match(date.get<std::string>(), day)) {
      tell(id, "datePublished is no date");
    }
    for (const char* key : {"name", "description"}) {
      if (!root_->contains(key)) tell(id, fmt::format("has no {}", key));
    }
  }

  // Flattened JSON-LD: objects inside of entities are references, and lead somewhere.
  void check_references(const std::string& id, const json& entity) {
    const bool is_descriptor = id == metadata_name;
    for (const auto& [key, value] : entity.items()) {
      for (const json& item : list_of(entity, key)) {
        if (!item.is_object()) continue;
        if (item.size() != 1 || !item.contains("@id")) {
          tell(id, fmt::format("{} is not flattened", key));
        } else if (!find(item) && !(is_descriptor && key == "conformsTo")) {
          tell(id, fmt::format("{} leads to {}, which is not there", key,
                               item["@id"].get<std::string>()));
        }
      }
    }
  }

  // Every file is a part of the root, is in the folder, and is what it was.
  void check_parts() {
    if (!root_) return;
    std::set<std::string> parts;
    for (const json& part : list_of(*root_, "hasPart")) parts.insert(part.value("@id", ""));
    for (const auto& [id, entity] : entities_) {
      if (!has_type(entity, "File")) continue;
      if (!parts.contains(id)) tell(id, "is no part of the root dataset");
      const fs::path name = id;
      if (name.is_absolute() || id.find("..") != std::string::npos) {
        tell(id, "is not inside of the folder");
      } else if (!fs::is_regular_file(folder_ / name)) {
        tell(id, "is not in the folder");
      } else if (entity.value("contentSize", "") != std::to_string(fs::file_size(folder_ / name)) ||
                 entity.value("sha256", "") != sha256_of_file(folder_ / name)) {
        tell(id, "has changed: its size or SHA-256 is another one");
      }
    }
    for (const fs::directory_entry& file : fs::recursive_directory_iterator(folder_)) {
      const std::string name = file.path().lexically_relative(folder_).generic_string();
      if (file.is_regular_file() && name != metadata_name && !parts.contains(name)) {
        tell(name, "is in the folder, but not in the crate");
      }
    }
  }

  // Process Run Crate 0.4, "Requirements".
  void check_runs() {
    if (!root_) return;
    bool conforms = false;
    for (const json& profile : list_of(*root_, "conformsTo")) {
      const json* entity = find(profile);
      conforms = conforms || (entity && has_type(*entity, "CreativeWork") &&
                              profile["@id"].get<std::string>().starts_with(process_profile));
    }
    if (!conforms) tell("./", "does not conform to the Process Run Crate");
    std::set<std::string> mentioned;
    for (const json& action : list_of(*root_, "mentions"))
      mentioned.insert(action.value("@id", ""));
    int runs = 0;
    for (const auto& [id, entity] : entities_) {
      if (!has_type(entity, "CreateAction")) continue;
      ++runs;
      if (!mentioned.contains(id)) tell(id, "is not mentioned by the root dataset");
      check_run(id, entity);
    }
    if (runs == 0) tell("@graph", "has no CreateAction");
  }

  void check_run(const std::string& id, const json& run) {
    const json* instrument = run.contains("instrument") ? find(run["instrument"]) : nullptr;
    if (!instrument || !has_type(*instrument, "SoftwareApplication")) {
      tell(id, "instrument is no SoftwareApplication of the crate");
    } else if (!instrument->contains("softwareVersion") && !instrument->contains("version")) {
      tell(id, "its instrument has no version");
    }
    if (list_of(run, "result").empty()) tell(id, "has no result");
    const auto has_any = [](const json& entity, std::initializer_list<const char*> types) {
      return std::ranges::any_of(types, [&](const char* type) { return has_type(entity, type); });
    };
    for (const char* key : {"object", "result"}) {
      for (const json& item : list_of(run, key)) {
        const json* entity = find(item);
        if (entity &&
            !has_any(*entity, {"File", "Dataset", "Collection", "CreativeWork", "PropertyValue"})) {
          tell(id, fmt::format("{} {} is neither data nor a value", key, item.value("@id", "")));
        }
      }
    }
  }

  fs::path folder_;
  std::map<std::string, json> entities_;
  const json* root_ = nullptr;
};

}  // namespace

std::vector<std::string> problems_of_crate(const fs::path& folder) {
  return Check(folder, read_json_file(folder / metadata_name, max_metadata_bytes)).problems;
}

}  // namespace pinchlab
