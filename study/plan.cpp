// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>

#include "study/plan_random.h"
#include "study/sides.h"

namespace pinchlab::study {
namespace {

// Row of a Williams square: 0, n-1, 1, n-2, ... shifted by `row`. Every symbol stands once in every
// column; for even n every symbol also follows every other in one row.
std::size_t williams(std::size_t row, std::size_t column, std::size_t n) {
  const std::size_t zigzag = column % 2 == 0 ? column / 2 : n - (column + 1) / 2;
  return (row + zigzag) % n;
}

// One round of n participants: orders[participant in block][position] is a demonstration.
using Square = std::vector<std::vector<std::size_t>>;

Square shuffled_square(Random& labels, Random& rows, std::size_t n) {
  const std::vector<std::size_t> label = labels.permutation(n);
  const std::vector<std::size_t> row = rows.permutation(n);
  Square square(n, std::vector<std::size_t>(n));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      square[i][j] = label[williams(row[i], j, n)];
    }
  }
  return square;
}

// For odd n each demonstration follows every other equally often only in the square and its mirror
// together (Williams 1949).
Square mirrored(Square square) {
  for (auto& row : square) {
    std::ranges::reverse(row);
  }
  return square;
}

bool repeats_at_once(const Square& before, const Square& after) {
  for (std::size_t i = 0; i < before.size(); ++i) {
    const bool repeats = before[i].back() == after[i].front();
    const bool repeats_in_mirror = before[i].front() == after[i].back();
    if (repeats || (before.size() % 2 == 1 && repeats_in_mirror)) {
      return true;
    }
  }
  return false;
}

// The squares of all rounds of a block; of a pair of blocks for odd n. A square that would show
// somebody the same demonstration twice running is drawn again; about one in three passes for
// even n, and the square of the round before always would.
std::vector<Square> squares(std::uint64_t seed, std::uint64_t block, int rounds, std::size_t n) {
  const bool is_odd = n % 2 == 1;
  const std::uint64_t drawn_for = is_odd ? block / 2 : block;
  Random labels(seed, Purpose::labels, drawn_for);
  Random rows(seed, Purpose::rows, drawn_for);
  std::vector<Square> result;
  for (int round = 0; round < rounds; ++round) {
    Square square = shuffled_square(labels, rows, n);
    while (round > 0 && n > 1 && repeats_at_once(result.back(), square)) {
      square = shuffled_square(labels, rows, n);
    }
    result.push_back(std::move(square));
  }
  if (is_odd && block % 2 == 1) {
    std::ranges::transform(result, result.begin(), mirrored);
  }
  return result;
}

Orders orders_of(std::uint64_t seed, std::uint64_t number, int rounds, std::size_t n) {
  Orders orders;
  for (const Square& square : squares(seed, number / n, rounds, n)) {
    orders.push_back(square[number % n]);
  }
  return orders;
}

Side side_of(bool is_right) {
  return is_right ? Side::right : Side::left;
}

// Demonstrations, or graded clips, each once a round.
std::vector<PlannedTrial> main_trials(std::uint64_t seed, std::uint64_t number,
                                      const PlanOptions& options) {
  const bool is_graded = !options.graded.empty();
  const std::size_t n = is_graded ? options.graded.size() : options.demonstrations.size();
  const int rounds = options.repetitions * (options.both_orders ? 2 : 1);
  const std::uint64_t pair = number / 2;
  const bool is_second_of_pair = number % 2 == 1;
  const std::array<Orders, 2> orders_of_both = {orders_of(seed, 2 * pair, rounds, n),
                                                orders_of(seed, 2 * pair + 1, rounds, n)};
  const Orders& orders = orders_of_both[is_second_of_pair ? 1 : 0];
  const auto sides = sides_of_pair(seed, pair, orders_of_both, options.both_orders);
  std::vector<PlannedTrial> trials;
  for (std::size_t round = 0; round < sides.size(); ++round) {
    for (const std::size_t i : orders[round]) {
      PlannedTrial trial;
      trial.pinch = side_of(sides[round][i] != is_second_of_pair);
      trial.round = static_cast<int>(round);
      if (is_graded) {
        trial.demonstration = options.graded[i].series;
        trial.level = options.graded[i].level;
        trial.first = "reference";
        trial.second = "graded";
      } else {
        trial.demonstration = options.demonstrations[i];
      }
      trials.push_back(std::move(trial));
    }
  }
  return trials;
}

