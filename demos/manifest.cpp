// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/manifest.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include "base/output_file.h"
#include "base/read_file.h"
#include "base/sha256.h"

namespace pinchlab {
namespace {

using nlohmann::ordered_json;

constexpr const char* format_name = "pinchlab clips 1";

std::string file_of(const ordered_json& entry) {
  return entry.at("file").get<std::string>();
}

// What make_clip adds to a plan's entry.
bool is_result(std::string_view key) {
  constexpr std::array<std::string_view, 6> results = {
      "report", "raw_frames_murmur3", "sha256", "accuracy", "broken_promises", "hard_to_see"};
  return std::ranges::find(results, key) != results.end();
}

bool names_as_equal(const ordered_json& entry, const std::string& file) {
  const auto files = entry.find("equal_sizes_with");
  return files != entry.end() && std::ranges::find(*files, ordered_json(file)) != files->end();
}

// A name in the folder, not a way out of it.
bool is_entry(const ordered_json& entry) {
  if (!entry.is_object() || !entry.contains("file") || !entry["file"].is_string()) {
    return false;
  }
  const std::filesystem::path file = file_of(entry);
  return file.has_filename() && file == file.filename() && file != "." && file != "..";
}

}  // namespace

Manifest read_manifest(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "manifest.json";
  if (!std::filesystem::exists(path)) {
    return {};
  }
  const ordered_json value =
      ordered_json::parse(read_whole(path), nullptr, /*allow_exceptions=*/false);
  if (!value.is_object() || value.value("format", ordered_json()) != format_name ||
      !value.contains("clips") || !value["clips"].is_array() ||
      !std::ranges::all_of(value["clips"], is_entry)) {
    throw std::runtime_error(
        fmt::format("{}: is not a manifest of this program; remove it to have every clip made anew",
                    path.string()));
  }
  Manifest manifest;
  for (const ordered_json& entry : value["clips"]) {
    put(manifest, entry);
  }
  return manifest;
}

void write_manifest(const std::filesystem::path& folder, const Manifest& manifest) {
  const ordered_json value = {{"format", format_name}, {"clips", manifest.entries}};
  OutputFile out(folder / "manifest.json");
  out.write(value.dump(2) + "\n");
  out.finish();
}

void put(Manifest& manifest, ordered_json entry) {
  for (ordered_json& other : manifest.entries) {
    if (names_as_equal(other, file_of(entry)) && !names_as_equal(entry, file_of(other))) {
      other.erase("equal_sizes_with");
    }
  }
  const auto place = std::ranges::lower_bound(manifest.entries, file_of(entry), {}, file_of);
  if (place != manifest.entries.end() && file_of(*place) == file_of(entry)) {
    *place = std::move(entry);
  } else {
    manifest.entries.insert(place, std::move(entry));
  }
}

bool is_up_to_date(const Manifest& manifest, const std::filesystem::path& folder,
                   const ordered_json& plan) {
  const auto entry = std::ranges::find(manifest.entries, file_of(plan), file_of);
  if (entry == manifest.entries.end()) {
    return false;
  }
  // Both ways: an option that is off has no key in the plan.
  for (const auto& [key, value] : plan.items()) {
    if (!entry->contains(key) || (*entry)[key] != value) {
      return false;
    }
  }
  for (const auto& [key, value] : entry->items()) {
    if (!plan.contains(key) && !is_result(key)) {
      return false;
    }
  }
  const std::filesystem::path path = folder / file_of(plan);
  return std::filesystem::is_regular_file(path) && entry->contains("sha256") &&
         (*entry)["sha256"] == sha256_of_file(path);
}

}  // namespace pinchlab
