// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the answers so far hold, for the researcher's page: how many there are, the sides that were
// chosen, what calls for a look; which method was chosen only if asked for.

#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

namespace pinchlab::study {

class Results {
 public:
  explicit Results(std::filesystem::path answers) : answers_(std::move(answers)) {}

  /// `{finished, demonstrations: [{name, answers, left}], sides: {left, right}, warnings: [{code,
  /// participant, value}]}`; with `reveal` demonstrations also hold `chosen`, by what was chosen,
  /// or `levels`. Warnings: dropped_frames (share of all, over 0.02), small_clip (shown less than
  /// 900 CSS pixels wide), failed_check (how many), one_side (share, of eight answers and more, 0.9
  /// and over), focus_lost (times, over 5), versions (of the page's program; of no participant),
  /// no_answer_file (why not; of a file's name), which counts for nothing else. Answer files are
  /// read once. Safe to use from many threads.
  nlohmann::json read(bool reveal);

 private:
  std::filesystem::path answers_;
  std::mutex mutex_;
  std::map<std::string, nlohmann::json> summaries_;  // of an answer file, by its name
};

}  // namespace pinchlab::study
