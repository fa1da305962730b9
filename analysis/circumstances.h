// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What went on around the answers: attention checks, screens, playback. Every kind of study has it.

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "analysis/answers_table.h"
#include "analysis/blocks.h"

namespace pinchlab::analysis {

/// Sessions by the participant's name; those without anything to tell may be missing.
using NamedSessions = std::map<std::string, Session>;

/// Adds what went on around the answers of a file.
void note(const AnswerFile& file, Session& session);

/// Those of a table that keeps them by number.
NamedSessions named_sessions(const AnswersTable& table);

/// All sessions together.
struct Circumstances {
  bool recorded = false;  ///< some input says how the clips were played
  int checks_passed = 0, checks_failed = 0;
  std::vector<std::string> failed_by;  ///< participants with at least one failed check
  std::int64_t focus_lost_count = 0;
  std::int64_t frames = 0, dropped_frames = 0;
  std::int64_t playback_errors = 0;
  std::vector<std::string> errors_for;              ///< participants with playback errors
  std::map<std::pair<int, int>, int> screens;       ///< CSS px, width and height -> participants
  int narrowest_clips_px = 0, widest_clips_px = 0;  ///< both clips together; 0: not recorded
  int screens_measured = 0;
  /// participants whose screens do not show 60 frames a second evenly, with the rate: "p (75 Hz)"
  std::vector<std::string> uneven_screens;
};
Circumstances circumstances(const NamedSessions& sessions, bool recorded);

/// In sentences; nothing where nothing was recorded.
std::vector<Block> circumstance_blocks(const Circumstances& all);

/// Adds `attention_checks` and `playback`.
void put_circumstances(nlohmann::ordered_json& document, const Circumstances& all);

}  // namespace pinchlab::analysis
