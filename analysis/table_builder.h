// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Collects answers from any number of inputs and turns them into a checked AnswersTable.

#include <algorithm>
#include <iterator>
#include <optional>
#include <string_view>
#include <unordered_map>

#include "analysis/answers_table.h"

namespace pinchlab::analysis {

/// What one row or trial says, still in words.
struct RawAnswer {
  std::string_view participant;
  std::string_view demonstration;
  std::string_view group;  ///< empty: not given
  bool chose_pinch = false;
  std::optional<int> grade;  ///< as GradedAnswer::grade; none: was not graded
  Side pinch_side = Side::unknown;
  int position = 0;               ///< from 1; 0: not recorded
  double reaction_time_s = -1.0;  ///< -1: not recorded
};

class TableBuilder {
 public:
  /// Participants on `exclusions` are left out wherever they turn up (and must turn up).
  TableBuilder(std::vector<Exclusion> exclusions, bool allow_missing);

  /// Starts a new input file: what is added from now on comes from there.
  void begin_source(const std::string& name);

  /// Is this participant to be left out? (Remembers that the exclusion was of use.)
  bool excluded(std::string_view participant);

  /// An answer; a tie, whose grade is 0, is kept among the grades alone.
  void add_answer(const RawAnswer& answer, size_t line);
  void add_besides(std::vector<BesidesAnswer> answers) {
    std::ranges::move(answers, std::back_inserter(table_.besides));
  }
  void add_counts(std::string_view demonstration, std::string_view group, Counts counts,
                  size_t line);
  void add_attention_check(std::string_view participant, bool passed);

  /// The session record of a participant, to be filled by the reader of answer files.
  Session& session(std::string_view participant);
  void note_session_records() { table_.has_session_records = true; }

  /// The number of answers that every participant must give to each demonstration; inputs that
  /// differ throw, `place` says where.
  void expect_answers_per_demonstration(int count, const std::string& place);

  /// Checks the whole, sorts it and gives it away. Groups are set by assign_groups.
  AnswersTable finish();

  /// demonstration name -> group name, from a `group` column.
  [[nodiscard]] const std::map<std::string, std::string>& column_groups() const {
    return column_groups_;
  }

 private:
  struct NameHash {
    using is_transparent = void;
    size_t operator()(std::string_view name) const { return std::hash<std::string_view>{}(name); }
  };
  using Index = std::unordered_map<std::string, std::uint32_t, NameHash, std::equal_to<>>;

  void add_grade(const RawAnswer& answer);
  std::uint32_t participant_index(std::string_view name);
  std::uint16_t demonstration_index(std::string_view name, std::string_view group, size_t line);
  void check_kind(bool counts, size_t line);
  [[nodiscard]] std::string place(size_t line) const;
  [[nodiscard]] std::string place_of(const Answer& answer) const;
  void sort_names();
  void check_doubles() const;
  void check_places_of_ties() const;
  void check_times(const std::string& participant, const std::vector<std::size_t>& times,
                   const std::vector<std::string>& demonstrations, const std::string& where);
  void check_missing();
  void check_exclusions() const;

  AnswersTable table_;
  Index participants_;
  Index demonstrations_;
  std::map<std::string, std::string> column_groups_;
  std::map<std::string, bool, std::less<>> excluded_;  // participant -> seen in an input?
  std::map<std::string, std::map<std::string, std::size_t>> ties_;  // of each, by demonstration
  bool allow_missing_;
  std::string expected_from_;  // the place that set answers_per_demonstration
  std::uint32_t last_participant_ = 0;
  std::vector<std::uint32_t> first_line_;  // of each source, as Answer::line counts
  std::uint32_t next_line_ = 0;
};

}  // namespace pinchlab::analysis
