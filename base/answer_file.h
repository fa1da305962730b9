// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The answer file, by which study and analysis meet: one participant, one JSON file
// (analysis/README.md documents every key).

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace pinchlab {

/// Left, right, or not recorded.
enum class Side : std::uint8_t { unknown, left, right };

enum class TrialKind { main, training, attention };

/// A click on where it looks wrong.
struct WherePlace {
  Side side = Side::left;  ///< whose clip
  double x = 0, y = 0;     ///< shares of that clip's width and height, from its upper left corner
  double time_s = 0;       ///< of the clip
};

/// One pair of clips that was shown, and what the participant did.
struct Trial {
  int position = 0;  ///< place in the session, from 1; training and attention trials count
  TrialKind kind = TrialKind::main;
  std::string demonstration;
  /// "pinch" and "baseline", or methods of the plan, or "reference" and "graded"; attention checks
  /// may show "check"
  std::string left, right;
  double level = 0.0;             ///< of the graded clip, in studies of thresholds
  Side choice = Side::left;       ///< unknown: a tie, where preferences are graded
  std::optional<int> preference;  ///< from -3, left by far, to 3, right by far, where it is graded
  Side expected = Side::unknown;  ///< attention checks only: the side that a watchful eye picks
  double reaction_time_s = 0.0;   ///< s, from the moment the buttons appear to the choice
  long focus_lost_count = 0;
  long dropped_frames = 0;
  long frame_count = 0;      ///< that the browser decoded, dropped ones among them
  long playback_errors = 0;  ///< how many messages the player gave
  int clip_width_px = 0;     ///< both clips together, CSS px; 0: not recorded
  int screen_width_px = 0, screen_height_px = 0;  ///< CSS px; 0: not recorded
  std::optional<int> confidence;                  ///< from 1, where it is asked
  std::optional<WherePlace> where;
};

struct AnswerFile {
  std::string participant;
  bool is_pilot = false;             ///< an answer of a trial run: never analysed with the rest
  std::vector<std::string> planned;  ///< demonstrations of the plan
  int answers_per_demonstration = 1;
  std::vector<std::string> methods;  ///< that are compared; empty: pinch with its baseline
  std::string
      graded_hit;  ///< "reference" or "graded": what it is a hit to choose; empty: no levels
  std::vector<Trial> trials;
  std::map<std::string, std::string> free_text;  ///< question -> text
  /// (demonstration, variant) -> hash
  std::map<std::pair<std::string, std::string>, std::string> clips_sha256;
  double refresh_rate_hz = 0;  ///< of the screen; 0: not measured
  /// what was asked, told and shown (key -> text or hash); empty in files of older versions
  std::map<std::string, std::string> study;
};

/// Does a screen that is redrawn `hz` times a second show each of 60 frames a second equally often?
/// Within 2 %, which is more than browsers' clocks are off.
bool shows_60_evenly(double hz);

/// The JSON of an answer file, or of a session that will be one. Throws InputError if it is none,
/// or larger than an answer file can be.
nlohmann::json read_answer_json(const std::filesystem::path& path);

/// Checks one parsed answer file and returns what the analysis needs of it; `file` is for messages.
/// Unknown keys, wrong types and answers that contradict the plan throw InputError.
AnswerFile parse_answer_file(const nlohmann::json& document, const std::string& file);

/// What the answers of a study are about.
enum class AnswersKind { none, two_methods, comparisons, graded };

/// Of an answer file (.json), or of the first one of a folder; `none` if there is none, or it is
/// not one (which whoever reads it then tells).
AnswersKind kind_of_answers(const std::filesystem::path& path);

/// The answer files of a folder, in order of their names: every *.json but hidden ones and the
/// description that the Psych-DS layout puts there.
std::vector<std::filesystem::path> answer_files(const std::filesystem::path& folder);

/// The same. Throws InputError if there are none.
std::vector<std::filesystem::path> files_of_folder(const std::filesystem::path& folder);

class SameStudy;

struct NamedAnswerFile {
  std::string name;  ///< of the file, for messages
  AnswerFile file;
};

/// Reads an answer file, or all of a folder, but those of participants who are `excluded`. Throws
/// InputError if they are not of one study (`same_study`), or a participant gave more answers than
/// planned, or fewer without `allow_missing`.
std::vector<NamedAnswerFile> read_answer_files(
    const std::filesystem::path& path, bool allow_missing, SameStudy& same_study,
    const std::function<bool(const std::string&)>& excluded);

/// Answers to another question, or to other clips, are not answers to the same question, and those
/// of a pilot are not the study's. Watches over files that are read one after the other.
class SameStudy {
 public:
  /// Throws InputError if `file`, called `name`, was asked or shown something else than those
  /// before it, if one of them is of a pilot, or if it is of the same participant.
  void check(const AnswerFile& file, const std::string& name);

  /// The same for an answer of a table, of which no more is known than whether it is of a pilot.
  void check_pilot(bool is_pilot, const std::string& place);

  [[nodiscard]] bool is_pilot() const { return is_pilot_; }

 private:
  std::map<std::string, std::string> study_;
  bool is_pilot_ = false;
  std::vector<std::string> methods_;
  std::string graded_hit_;
  std::string study_of_, pilot_of_;             // the first file, or place; empty before
  std::map<std::string, std::string> file_of_;  // participant -> file
  // (demonstration, variant) -> hash, file
  std::map<std::pair<std::string, std::string>, std::pair<std::string, std::string>> clips_;
};

}  // namespace pinchlab
