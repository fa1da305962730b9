// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/table_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <tuple>

#include "analysis/csv_columns.h"
#include "base/did_you_mean.h"
#include "base/input_error.h"
#include "base/text_checks.h"

namespace pinchlab::analysis {

namespace {

// Permutation that sorts `names`; afterwards names[i] is the old names[result[i]].
template <class Less>
std::vector<size_t> sort_and_tell(std::vector<std::string>& names, Less less) {
  std::vector<size_t> order(names.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(),
            [&](size_t a, size_t b) { return less(names[a], names[b]); });
  std::vector<std::string> sorted;
  sorted.reserve(names.size());
  for (size_t index : order) sorted.push_back(std::move(names[index]));
  names = std::move(sorted);
  return order;
}

template <class Integer>
std::vector<Integer> inverse(const std::vector<size_t>& order) {
  std::vector<Integer> new_index(order.size());
  for (size_t i = 0; i < order.size(); ++i) new_index[order[i]] = static_cast<Integer>(i);
  return new_index;
}

auto canonical_key(const Answer& a) {
  return std::tie(a.participant, a.demonstration, a.position, a.chose_pinch, a.pinch_side,
                  a.reaction_time_s, a.grade);
}

}  // namespace

TableBuilder::TableBuilder(std::vector<Exclusion> exclusions, bool allow_missing)
    : allow_missing_(allow_missing) {
  table_.exclusions = std::move(exclusions);
  for (const Exclusion& exclusion : table_.exclusions)
    excluded_.emplace(exclusion.participant, false);
}

void TableBuilder::begin_source(const std::string& name) {
  table_.sources.push_back(name);
  first_line_.push_back(next_line_);
}

std::string TableBuilder::place(size_t line) const {
  return fmt::format("{}:{}", table_.sources.back(), line);
}

std::string TableBuilder::place_of(const Answer& answer) const {
  const auto after = std::upper_bound(first_line_.begin(), first_line_.end(), answer.line);
  const auto source = static_cast<size_t>(after - first_line_.begin()) - 1;
  return fmt::format("{}:{}", table_.sources[source], answer.line - first_line_[source] + 1);
}

bool TableBuilder::excluded(std::string_view participant) {
  const auto found = excluded_.find(participant);
  if (found == excluded_.end()) return false;
  found->second = true;
  return true;
}

std::uint32_t TableBuilder::participant_index(std::string_view name) {
  // Files mostly hold the answers of one participant side by side.
  if (last_participant_ < table_.participants.size() &&
      table_.participants[last_participant_] == name) {
    return last_participant_;
  }
  const auto found = participants_.find(name);
  if (found != participants_.end()) return last_participant_ = found->second;
  last_participant_ = static_cast<std::uint32_t>(table_.participants.size());
  participants_.emplace(name, last_participant_);
  table_.participants.emplace_back(name);
  return last_participant_;
}

std::uint16_t TableBuilder::demonstration_index(std::string_view name, std::string_view group,
                                                size_t line) {
  auto found = demonstrations_.find(name);
  if (found == demonstrations_.end()) {
    const size_t index = table_.demonstrations.size();
    if (index >= 10000) {
      throw InputError(place(line), "more than 10000 demonstrations; is the right column read?");
    }
    found = demonstrations_.emplace(name, static_cast<std::uint32_t>(index)).first;
    table_.demonstrations.emplace_back(name);
    table_.counts.emplace_back();
    if (!group.empty()) column_groups_.emplace(name, group);
  } else {
    const auto known = column_groups_.find(found->first);
    const std::string_view before =
        known == column_groups_.end() ? "" : std::string_view(known->second);
    if (before != group) {
      throw InputError(place(line),
                       fmt::format("demonstration `{}` is in group `{}` here but in `{}` "
                                   "further up; a demonstration has one group (or use "
                                   "--groups)",
                                   name, group, before));
    }
  }
  return static_cast<std::uint16_t>(found->second);
}

void TableBuilder::check_kind(bool counts, size_t line) {
  const bool mixed =
      counts ? !table_.answers.empty() : table_.participants.empty() && !table_.counts.empty();
  if (mixed) {
    throw InputError(place(line),
                     "a table of counts cannot be put together with single answers; "
                     "analyse them in two runs");
  }
}

void TableBuilder::add_answer(const RawAnswer& raw, size_t line) {
  check_kind(false, line);
  if (raw.grade) add_grade(raw);
  if (raw.grade == 0) return;
  Answer answer;
  answer.participant = participant_index(raw.participant);
  answer.demonstration = demonstration_index(raw.demonstration, raw.group, line);
  answer.line = first_line_.back() + static_cast<std::uint32_t>(line) - 1;
  next_line_ = answer.line + 1;
  answer.position = static_cast<std::uint16_t>(raw.position);
  answer.chose_pinch = raw.chose_pinch;
  answer.grade = static_cast<std::int8_t>(raw.grade.value_or(0));
  answer.pinch_side = raw.pinch_side;
  answer.reaction_time_s = raw.reaction_time_s;
  table_.answers.push_back(answer);
}

void TableBuilder::add_grade(const RawAnswer& raw) {
  table_.graded.push_back({std::string(raw.participant), std::string(raw.demonstration), *raw.grade,
                           raw.position, raw.pinch_side, raw.reaction_time_s});
  const GradedAnswer& answer = table_.graded.back();
  if (answer.grade == 0) ++ties_[answer.participant][answer.demonstration];
}

void TableBuilder::add_counts(std::string_view demonstration, std::string_view group, Counts counts,
                              size_t line) {
  check_kind(true, line);
  const size_t known = table_.demonstrations.size();
  const std::uint16_t index = demonstration_index(demonstration, group, line);
  if (index < known) {
    throw InputError(place(line), fmt::format("demonstration `{}` is counted twice; give one row a "
                                              "demonstration",
                                              demonstration));
  }
  table_.counts[index] = counts;
}

void TableBuilder::add_attention_check(std::string_view participant, bool passed) {
  Session& record = session(participant);
  ++(passed ? record.attention_passed : record.attention_failed);
}

Session& TableBuilder::session(std::string_view participant) {
  return table_.sessions[participant_index(participant)];
}

void TableBuilder::expect_answers_per_demonstration(int count, const std::string& where) {
  if (!expected_from_.empty() && count != table_.answers_per_demonstration) {
    throw InputError(where,
                     fmt::format("{} answers to each demonstration, but {} in {}; analyse the two "
                                 "designs in two runs",
                                 count, table_.answers_per_demonstration, expected_from_));
  }
  table_.answers_per_demonstration = count;
  expected_from_ = where;
}

void TableBuilder::sort_names() {
  const auto participant =
      inverse<std::uint32_t>(sort_and_tell(table_.participants, std::less<std::string>()));
  const std::vector<size_t> order = sort_and_tell(table_.demonstrations, natural_less);
  const auto demonstration = inverse<std::uint16_t>(order);

  std::vector<Counts> counts;
  counts.reserve(order.size());
  for (size_t index : order) counts.push_back(table_.counts[index]);
  table_.counts = std::move(counts);
  for (Answer& answer : table_.answers) {
    answer.participant = participant[answer.participant];
    answer.demonstration = demonstration[answer.demonstration];
  }
  std::map<std::uint32_t, Session> sessions;
  for (auto& [index, record] : table_.sessions) {
    sessions.emplace(participant[index], std::move(record));
  }
  table_.sessions = std::move(sessions);
  std::sort(table_.answers.begin(), table_.answers.end(),
            [](const Answer& a, const Answer& b) { return canonical_key(a) < canonical_key(b); });
}

// A participant may answer a demonstration as often as the design says, each time at another place
// of the session. Answers are sorted by participant and demonstration here.
void TableBuilder::check_doubles() const {
  const auto limit = static_cast<size_t>(table_.answers_per_demonstration);
  for (size_t i = limit; i < table_.answers.size(); ++i) {
    const Answer& a = table_.answers[i - limit];
    const Answer& b = table_.answers[i];
    if (a.participant != b.participant || a.demonstration != b.demonstration) continue;
    throw InputError(
        place_of(std::max(a, b, [](const Answer& x, const Answer& y) { return x.line < y.line; })),
        fmt::format(
            "participant `{}` answers demonstration `{}` {} ({} and {}), {}; keep one of the "
            "answers, or say with --repetitions how often each pair was shown",
            table_.participants[a.participant], table_.demonstrations[a.demonstration],
            limit == 1 ? "twice" : fmt::format("more than {} times", limit), place_of(a),
            place_of(b),
            a.chose_pinch == b.chose_pinch ? "with the same choice"
                                           : "and the choices contradict each other"));
  }
  // The same place of a session cannot be taken by two answers.
  std::vector<std::pair<std::uint16_t, size_t>> taken;
  for (size_t begin = 0, end = 0; begin < table_.answers.size(); begin = end) {
    taken.clear();
    for (; end < table_.answers.size() &&
           table_.answers[end].participant == table_.answers[begin].participant;
         ++end) {
      if (table_.answers[end].position > 0) taken.emplace_back(table_.answers[end].position, end);
    }
    std::sort(taken.begin(), taken.end());
    for (size_t i = 1; i < taken.size(); ++i) {
      if (taken[i].first != taken[i - 1].first) continue;
      const Answer& b = table_.answers[taken[i].second];
      throw InputError(place_of(b),
                       fmt::format("participant `{}` has two answers at position {} (also {}); "
                                   "positions count the trials of one participant",
                                   table_.participants[b.participant], b.position,
                                   place_of(table_.answers[taken[i - 1].second])));
    }
  }
}

// Nor by a tie.
void TableBuilder::check_places_of_ties() const {
  if (ties_.empty()) return;
  std::set<std::pair<std::string_view, int>> taken;
  for (const Answer& answer : table_.answers)
    taken.emplace(table_.participants[answer.participant], answer.position);
  for (const GradedAnswer& tie : table_.graded) {
    if (tie.grade != 0 || tie.position == 0) continue;
    if (taken.emplace(tie.participant, tie.position).second) continue;
    throw InputError(table_.sources.back(),
                     fmt::format("participant `{}` has two answers at position {}, a tie among "
                                 "them; positions count the trials of one participant",
                                 tie.participant, tie.position));
  }
}

// Whoever has answered must have answered every demonstration as often as the design says, ties
// included; who has not is an error, or is listed.
void TableBuilder::check_times(const std::string& participant, const std::vector<size_t>& times,
                               const std::vector<std::string>& demonstrations,
                               const std::string& where) {
  const auto limit = static_cast<size_t>(table_.answers_per_demonstration);
  const auto more = std::ranges::find_if(times, [&](size_t n) { return n > limit; });
  if (more != times.end()) {
    throw InputError(
        where, fmt::format("participant `{}` answers demonstration `{}` {}, ties among it; keep "
                           "one of the answers, or say with --repetitions how often each pair was "
                           "shown",
                           participant, demonstrations[static_cast<size_t>(more - times.begin())],
                           limit == 1 ? "twice" : fmt::format("more than {} times", limit)));
  }
  const auto fewer = std::ranges::find_if(times, [&](size_t n) { return n < limit; });
  if (fewer == times.end()) return;
  if (!allow_missing_) {
    throw InputError(
        where, fmt::format("participant `{}` gave {} of {} answers; missing: demonstration "
                           "`{}`. Complete the log, leave the participant out with "
                           "--exclude, or pass --allow-missing",
                           participant, std::accumulate(times.begin(), times.end(), size_t{0}),
                           limit * times.size(),
                           demonstrations[static_cast<size_t>(fewer - times.begin())]));
  }
  table_.incomplete.push_back(participant);
}

void TableBuilder::check_missing() {
  // A demonstration of which all answers are ties is in no table, and was shown all the same.
  std::vector<std::string> demonstrations = table_.demonstrations;
  std::map<std::string, size_t> index_of;
  for (size_t i = 0; i < demonstrations.size(); ++i) index_of.emplace(demonstrations[i], i);
  for (const auto& [participant, tied] : ties_) {
    for (const auto& [demonstration, count] : tied) {
      if (index_of.emplace(demonstration, demonstrations.size()).second)
        demonstrations.push_back(demonstration);
    }
  }
  auto ties = ties_;
  std::vector<size_t> times;
  const auto add_ties = [&](const std::string& participant) {
    const auto found = ties.find(participant);
    if (found == ties.end()) return;
    for (const auto& [demonstration, count] : found->second)
      times[index_of[demonstration]] += count;
    ties.erase(found);
  };
  size_t begin = 0;
  for (std::uint32_t p = 0; p < table_.participants.size(); ++p) {
    times.assign(demonstrations.size(), 0);
    size_t end = begin;
    for (; end < table_.answers.size() && table_.answers[end].participant == p; ++end)
      ++times[table_.answers[end].demonstration];
    add_ties(table_.participants[p]);
    check_times(table_.participants[p], times, demonstrations,
                end > begin ? place_of(table_.answers[begin]) : table_.sources.back());
    begin = end;
  }
  while (!ties.empty()) {  // who gave nothing else
    times.assign(demonstrations.size(), 0);
    const std::string participant = ties.begin()->first;
    add_ties(participant);
    check_times(participant, times, demonstrations, table_.sources.back());
  }
}

// A name on the list that nobody bears is most likely a misspelt one, which would quietly stay in.
void TableBuilder::check_exclusions() const {
  for (const auto& [participant, seen] : excluded_) {
    if (seen) continue;
    throw InputError("--exclude",
                     fmt::format("participant `{}` is in no input{}; correct the list or take "
                                 "the row out",
                                 participant, did_you_mean(participant, table_.participants)));
  }
}

AnswersTable TableBuilder::finish() {
  check_exclusions();
  sort_names();
  if (!table_.answers.empty()) {
    check_doubles();
    check_places_of_ties();
    check_missing();
    for (const Answer& answer : table_.answers) {
      Counts& counts = table_.counts[answer.demonstration];
      ++(answer.chose_pinch ? counts.pinch : counts.cable);
    }
  }
  std::int64_t total = 0;
  for (const Counts& counts : table_.counts) total += counts.total();
  if (total == 0) {
    throw InputError(table_.sources.empty() ? "input" : table_.sources.front(),
                     !table_.graded.empty() ? "all answers are ties; a report needs a choice"
                                            : why_nothing_is_left(table_.exclusions));
  }
  if (total > 2000000000) {
    throw InputError(table_.sources.front(),
                     "more than 2000000000 answers; is this a count of answers?");
  }
  return std::move(table_);
}

}  // namespace pinchlab::analysis