std::vector<PlannedTrial> adaptive_trials(std::uint64_t seed, std::uint64_t number,
                                          const PlanOptions& options) {
  const std::size_t n = options.demonstrations.size();
  const Orders orders = orders_of(seed, number, options.adaptive_trials, n);
  const std::vector<bool> sides = sides_in_eights(seed, number, n * orders.size());
  std::vector<PlannedTrial> trials;
  for (std::size_t round = 0; round < orders.size(); ++round) {
    for (const std::size_t i : orders[round]) {
      trials.push_back({TrialKind::main, options.demonstrations[i], side_of(sides[trials.size()]),
                        static_cast<int>(round), "reference", "graded"});
    }
  }
  return trials;
}

using Edge = std::pair<std::size_t, std::size_t>;

// Turns each edge of a graph so that every vertex has as many that begin there as end there, or one
// more of either: walks along unused edges until it is stuck, which, once the vertices of odd
// degree are joined to one more vertex, can only be where it began (Euler 1736). Returns for each
// edge whether it is turned round.
std::vector<bool> balanced_turns(const std::vector<Edge>& given, std::size_t vertices,
                                 Random& random) {
  std::vector<Edge> edges = given;
  std::vector<std::vector<std::size_t>> at(vertices + 1);  // edges by vertex
  std::vector<std::size_t> degree(vertices);
  for (const auto& [a, b] : edges) {
    ++degree[a];
    ++degree[b];
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    if (degree[v] % 2 == 1) edges.emplace_back(v, vertices);
  }
  for (const std::size_t i : random.permutation(edges.size())) {
    at[edges[i].first].push_back(i);
    at[edges[i].second].push_back(i);
  }
  std::vector<bool> used(edges.size()), turned(edges.size());
  for (std::size_t start = 0; start <= vertices; ++start) {
    const bool backwards = random.coin();
    for (std::size_t v = start; !at[v].empty();) {
      const std::size_t i = at[v].back();
      at[v].pop_back();
      if (used[i]) continue;
      used[i] = true;
      const bool is_against = edges[i].first != v;
      turned[i] = is_against != backwards;
      v = is_against ? edges[i].first : edges[i].second;
    }
  }
  turned.resize(given.size());
  return turned;
}

// The pairs of methods that two participants see: pairs[demonstration][round], and whether the
// second of the two stands on the left for the first participant.
struct ShownPair {
  Edge methods;
  bool is_turned = false;
};

std::vector<std::vector<ShownPair>> pairs_of_couple(std::uint64_t seed, std::uint64_t couple,
                                                    const PlanOptions& options) {
  const std::size_t m = options.methods.size();
  const std::vector<Edge> all = tournament(m);
  const auto shown = static_cast<std::size_t>(answers_per_demonstration(options));
  const std::uint64_t block = couple / all.size();
  const std::vector<std::size_t> label = Random(seed, Purpose::pair_methods, block).permutation(m);
  const std::size_t row =
      Random(seed, Purpose::pair_rows, block).permutation(all.size())[couple % all.size()];
  std::vector<std::vector<ShownPair>> result(options.demonstrations.size());
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < result.size(); ++i) {
    for (std::size_t t = 0; t < shown; ++t) {
      const auto& [a, b] = all[((i + row) * shown + t) % all.size()];
      result[i].push_back({std::minmax(label[a], label[b]), false});
      edges.push_back(result[i].back().methods);
    }
  }
  Random sides(seed, Purpose::pair_sides, couple);
  const std::vector<bool> turned = balanced_turns(edges, m, sides);
  for (std::size_t i = 0; i < edges.size(); ++i) result[i / shown][i % shown].is_turned = turned[i];
  return result;
}

std::vector<PlannedTrial> comparison_trials(std::uint64_t seed, std::uint64_t number,
                                            const PlanOptions& options) {
  const std::size_t n = options.demonstrations.size();
  const int rounds = answers_per_demonstration(options);
  const auto pairs = pairs_of_couple(seed, number / 2, options);
  Random order(seed, Purpose::pair_order, number);
  std::vector<std::vector<std::size_t>> which(n);  // of a demonstration's pairs comes in a round
  for (auto& one : which) one = order.permutation(static_cast<std::size_t>(rounds));
  std::vector<PlannedTrial> trials;
  const Orders orders = orders_of(seed, number, rounds, n);
  for (std::size_t round = 0; round < orders.size(); ++round) {
    for (const std::size_t i : orders[round]) {
      const ShownPair& pair = pairs[i][which[i][round]];
      PlannedTrial trial;
      trial.demonstration = options.demonstrations[i];
      trial.first = options.methods[pair.methods.first];
      trial.second = options.methods[pair.methods.second];
      trial.pinch = side_of(pair.is_turned != (number % 2 == 1));
      trial.round = static_cast<int>(round);
      trials.push_back(std::move(trial));
    }
  }
  return trials;
}

