// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a study asks in each trial besides the choice: how sure the participant is, and where it
// looks wrong. Participants are the unit.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analysis/answers_table.h"
#include "analysis/blocks.h"
#include "analysis/estimate.h"
#include "analysis/graded_preference.h"
#include "base/answer_file.h"

namespace pinchlab::analysis {

/// What was shown, in words: the demonstration, with its level where there are levels.
std::string stimulus_of(const BesidesAnswer& answer);

/// The main trials of a file.
std::vector<BesidesAnswer> besides_of(const AnswerFile& file);

/// Confidence in the answers to one question (a pair of clips).
struct ConfidenceRow {
  std::string name;
  std::size_t answers = 0;
  Estimate mean, low, high;          ///< of the participants' means; Student's t
  Estimate mean_with, mean_against;  ///< of answers with and against the reference, likewise
};

/// Does confidence go with choices? Where answers are right or wrong the reference is the right one
/// and only answers at the same level are compared; elsewhere it is what most of the *other*
/// participants chose of the same pair.
struct Confidence {
  bool is_of_hits = false;
  std::vector<ConfidenceRow> rows;  ///< the last one is "all"
  /// Of the participants with answers of both kinds: how often, of one answer of each kind, the one
  /// with the reference was given with more confidence (ties count half), averaged.
  Estimate area, area_low, area_high;  ///< Student's t, cut to [0, 1]
  SignedRank test;                     ///< of 2 area - 1
};

/// The clicks in one clip.
struct PlaceRow {
  std::string stimulus, clip;
  std::size_t shown = 0, participants = 0;
  std::vector<ClickedPlace> clicks;
};

struct Places {
  std::vector<PlaceRow> rows;
  std::size_t clicks = 0, answers = 0;
  std::string first, second;  ///< of p_sign_flip; empty: more than two kinds of clips
  std::size_t on_first = 0, on_second = 0;
  Estimate p_sign_flip;  ///< of each participant's clicks in the one minus those in the other
};

struct Besides {
  std::optional<Confidence> confidence;
  std::optional<Places> places;
  std::vector<BesidesAnswer> answers;  ///< empty where nothing was asked besides
};
/// The order of the answers does not matter.
Besides analyse_besides(std::vector<BesidesAnswer> answers, double alpha, std::uint64_t seed);

struct Figure;
struct CsvTable;

/// Tables in words, with the place of the figure `places`; nothing where nothing was asked.
std::vector<Block> besides_blocks(const Besides& besides, double alpha);
/// Adds `confidence` and `places`.
void put_besides(nlohmann::ordered_json& document, const Besides& besides);
/// confidence.csv, and places.csv with every click.
std::vector<CsvTable> besides_csv(const Besides& besides);
/// The map of the clicks, if there are any.
std::vector<Figure> besides_figures(const Besides& besides);

}  // namespace pinchlab::analysis
