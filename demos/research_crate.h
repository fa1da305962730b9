// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A folder of results as a research crate: what is in it, what made it of what. RO-Crate 1.1
// (https://w3id.org/ro/crate/1.1), Process Run Crate 0.4 (https://w3id.org/ro/wfrun/process/0.4).

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pinchlab {

/// What the folder's author says of it.
struct Publication {
  std::string title = "Stimuli made with Pinchlab";
  std::string author;   ///< a person's name; empty: not told
  std::string orcid;    ///< "https://orcid.org/0000-0002-1825-0097"; empty: not told
  std::string licence;  ///< a URL, "https://spdx.org/licenses/CC-BY-4.0"; empty: not told
  std::string date;     ///< "2026-11-20"
};

/// The day (UTC) that SOURCE_DATE_EPOCH names (https://reproducible-builds.org/specs/), or today.
std::string day_of_publication();

struct CrateFile {
  std::string name, media_type, description;
};

/// One run of the program: what went in besides the crate's inputs, and what came out.
struct CrateRun {
  std::string id, description;
  nlohmann::ordered_json parameters;
  std::vector<CrateFile> results;
};

struct Crate {
  Publication publication;
  std::vector<CrateFile> inputs = {};  ///< of every run
  std::vector<CrateFile> others = {};  ///< neither went into a run nor came out of one
  std::vector<CrateRun> runs = {};
};

/// Writes ro-crate-metadata.json beside the files, which must be there. The same files and the same
/// crate give the same bytes: it says nothing of when and where a run took place.
void write_crate(const std::filesystem::path& folder, const Crate& crate);

/// What in the folder's ro-crate-metadata.json breaks a rule that the two documents above call
/// MUST, or does not agree with the folder (files missing, changed or not named); none is good.
/// Throws InputError if it cannot be read.
std::vector<std::string> problems_of_crate(const std::filesystem::path& folder);

}  // namespace pinchlab
