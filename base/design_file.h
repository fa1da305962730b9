// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The frozen design of a study, by which study and analysis meet once more: `study freeze` writes
// it before the first participant, `analyse` holds the answers against it.

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/answer_file.h"

namespace pinchlab {

/// A rule by which a participant's answers are not analysed: a measure of them beyond a limit that
/// the researcher sets.
struct ExclusionRule {
  std::string key;        ///< "dropped_frames_over"
  double low, high;       ///< that the limit can be
  std::string words;      ///< with {} for the limit
  bool is_under = false;  ///< left out below the limit, not above it
};
const std::vector<ExclusionRule>& exclusion_rules();

/// What `rule` is about in one participant's answer file, over its main trials; NaN where the file
/// does not hold it. "failed_checks_over" counts attention trials.
double measure(const ExclusionRule& rule, const nlohmann::json& answers);

/// What the researcher says before the study, beside its configuration.
struct Rules {
  std::vector<std::string> hypotheses;
  std::map<std::string, double> exclusions;     ///< limits by key of exclusion_rules()
  std::map<std::string, std::string> analysis;  ///< options of `pinchlab analyse` and their values
};

/// The options of `analyse` for a kind of study, with the values they have unless said otherwise.
std::map<std::string, std::string> usual_analysis(AnswersKind kind);

/// Reads rules strictly ("pinchlab-rules 1"; study/README.md). Options that are not named get their
/// usual values. Throws InputError.
Rules parse_rules(const nlohmann::json& document, const std::string& file, AnswersKind kind);

/// When a study is looked at, and when it stops.
struct Sample {
  std::string rule = "fixed";         ///< or "obrien-fleming", "pocock", "bayes-factor"
  std::vector<std::int64_t> looks;    ///< participants at each, increasing
  std::vector<double> p_at_most;      ///< to stop, one a look; none for the Bayes factor
  double bayes_factor = 0;            ///< to stop from it on, or from 1 / it down
  nlohmann::json stopping = nullptr;  ///< the whole file of `pinchlab stopping`, if there is one
};

/// Reads what `pinchlab stopping --json` wrote. Throws InputError.
Sample parse_stopping(const nlohmann::json& document, const std::string& file);

struct Design {
  std::string sha256;  ///< of all the rest
  std::string frozen_utc;
  std::uint64_t seed = 0;
  nlohmann::json plan;                       ///< as in answer files
  std::map<std::string, std::string> study;  ///< what is asked, told and shown, as in answer files
  /// Of clips (as in answer files): hashes by variant
  std::map<std::string, std::map<std::string, std::string>> clips_sha256;
  Sample sample;
  Rules rules;
};

/// The hash of a design: of the document without its key `sha256`, in JSON's compact form with
/// sorted keys.
std::string design_hash(nlohmann::json document);

/// Reads a design strictly ("pinchlab-design 1"). Throws InputError also where it was changed after
/// it was frozen.
Design parse_design(const nlohmann::json& document, const std::string& file);
Design read_design(const std::filesystem::path& path);

/// Where a folder of answers keeps the design that it was frozen with.
std::filesystem::path design_path(const std::filesystem::path& answers);

}  // namespace pinchlab
