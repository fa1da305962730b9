// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The frozen design of a study, and a preregistration text of it, made before the first
// participant.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "base/design_file.h"
#include "study/clips.h"
#include "study/config.h"

namespace pinchlab::study {

struct FreezeOptions {
  Config config;  ///< with its demonstrations named
  Clips clips;
  std::filesystem::path answers;      ///< folder for the answers, made if missing
  std::optional<std::uint64_t> seed;  ///< none: the folder's own, or a random one
  Sample sample;
  Rules rules;
  std::filesystem::path pilot;  ///< folder of a pilot's answers; empty: there was none
  std::filesystem::path out;    ///< folder for design.json and preregistration.md
  std::string utc;              ///< now
};

/// Fixes the study in `answers`, so that no other can be served there, keeps its design there and
/// writes it to `out` with the preregistration. Returns the design's SHA-256. Throws
/// std::runtime_error if somebody has taken part already, a design is frozen there, or `out` holds
/// another design or its text. A freeze that was interrupted is finished with the text that it had
/// written.
std::string freeze(const FreezeOptions& options);

/// Throws std::invalid_argument if the sample cannot be one of this study: stopping rules are for
/// the test of two methods, and for as many answers a participant as the study asks for.
void check_sample(const FreezeOptions& options);

/// Throws std::invalid_argument for an exclusion by what this study does not have.
void check_rules(const FreezeOptions& options);

/// The design as a preregistration in Markdown; `design` is the whole document.
std::string preregistration(const nlohmann::json& document, const Config& config);

/// What kind of study a configuration is, for the analysis.
AnswersKind kind_of(const Config& config);

}  // namespace pinchlab::study
