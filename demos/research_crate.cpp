// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/research_crate.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <set>
#include <stdexcept>

#include "base/output_file.h"
#include "base/sha256.h"
#include "base/strict_json.h"
#include "base/text_checks.h"
#include "demos/version.h"

namespace pinchlab {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr const char* program_id = "#pinchlab";

ordered_json reference(const std::string& id) {
  return {{"@id", id}};
}

/// A local name of what has none of its own (RFC 3986).
std::string local_id(const std::string& text) {
  std::string id = "#";
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '.' || c == '_' || c == '=';
    if (plain) {
      id += c;
    } else {
      id += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
  return id;
}

ordered_json file_entity(const fs::path& folder, const CrateFile& file) {
  const fs::path path = folder / file.name;
  return {{"@id", file.name},
          {"@type", "File"},
          {"name", file.name},
          {"description", file.description},
          {"encodingFormat", file.media_type},
          {"contentSize", std::to_string(fs::file_size(path))},
          {"sha256", sha256_of_file(path)}};
}

ordered_json root_entity(const Publication& publication) {
  ordered_json root = {{"@id", "./"},
                       {"@type", "Dataset"},
                       {"name", publication.title},
                       {"description",
                        "Clips of simulated cables, a table of motion and a record of parameters "
                        "and settings for each; stimuli.csv lists them."},
                       {"datePublished", publication.date},
                       {"conformsTo", reference("https://w3id.org/ro/wfrun/process/0.4")}};
  if (!publication.licence.empty()) root["license"] = reference(publication.licence);
  if (!publication.author.empty()) {
    root["author"] = reference(publication.orcid.empty() ? "#author" : publication.orcid);
  }
  return root;
}

/// What the graph says besides the files and runs: the two documents, the program, people.
void add_context(const Publication& publication, ordered_json& graph) {
  graph.push_back({{"@id", "https://w3id.org/ro/wfrun/process/0.4"},
                   {"@type", "CreativeWork"},
                   {"name", "Process Run Crate"},
                   {"version", "0.4"}});
  graph.push_back({{"@id", program_id},
                   {"@type", "SoftwareApplication"},
                   {"name", "Pinchlab"},
                   {"description", "Simulates and renders cables that are pinched between bodies"},
                   {"softwareVersion", version}});
  if (!publication.licence.empty()) {
    graph.push_back({{"@id", publication.licence},
                     {"@type", "CreativeWork"},
                     {"name", fs::path(publication.licence).filename().string()}});
  }
  if (!publication.author.empty()) {
    graph.push_back({{"@id", publication.orcid.empty() ? "#author" : publication.orcid},
                     {"@type", "Person"},
                     {"name", publication.author}});
  }
}

ordered_json run_entity(const Crate& crate, const CrateRun& run) {
  ordered_json action = {{"@id", local_id(run.id)},
                         {"@type", "CreateAction"},
                         {"name", run.id},
                         {"description", run.description},
                         {"instrument", reference(program_id)},
                         {"object", ordered_json::array()},
                         {"result", ordered_json::array()}};
  if (!crate.publication.author.empty()) {
    action["agent"] =
        reference(crate.publication.orcid.empty() ? "#author" : crate.publication.orcid);
  }
  for (const CrateFile& input : crate.inputs) action["object"].push_back(reference(input.name));
  for (const auto& [name, value] : run.parameters.items()) {
    action["object"].push_back(reference(local_id(name + "=" + value.dump())));
  }
  for (const CrateFile& file : run.results) action["result"].push_back(reference(file.name));
  return action;
}

}  // namespace

std::string day_of_publication() {
  std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH")) {
    const auto seconds = parse_whole(epoch, 0, 253'402'300'799);
    if (!seconds) {
      throw std::invalid_argument(fmt::format(
          "SOURCE_DATE_EPOCH of the environment: {} is not a whole number of seconds since 1970",
          pointer_token(epoch)));
    }
    now = *seconds;
  }
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(now));
}

void write_crate(const fs::path& folder, const Crate& crate) {
  ordered_json root = root_entity(crate.publication);
  ordered_json files = ordered_json::array(), runs = ordered_json::array();
  ordered_json values = ordered_json::array();
  const auto add_files = [&](const std::vector<CrateFile>& some) {
    for (const CrateFile& file : some) {
      files.push_back(file_entity(folder, file));
      root["hasPart"].push_back(reference(file.name));
    }
  };
  add_files(crate.inputs);
  add_files(crate.others);
  std::set<std::string> known_values;
  for (const CrateRun& run : crate.runs) {
    runs.push_back(run_entity(crate, run));
    root["mentions"].push_back(reference(local_id(run.id)));
    for (const auto& [name, value] : run.parameters.items()) {
      const std::string id = local_id(name + "=" + value.dump());
      if (!known_values.insert(id).second) continue;
      values.push_back({{"@id", id}, {"@type", "PropertyValue"}, {"name", name}, {"value", value}});
    }
    add_files(run.results);
  }
  ordered_json graph = ordered_json::array();
  graph.push_back({{"@id", "ro-crate-metadata.json"},
                   {"@type", "CreativeWork"},
                   {"conformsTo", reference("https://w3id.org/ro/crate/1.1")},
                   {"about", reference("./")}});
  graph.push_back(root);
  add_context(crate.publication, graph);
  for (const ordered_json* part : {&runs, &values, &files}) {
    graph.insert(graph.end(), part->begin(), part->end());
  }
  const ordered_json document = {{"@context",
                                  {"https://w3id.org/ro/crate/1.1/context",
                                   {{"sha256", "https://w3id.org/ro/terms/workflow-run#sha256"}}}},
                                 {"@graph", graph}};
  OutputFile out(folder / "ro-crate-metadata.json");
  out.write(document.dump(1) + "\n");
  out.finish();
}

}  // namespace pinchlab
