// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// manifest.json: what each file of a folder of clips shows, how it was made and what it must hash
// to.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pinchlab {

struct Manifest {
  std::vector<nlohmann::ordered_json>
      entries;  ///< each with "file", see clip.h; in order of "file"
};

/// The folder's manifest; an empty one if there is no such file. Throws std::runtime_error, with
/// the cure, if the file is not one of ours.
Manifest read_manifest(const std::filesystem::path& folder);

/// Writes manifest.json, whole or not at all.
void write_manifest(const std::filesystem::path& folder, const Manifest& manifest);

/// Adds an entry or replaces the one of the same file. Where the new file is not made to the size
/// of one that was made to the size of its forerunner, that one's entry no longer says so.
void put(Manifest& manifest, nlohmann::ordered_json entry);

/// Whether the folder holds the file that `plan` (clip.h, plan_entry) would make: its entry says
/// what the plan says and no more but results, and the file's SHA-256 is the entry's.
bool is_up_to_date(const Manifest& manifest, const std::filesystem::path& folder,
                   const nlohmann::ordered_json& plan);

}  // namespace pinchlab