// Check i of m goes somewhere into the i-th of m equal parts of the main trials, never first.
void insert_checks(std::vector<PlannedTrial>& trials, std::uint64_t seed, std::uint64_t number,
                   const std::vector<std::string>& checks) {
  Random sides(seed, Purpose::check_sides, number / 2);
  Random places(seed, Purpose::check_places, number);
  const std::size_t main_count = trials.size();
  for (std::size_t i = 0; i < checks.size(); ++i) {
    const std::size_t begin = std::max<std::size_t>(1, main_count * i / checks.size());
    const std::size_t end = std::max(begin + 1, main_count * (i + 1) / checks.size());
    const std::size_t place = std::min(begin + places.below(end - begin), main_count) + i;
    const bool is_right = sides.coin() != (number % 2 == 1);
    trials.insert(trials.begin() + static_cast<std::ptrdiff_t>(place),
                  PlannedTrial{TrialKind::attention, checks[i], side_of(is_right), 0});
  }
}

}  // namespace

const char* to_string(TrialKind kind) {
  return kind == TrialKind::main ? "main" : kind == TrialKind::training ? "training" : "attention";
}

const char* to_string(Side side) {
  return side == Side::left ? "left" : "right";
}

Side opposite(Side side) {
  return side == Side::left ? Side::right : Side::left;
}

std::string clip_key(const GradedClip& clip) {
  return fmt::format("{} @ {}", clip.series, clip.level);
}

std::string clip_key(const PlannedTrial& trial) {
  if (trial.level) return clip_key(GradedClip{trial.demonstration, *trial.level});
  const bool is_plain = trial.first == "pinch" && trial.second == "baseline";
  return is_plain ? trial.demonstration
                  : fmt::format("{}: {} and {}", trial.demonstration, trial.first, trial.second);
}

std::vector<std::pair<std::size_t, std::size_t>> tournament(std::size_t methods) {
  const std::size_t even = methods + methods % 2;  // who meets the one that is not there, rests
  const std::size_t rounds = even - 1;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t round = 0; round < rounds; ++round) {
    if (even == methods) pairs.emplace_back(round, rounds);
    for (std::size_t i = 1; i < even / 2; ++i) {
      pairs.emplace_back((round + i) % rounds, (round + rounds - i) % rounds);
    }
  }
  return pairs;
}

int answers_per_demonstration(const PlanOptions& options) {
  if (!options.methods.empty()) {
    const auto m = static_cast<int>(options.methods.size());
    return options.pairs_per_demonstration > 0 ? options.pairs_per_demonstration : m * (m - 1) / 2;
  }
  if (options.adaptive_trials > 0) return options.adaptive_trials;
  if (!options.graded.empty()) {
    const auto levels = static_cast<int>(options.graded.size() / options.demonstrations.size());
    return levels * options.repetitions * (options.both_orders ? 2 : 1);
  }
  return options.repetitions * (options.both_orders ? 2 : 1);
}

std::vector<PlannedTrial> make_plan(std::uint64_t seed, std::uint64_t number,
                                    const PlanOptions& options) {
  assert(!options.demonstrations.empty());
  std::vector<PlannedTrial> trials =
      options.adaptive_trials > 0 ? adaptive_trials(seed, number, options)
      : options.methods.empty()   ? main_trials(seed, number, options)
                                  : comparison_trials(seed, number, options);
  insert_checks(trials, seed, number, options.attention_checks);
  std::vector<PlannedTrial> plan;
  Random training(seed, Purpose::training, number);
  for (const std::string& name : options.training) {
    plan.push_back(PlannedTrial{TrialKind::training, name, side_of(training.coin()), 0});
  }
  plan.insert(plan.end(), trials.begin(), trials.end());
  return plan;
}

}  // namespace pinchlab::study
