// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The answer file, by which study and analysis meet: one participant, one JSON file
// (analysis/README.md documents every key).

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pinchlab {

/// Left, right, or not recorded.
enum class Side : std::uint8_t { unknown, left, right };

enum class TrialKind { main, training, attention };

/// One pair of clips that was shown, and what the participant did.
struct Trial {
  int position = 0;  ///< place in the session, from 1; training and attention trials count
  TrialKind kind = TrialKind::main;
  std::string demonstration;
  std::string left, right;  ///< "pinch" or "baseline"; attention checks may show "check"
  Side choice = Side::left;
  Side expected = Side::unknown;  ///< attention checks only: the side that a watchful eye picks
  double reaction_time_s = 0.0;   ///< s, from the moment the buttons appear to the choice
  long focus_lost_count = 0;
  long dropped_frames = 0;
  long playback_errors = 0;  ///< how many messages the player gave
};

struct AnswerFile {
  std::string participant;
  std::vector<std::string> planned;  ///< demonstrations of the plan
  int answers_per_demonstration = 1;
  std::vector<Trial> trials;
  std::map<std::string, std::string> free_text;  ///< question -> text
  /// (demonstration, variant) -> hash
  std::map<std::pair<std::string, std::string>, std::string> clips_sha256;
  /// what was asked, told and shown (key -> text or hash); empty in files of older versions
  std::map<std::string, std::string> study;
};

/// Checks one parsed answer file and returns what the analysis needs of it; `file` is for messages.
/// Unknown keys, wrong types and answers that contradict the plan throw InputError.
AnswerFile parse_answer_file(const nlohmann::json& document, const std::string& file);

/// Answers to another question, or to other clips, are not answers to the same question. Watches
/// over files that are read one after the other.
class SameStudy {
 public:
  /// Throws InputError if `file`, called `name`, was asked or shown something else than those
  /// before it.
  void check(const AnswerFile& file, const std::string& name);

 private:
  std::map<std::string, std::string> study_;
  std::string study_of_;  // the first file; empty before
  // (demonstration, variant) -> hash, file
  std::map<std::pair<std::string, std::string>, std::pair<std::string, std::string>> clips_;
};

}  // namespace pinchlab
