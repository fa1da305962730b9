// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A participant's progress as a pure state machine: no clock, no files, no network. Times are given
// in, what is not allowed throws Refused and changes nothing.
//
//   start --> show(0) --> answer(0) --> show(1) --> ... --> answer(n-1) --> finished, to be saved
//
// A reload shows the same trial again; an answer that is sent twice counts once.

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "study/clips.h"
#include "study/plan.h"
#include "study/questionnaire.h"
#include "study/recruiting.h"
#include "study/trial_options.h"

namespace pinchlab::study {

/// What a participant's browser asked for cannot be. `status` is HTTP's: 409 where the session is
/// elsewhere, 422 where the data cannot be.
struct Refused : std::runtime_error {
  Refused(int status_, const std::string& message) : std::runtime_error(message), status(status_) {}
  int status;
};

/// A place in one of the clips that are shown side by side.
struct Where {
  Side side = Side::left;
  double x = 0, y = 0;  ///< shares of the clip's width and height, from its upper left corner
  double time_s = 0;    ///< s of the clip

  friend bool operator==(const Where&, const Where&) = default;
};

/// What the page tells of one trial.
struct TrialAnswer {
  std::optional<Side> choice;  ///< none: a tie
  double reaction_time_s = 0;  ///< s, since the buttons appeared
  int loops_watched = 0, focus_lost_count = 0;
  int frame_count = 0;     ///< decoded, dropped ones among them
  int dropped_frames = 0;  ///< of these
  /// s, how much longer than the clip itself a loop took to begin anew; none where the browser
  /// tells no times of frames
  std::optional<double> loop_gap_median_s, loop_gap_max_s;
  std::vector<std::string> playback_errors;
  std::string input;  ///< "mouse", "keyboard" or "touch"
  Encoding encoding = Encoding::mp4;
  int window_width_px = 0, window_height_px = 0;  ///< CSS pixels, as all of these
  int clip_width_px = 0, clip_height_px = 0;
  int screen_width_px = 0, screen_height_px = 0;
  double device_pixel_ratio = 1;
  // What a study can ask besides (trial_options.h).
  std::optional<int> preference;  ///< from -3, left by far, to 3, right by far; 0: a tie
  std::optional<int> confidence;  ///< from 1
  std::string reason;             ///< empty: none
  std::optional<Where> where;     ///< where it looks wrong

  friend bool operator==(const TrialAnswer&, const TrialAnswer&) = default;
};

struct AnsweredTrial {
  std::string shown_utc;
  TrialAnswer answer;
};

struct Session {
  std::string id;             ///< opaque, public name of the participant
  std::string secret_sha256;  ///< of what proves who asks
  std::uint64_t number = 0;   ///< that the plan was counterbalanced by
  std::uint64_t seed = 0;
  Recruited recruited;  ///< what the site that sent the participant says, if one did
  std::string language, user_agent, started_utc, last_seen_utc;
  int resumed_count = 0;
  std::vector<PlannedTrial> plan;
  std::vector<std::string> media;  ///< opaque names of the clips, one a trial
  std::vector<AnsweredTrial> answers;
  std::string shown_utc;  ///< when the current trial's clip began; empty before
  /// part ("before", "after") -> what check_answers() returned
  std::map<std::string, nlohmann::json> questionnaires;
};

bool is_finished(const Session& session);

/// The clip of trial `index` begins. Refused unless it is the current trial.
void show(Session& session, std::size_t index, const std::string& utc);

/// Takes the answer of trial `index`. Refused unless the trial is the current one and was shown;
/// the last answer sent again, unchanged, is accepted and counts once.
void answer(Session& session, std::size_t index, const TrialAnswer& given);

/// The parts of the questionnaires that are still to be answered.
std::vector<std::string> open_questionnaires(const Session& session, const Questionnaires& asked);

/// Takes the answers of a questionnaire: `body` is {"part", "answers"}. Refused (422) if they are
/// not what was asked, (409) before its turn or with other answers than before.
void answer_questionnaire(Session& session, const Questionnaires& asked,
                          const nlohmann::json& body);

/// Reads what a page sent. Throws Refused(422) for unknown or missing keys, wrong types and values
/// outside their ranges. Returns the index of the trial too.
struct SentAnswer {
  std::size_t index = 0;
  TrialAnswer answer;
};
SentAnswer parse_answer(const nlohmann::json& body);

/// Throws Refused(422) if an answer holds what was not asked, or lacks what has to be there.
void check_asked(const TrialAnswer& answer, const TrialOptions& options);

/// The optional texts at the end. Throws Refused(422).
std::map<std::string, std::string> parse_free_text(const nlohmann::json& body);

/// What the site that sent somebody says, under the key `recruited`; nothing without it. Throws
/// Refused(422).
Recruited parse_recruited(const nlohmann::json& body);

/// An answer with the keys that parse_answer reads, but for the trial's index.
nlohmann::ordered_json to_json(const TrialAnswer& answer);

/// A trial of a session's plan as its file keeps it.
nlohmann::json to_json(const PlannedTrial& trial, const std::string& media);

/// A session as its file keeps it, and back. The second throws std::runtime_error if the file is
/// not one of ours.
nlohmann::json to_json(const Session& session);
Session session_from_json(const nlohmann::json& document);

}  // namespace pinchlab::study
