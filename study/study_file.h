// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a study in a folder of answers is from its first start on: ANSWERS/.running/study.json.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "study/config.h"

namespace pinchlab::study {

struct StudyFile {
  std::uint64_t seed = 0;
  std::string link_secret;             ///< that one-time links follow from
  std::set<std::uint64_t> used_links;  ///< by participant number
};

/// Where a study keeps what is not finished.
std::filesystem::path running_folder(const std::filesystem::path& answers);

/// Makes that folder, and `answers`, where they are missing. Throws std::runtime_error.
void make_answers_folder(const std::filesystem::path& answers);

/// What is said where another server has the folder.
std::string in_use(const std::filesystem::path& answers);

/// Throws std::runtime_error where it cannot be made since something else is there, or where
/// another server uses it; makes nothing.
void check_answers_folder(const std::filesystem::path& answers);

/// A seed from the kernel's random numbers, 0 to 2^48 - 1.
std::uint64_t random_seed();

/// Reads the file, or makes it with `seed` (random if none). Throws std::runtime_error with the
/// cure if the study there has another seed or plan, or asks or shows something else than `shown`
/// (what_is_shown()).
StudyFile open_study_file(const std::filesystem::path& answers, const Config& config,
                          const nlohmann::json& shown, std::optional<std::uint64_t> seed);

void write_study_file(const std::filesystem::path& answers, const Config& config,
                      const nlohmann::json& shown, const StudyFile& study);

}  // namespace pinchlab::study
