// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Plans and answers as tables for other programs.

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "study/plan.h"

namespace pinchlab::study {

/// The plans of participants 0 to `participants` - 1.
nlohmann::ordered_json plan_json(std::uint64_t seed, std::uint64_t participants,
                                 const PlanOptions& options);
/// The same as CSV, one row a trial.
std::string plan_csv(std::uint64_t seed, std::uint64_t participants, const PlanOptions& options);

/// All answers of a folder as tidy CSV, one row a trial. Throws InputError for a file
/// that is no answer file.
std::string answers_csv(const std::filesystem::path& folder);

/// The same as one row a participant: times, measures that exclusion rules are about, screen,
/// texts.
std::string participants_csv(const std::filesystem::path& folder);

/// The same without ids of a recruiting site, for data that are shared.
std::string shared_csv(const std::filesystem::path& folder);

/// Writes files, by their paths in it, to a folder that must not exist, or be empty. Throws
/// std::runtime_error.
void write_new_folder(const std::map<std::string, std::string>& files,
                      const std::filesystem::path& out);

/// The files of a BIDS dataset (1.9.0, behaviour) of a folder's answers, by their paths:
/// participants.tsv and sub-<participant>/beh/sub-<participant>_task-cables_beh.tsv with their
/// descriptions.
std::map<std::string, std::string> bids_files(const std::filesystem::path& folder);

/// Makes it. `out` must not exist, or be empty.
void write_bids(const std::filesystem::path& folder, const std::filesystem::path& out);

/// The files of a Psych-DS dataset of a folder's answers, by their paths.
std::map<std::string, std::string> psych_ds_files(const std::filesystem::path& folder);

/// Makes a Psych-DS dataset (dataset_description.json, data/study-cables_data.csv) of a folder's
/// answers. `out` must not exist, or be empty.
void write_psych_ds(const std::filesystem::path& folder, const std::filesystem::path& out);

}  // namespace pinchlab::study
