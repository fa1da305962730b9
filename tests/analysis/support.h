// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Temporary folders and ready-made inputs for the tests of the analysis.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/answers_table.h"
#include "analysis/pages.h"
#include "analysis/report.h"
#include "tests/base/temporary_folder.h"

namespace pinchlab::analysis {

/// A report's page as Markdown, without figures.
inline std::string report_markdown(const Report& report, const AnswersTable& table) {
  return markdown_page(make_document(report, table), {});
}

}  // namespace pinchlab::analysis

namespace pinchlab::analysis::test {

namespace fs = std::filesystem;

using pinchlab::test::TemporaryFolder;

inline std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The counts of the thesis' Table 5.3: how often cable was chosen of 16.
inline const std::vector<int> thesis_cable{1, 4, 2, 3, 3, 3, 10, 6};

inline std::string thesis_counts_csv() {
  std::string csv = "demonstration,pinch,cable\n";
  for (size_t j = 0; j < thesis_cable.size(); ++j) {
    csv += fmt::format("{},{},{}\n", j + 1, 16 - thesis_cable[j], thesis_cable[j]);
  }
  return csv;
}

/// Rows of the clustered data set with the thesis' margins: in demonstration j the cable is chosen
/// by participants ((5j + 3t) mod 16) + 1, t = 0 .. c_j - 1.
inline std::vector<std::string> clustered_rows() {
  std::vector<std::string> rows;
  for (int j = 1; j <= 8; ++j) {
    std::vector<bool> cable(17, false);
    for (int t = 0; t < thesis_cable[static_cast<size_t>(j - 1)]; ++t) {
      cable[static_cast<size_t>((5 * j + 3 * t) % 16 + 1)] = true;
    }
    for (int p = 1; p <= 16; ++p) {
      rows.push_back(
          fmt::format("p{:02},{},{}\n", p, j, cable[static_cast<size_t>(p)] ? "cable" : "pinch"));
    }
  }
  return rows;
}

inline std::string tidy_csv(const std::vector<std::string>& rows) {
  std::string csv = "participant,demonstration,choice\n";
  for (const std::string& row : rows) csv += row;
  return csv;
}

/// Reads CSV text as if it came from a file.
inline AnswersTable table_of(const std::string& csv, const ReadOptions& options = {}) {
  const TemporaryFolder folder;
  return read_answers({folder.write("input.csv", csv)}, options);
}

inline AnswersTable clustered_table() {
  return table_of(tidy_csv(clustered_rows()));
}

/// A whole answer file with every key that the format knows.
inline nlohmann::json answer_document(const std::string& participant = "p-1") {
  nlohmann::json document = nlohmann::json::parse(R"({
    "format": "pinchlab-answers", "version": 1, "participant": "", "participant_number": 3, "seed": 20261120,
    "plan": {"demonstrations": ["01-roll-over", "07-driven-roller"], "answers_per_demonstration": 1,
             "both_orders": false, "training_trials": 1, "attention_checks": 1},
    "started_utc": "2026-11-20T12:00:00Z", "saved_utc": "2026-11-20T12:04:31.250Z",
    "software_version": "0.1.0", "language": "en", "user_agent": "Mozilla/5.0", "resumed_count": 0, "pilot": false,
    "questionnaires": {"before": {"age": {"question": "How old are you?", "answer": 44}}},
    "recruited": {"participant": "5f0abc", "study": "s-1", "session": "t-1"},
    "clips_sha256": {"01-roll-over": {}}, "trials": [],
    "free_text": {"common_details": "The cable, it \"clips\" <through>.", "thoughts": ""}
  })");
  document["participant"] = participant;
  document["withdrawal_code_sha256"] = std::string(64, 'a');
  document["clips_sha256"]["01-roll-over"]["pinch_left"] = std::string(64, '0');
  document["study"] = {{"language", "en"},
                       {"question", "Which of the two looks more real?"},
                       {"consent_sha256", std::string(64, 'b')},
                       {"texts_sha256", std::string(64, 'c')},
                       {"clips_sha256", std::string(64, 'd')}};
  const auto trial = [&](int position, const char* kind, const char* demonstration,
                         const char* left, const char* right, const char* choice) {
    document["trials"].push_back({{"position", position},
                                  {"kind", kind},
                                  {"demonstration", demonstration},
                                  {"left", left},
                                  {"right", right},
                                  {"choice", choice},
                                  {"reaction_time_s", 1.5 + position},
                                  {"loops_watched", 2},
                                  {"focus_lost_count", 0},
                                  {"frame_count", 900},
                                  {"dropped_frames", 1},
                                  {"loop_gap_median_s", -0.001},
                                  {"loop_gap_max_s", 0.017},
                                  {"playback_errors", nlohmann::json::array()},
                                  {"clip", "7c1f.mp4"},
                                  {"shown_utc", "2026-11-20T12:01:00Z"},
                                  {"input", "mouse"},
                                  {"window_width_px", 1920},
                                  {"window_height_px", 1080},
                                  {"clip_width_px", 1800},
                                  {"clip_height_px", 506},
                                  {"screen_width_px", 1920},
                                  {"screen_height_px", 1080},
                                  {"device_pixel_ratio", 1.0}});
  };
  trial(1, "training", "00-warm-up", "pinch", "baseline", "left");
  trial(2, "main", "07-driven-roller", "baseline", "pinch", "left");
  trial(3, "attention", "check-1", "check", "pinch", "right");
  trial(4, "main", "01-roll-over", "pinch", "baseline", "left");
  document["trials"][2]["expected"] = "right";
  return document;
}

}  // namespace pinchlab::analysis::test
