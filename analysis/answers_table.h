// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// START HERE: the one checked table that every statistic is computed from.

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/answer_file.h"

namespace pinchlab::analysis {

/// One answer of one participant to one pair of clips.
struct Answer {
  double reaction_time_s = -1.0;    ///< s, >= 0; -1: not recorded
  std::uint32_t participant = 0;    ///< index into AnswersTable::participants
  std::uint32_t line = 0;           ///< running number over the lines (trials) of all inputs
  std::uint16_t demonstration = 0;  ///< index into AnswersTable::demonstrations
  std::uint16_t position = 0;       ///< place in the participant's session, from 1; 0: not recorded
  bool chose_pinch = false;         ///< the pinch clip was chosen, not the cable (baseline) clip
  std::int8_t grade = 0;            ///< as GradedAnswer::grade; 0: was not graded
  Side pinch_side = Side::unknown;  ///< where the pinch clip was shown
};

/// How often each method was chosen.
struct Counts {
  std::int64_t pinch = 0;
  std::int64_t cable = 0;
  [[nodiscard]] std::int64_t total() const { return pinch + cable; }
};

/// Demonstrations that are analysed together.
struct Group {
  std::string name;
  std::vector<std::uint16_t> demonstrations;  ///< indices, increasing
};

/// What went on around one participant's answers.
struct Session {
  int attention_passed = 0;
  int attention_failed = 0;
  std::int64_t focus_lost_count = 0;
  std::int64_t frames = 0, dropped_frames = 0;
  std::int64_t playback_errors = 0;
  int screen_width_px = 0, screen_height_px = 0;    ///< CSS px, of the last trial; 0: not recorded
  int narrowest_clips_px = 0, widest_clips_px = 0;  ///< both clips together; 0: not recorded
  double refresh_rate_hz = 0;                       ///< of the screen; 0: not measured
  std::map<std::string, std::string> free_text;     ///< question -> what was written
};

/// A participant who was left out, and the reason that was given.
struct Exclusion {
  std::string participant;
  std::string reason;
};

/// A preference that was given in grades (comparison scale of ITU-R BT.500).
struct GradedAnswer {
  std::string participant, demonstration;
  int grade = 0;  ///< -3 to 3, positive for the method under test; 0: a tie
  // As those of Answer.
  int position = 0;
  Side pinch_side = Side::unknown;
  double reaction_time_s = -1.0;
};

/// A click on where it looks wrong.
struct ClickedPlace {
  std::string clip;     ///< what the clip showed: a method, or "reference" or "graded"
  double x = 0, y = 0;  ///< shares of its width and height, from its upper left corner
  double time_s = 0;    ///< of the clip
};

/// One main trial of which more is known than the choice.
struct BesidesAnswer {
  std::string participant;
  std::string demonstration;
  std::optional<double> level;  ///< in studies of levels
  std::string first, second;    ///< what was compared, in order of their names
  std::string chosen;           ///< one of them; empty: a tie
  std::optional<bool> is_hit;   ///< in studies of levels
  std::optional<int> confidence;
  std::optional<ClickedPlace> place;
};

/// What holding answers against the frozen design of their study showed (design_check.h).
struct DesignCheck {
  std::string sha256, frozen_utc;
  std::vector<std::string> kept;        ///< in words, what was done as planned
  std::vector<std::string> deviations;  ///< in words; empty: the design was followed
  /// What the look that was reached asks for, of designs that may stop early: a preference is
  /// claimed up to this p, or from this Bayes factor on.
  std::optional<double> p_at_most, bayes_factor;
  std::int64_t look = 0;  ///< participants at the look that p_at_most is of
};

/// All answers, checked and in an order that does not depend on the order of the inputs:
/// participants by name, demonstrations by natural order, answers by participant, demonstration and
/// position.
struct AnswersTable {
  std::vector<std::string> sources;       ///< the files read
  std::vector<std::string> participants;  ///< empty if only counts are known
  std::vector<std::string> demonstrations;
  std::vector<Group> groups;                  ///< the last one is "all"
  std::string groups_from;                    ///< in words: where the groups come from
  std::vector<Answer> answers;                ///< without ties; empty if only counts are known
  std::vector<GradedAnswer> graded;           ///< all, ties among them, where they were graded
  std::vector<BesidesAnswer> besides;         ///< of answer files
  std::vector<Counts> counts;                 ///< one a demonstration
  std::map<std::uint32_t, Session> sessions;  ///< by participant; only those with something to tell
  bool is_pilot = false;                      ///< answers of a trial run
  bool has_session_records = false;  ///< some input records focus, frames and playback errors
  std::vector<Exclusion> exclusions;
  int answers_per_demonstration = 1;    ///< that a complete participant gave
  std::vector<std::string> incomplete;  ///< participants with answers missing (if that is allowed)
  std::optional<DesignCheck> design;    ///< if the study has a frozen one
};

/// Calls `take` with the answers of each participant, one after the other.
template <class Take>
void each_participant(std::span<const Answer> answers, Take take) {
  while (!answers.empty()) {
    const auto next = std::ranges::find_if(answers, [&](const Answer& answer) {
      return answer.participant != answers.front().participant;
    });
    const auto count = static_cast<std::size_t>(next - answers.begin());
    take(answers.first(count));
    answers = answers.subspan(count);
  }
}

/// How inputs are to be read.
struct ReadOptions {
  std::map<std::string, std::string> columns;  ///< our column name -> the file's
  std::string pinch_value = "pinch";           ///< in column `choice`, for the method under test
  std::string cable_value = "cable";  ///< in column `choice`, for the method it is compared with
  char separator = ',';
  bool ignore_other_columns = false;
  int repetitions = 1;  ///< answers a participant gives to each demonstration (CSV), 1..100
  bool allow_missing = false;
  std::filesystem::path groups_file;   ///< empty: group column, or the default by leading number
  std::filesystem::path exclude_file;  ///< empty: nobody is left out by hand
  std::vector<Exclusion> by_rule;      ///< who is left out by a rule of the study's design
};

/// Reads answer files (.json), folders of them, tidy CSV files and tables of counts (.csv) into one
/// table. Throws InputError that names file, place and cure for whatever is missing, double,
/// contradictory or unknown.
AnswersTable read_answers(const std::vector<std::filesystem::path>& inputs,
                          const ReadOptions& options);

/// Columns that CSV inputs can have, of whatever kind.
std::vector<std::string> input_columns();

/// The name of the group that holds every demonstration.
inline constexpr const char* all_group = "all";

}  // namespace pinchlab::analysis
