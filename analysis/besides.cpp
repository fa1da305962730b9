// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/besides.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "analysis/clustered.h"
#include "base/text_checks.h"

namespace pinchlab::analysis {
namespace {

// In the order of people.
struct Natural {
  std::string text;
  bool operator<(const Natural& other) const { return natural_less(text, other.text); }
};

// Of rows: demonstration, level, and what is told apart besides.
using RowOrder = std::tuple<Natural, double, Natural>;

RowOrder order_of(const BesidesAnswer& answer, const std::string& last) {
  return {{answer.demonstration}, answer.level.value_or(0), {last}};
}

// Sum and number of one participant's figures.
struct Sum {
  double sum = 0;
  std::size_t count = 0;
  void add(double value) { sum += value, ++count; }
};
using ByParticipant = std::map<std::string, Sum>;

struct MeanAndInterval {
  Estimate mean, low, high;
};

// Student's t over the participants' values.
MeanAndInterval mean_of(const std::vector<double>& values, double alpha) {
  MeanAndInterval result;
  if (values.empty()) {
    result.mean = result.low = result.high =
        Estimate::none("no participant has answers of both kinds");
    return result;
  }
  const auto n = static_cast<double>(values.size());
  double sum = 0;
  for (const double value : values) sum += value;
  const double mean = sum / n;
  result.mean = mean;
  if (values.size() == 1) {
    result.low = result.high =
        Estimate::none("one participant; nothing is known of how participants differ");
    return result;
  }
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  if (squares < 1e-20 * n * std::max(1.0, mean * mean)) {
    result.low = result.high = Estimate::none("participants do not differ at all");
    return result;
  }
  const double half = gsl_cdf_tdist_Qinv(alpha / 2, n - 1) * std::sqrt(squares / (n - 1) / n);
  result.low = mean - half;
  result.high = mean + half;
  return result;
}

std::vector<double> means(const ByParticipant& sums) {
  std::vector<double> values;
  for (const auto& [participant, sum] : sums) {
    values.push_back(sum.sum / static_cast<double>(sum.count));
  }
  return values;
}

// What most of the other participants chose, of each question.
class Majorities {
 public:
  explicit Majorities(const std::vector<BesidesAnswer>& answers) {
    for (const BesidesAnswer& answer : answers) {
      if (answer.chosen.empty()) continue;
      const int sign = answer.chosen == answer.first ? 1 : -1;
      all_[key(answer)] += sign;
      own_[{key(answer), answer.participant}] += sign;
    }
  }
  // Nothing for a tie, or where the others are divided.
  [[nodiscard]] std::optional<bool> is_with(const BesidesAnswer& answer) const {
    if (answer.chosen.empty()) return std::nullopt;
    const long others = all_.at(key(answer)) - own_.at({key(answer), answer.participant});
    if (others == 0) return std::nullopt;
    return (others > 0) == (answer.chosen == answer.first);
  }

