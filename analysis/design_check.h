// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Was the frozen design of a study followed? (base/design_file.h)

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analysis/answers_table.h"
#include "base/design_file.h"

namespace pinchlab::analysis {

/// The design to hold the answers against: of the file, if there is one, otherwise the one that a
/// folder of answers holds. Throws InputError if two folders hold different ones, or inputs are no
/// answer files.
std::optional<Design> design_of(const std::vector<std::filesystem::path>& inputs,
                                const std::filesystem::path& file);

/// Participants whom a rule of the design leaves out, with the rule and their value as the reason.
std::vector<Exclusion> exclusions_by_rule(const Design& design,
                                          const std::vector<std::filesystem::path>& inputs);

/// How the answers were analysed.
struct UsedAnalysis {
  std::map<std::string, std::string> options;  ///< as in Rules::analysis
  std::vector<Exclusion> exclusions;           ///< all of them
  std::optional<double> p, log_bayes_factor;   ///< of the test that the study stops by
};

/// Holds answers against the design: plan, seed, question, texts, consent and clips of every
/// participant; their number and the stopping rule; who was left out; the options of the analysis.
DesignCheck check_design(const Design& design, const std::vector<std::filesystem::path>& inputs,
                         const UsedAnalysis& used);

/// In one sentence or two; empty without a design. Begins with a space.
std::string design_words(const std::optional<DesignCheck>& check);

/// For report.json.
nlohmann::ordered_json design_json(const DesignCheck& check);

}  // namespace pinchlab::analysis