 private:
  using Key = std::tuple<std::string, std::string, std::string>;
  static Key key(const BesidesAnswer& answer) {
    return {stimulus_of(answer), answer.first, answer.second};
  }
  std::map<Key, long> all_;
  std::map<std::pair<Key, std::string>, long> own_;
};

// One row of the table, as it is added up.
struct RowSums {
  std::size_t answers = 0;
  ByParticipant all, with, against;
  void add(const BesidesAnswer& answer, std::optional<bool> is_with) {
    ++answers;
    all[answer.participant].add(*answer.confidence);
    if (is_with) (*is_with ? with : against)[answer.participant].add(*answer.confidence);
  }
  [[nodiscard]] ConfidenceRow row(const std::string& name, double alpha) const {
    const MeanAndInterval mean = mean_of(means(all), alpha);
    return {name,
            answers,
            mean.mean,
            mean.low,
            mean.high,
            mean_of(means(with), alpha).mean,
            mean_of(means(against), alpha).mean};
  }
};

// Pairs of one answer of each kind: in how many the one with the reference was given with more
// confidence, minus with less.
struct Pairs {
  long difference = 0, count = 0;
  void add(const std::vector<int>& with, const std::vector<int>& against) {
    for (const int a : with) {
      for (const int b : against) difference += a > b ? 1 : a < b ? -1 : 0;
    }
    count += static_cast<long>(with.size() * against.size());
  }
};

std::string pair_of(const BesidesAnswer& answer) {
  return answer.first + ", " + answer.second;
}

Confidence confidence_of(const std::vector<BesidesAnswer>& answers, double alpha) {
  Confidence result;
  result.is_of_hits = answers.front().is_hit.has_value();
  const Majorities majorities(answers);
  std::map<std::string, std::set<std::string>> pairs_of;
  for (const BesidesAnswer& answer : answers) {
    pairs_of[answer.demonstration].insert(pair_of(answer));
  }
  const bool several = std::ranges::any_of(
      pairs_of, [](const auto& stimulus) { return stimulus.second.size() > 1; });
  std::map<RowOrder, std::pair<std::string, RowSums>> rows;  // with their names
  RowSums all;
  // participant -> what is compared with one another -> confidences with and against
  using Stratum = std::pair<std::string, double>;  // series and level
  std::map<std::string, std::map<Stratum, std::pair<std::vector<int>, std::vector<int>>>> kinds;
  for (const BesidesAnswer& answer : answers) {
    if (!answer.confidence) continue;
    const std::optional<bool> is_with =
        result.is_of_hits ? answer.is_hit : majorities.is_with(answer);
    auto& [name, sums] = rows[order_of(answer, several ? pair_of(answer) : "")];
    name = stimulus_of(answer) + (several ? ": " + pair_of(answer) : "");
    sums.add(answer, is_with);
    all.add(answer, is_with);
    if (!is_with) continue;
    const Stratum stratum = answer.level ? Stratum{answer.demonstration, *answer.level} : Stratum{};
    auto& [with, against] = kinds[answer.participant][stratum];
    (*is_with ? with : against).push_back(*answer.confidence);
  }
  for (const auto& [order, row] : rows) result.rows.push_back(row.second.row(row.first, alpha));
  result.rows.push_back(all.row("all", alpha));
  std::vector<double> scores;
  for (const auto& [participant, strata] : kinds) {
    Pairs pairs;
    for (const auto& [stratum, both] : strata) pairs.add(both.first, both.second);
    if (pairs.count > 0) {
      scores.push_back(static_cast<double>(pairs.difference) / static_cast<double>(pairs.count));
    }
  }
  result.test = signed_rank_test(scores);
  if (scores.empty()) {
    result.test.p = result.test.p_sign = Estimate::none("no participant has answers of both kinds");
  }
  for (double& score : scores) score = (1 + score) / 2;
  const MeanAndInterval area = mean_of(scores, alpha);
  result.area = area.mean;
  result.area_low = area.low ? Estimate(std::max(0.0, area.low.value)) : area.low;
  result.area_high = area.high ? Estimate(std::min(1.0, area.high.value)) : area.high;
  return result;
}

Places places_of(const std::vector<BesidesAnswer>& answers, std::uint64_t seed) {
  Places result;
  std::map<RowOrder, PlaceRow> rows;
  std::map<RowOrder, std::set<std::string>> people;
  std::set<std::string> clips;
  for (const BesidesAnswer& answer : answers) {
    ++result.answers;
    for (const std::string& clip : {answer.first, answer.second}) {
      clips.insert(clip);
      PlaceRow& row = rows[order_of(answer, clip)];
      row.stimulus = stimulus_of(answer);
      row.clip = clip;
      ++row.shown;
    }
    if (!answer.place) continue;
    ++result.clicks;
    const RowOrder order = order_of(answer, answer.place->clip);
    rows[order].clicks.push_back(*answer.place);
    people[order].insert(answer.participant);
  }
  for (auto& [order, row] : rows) {
    row.participants = people[order].size();
    result.rows.push_back(std::move(row));
  }
  if (clips.size() != 2) {
    result.p_sign_flip = Estimate::none("more than two kinds of clips were shown");
    return result;
  }
  result.first = *clips.begin();
  result.second = *clips.rbegin();
  std::map<std::string, std::int64_t> scores;
  for (const BesidesAnswer& answer : answers) {
    if (!answer.place) continue;
    const bool is_first = answer.place->clip == result.first;
    ++(is_first ? result.on_first : result.on_second);
    scores[answer.participant] += is_first ? 1 : -1;
  }
  std::vector<std::int64_t> values;
  values.reserve(scores.size());
  for (const auto& [participant, score] : scores) values.push_back(score);
  result.p_sign_flip = sign_flip_test(std::move(values), RandomUse::sign_flip, seed).p;
  return result;
}

}  // namespace

std::string stimulus_of(const BesidesAnswer& answer) {
  return answer.level ? fmt::format("{} at {}", answer.demonstration, *answer.level)
                      : answer.demonstration;
}

std::vector<BesidesAnswer> besides_of(const AnswerFile& file) {
  std::vector<BesidesAnswer> answers;
  for (const Trial& trial : file.trials) {
    if (trial.kind != TrialKind::main) continue;
    const auto side = [&](Side which) { return which == Side::left ? trial.left : trial.right; };
    BesidesAnswer& answer = answers.emplace_back();
    answer.participant = file.participant;
    answer.demonstration = trial.demonstration;
    std::tie(answer.first, answer.second) = std::minmax(trial.left, trial.right);
    if (trial.choice != Side::unknown) answer.chosen = side(trial.choice);
    if (!file.graded_hit.empty()) {
      answer.level = trial.level;
      answer.is_hit = answer.chosen == file.graded_hit;
    }
    answer.confidence = trial.confidence;
    if (trial.where) {
      answer.place = {side(trial.where->side), trial.where->x, trial.where->y, trial.where->time_s};
    }
  }
  return answers;
}

Besides analyse_besides(std::vector<BesidesAnswer> answers, double alpha, std::uint64_t seed) {
  Besides besides;
  // So that sums do not depend on the order of the inputs.
  const auto key = [](const BesidesAnswer& a) {
    const ClickedPlace place = a.place.value_or(ClickedPlace{});
    return std::tuple(a.participant, a.demonstration, a.level, a.first, a.second, a.chosen,
                      a.confidence, place.clip, place.x, place.y, place.time_s);
  };
  std::ranges::sort(answers, {}, key);
  const auto is_any = [&](const auto& has) { return std::ranges::any_of(answers, has); };
  if (is_any([](const BesidesAnswer& a) { return a.confidence.has_value(); })) {
    besides.confidence = confidence_of(answers, alpha);
  }
  if (is_any([](const BesidesAnswer& a) { return a.place.has_value(); })) {
    besides.places = places_of(answers, seed);
  }
  if (besides.confidence || besides.places) besides.answers = std::move(answers);
  return besides;
}

}  // namespace pinchlab::analysis
