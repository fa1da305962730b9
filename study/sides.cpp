// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/sides.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "study/plan_random.h"

namespace pinchlab::study {
namespace {

using Sides = std::vector<std::vector<bool>>;  // [round][demonstration]

constexpr int longest_run = 3;
constexpr int most_throws = 10000;

// Which side of the method under test comes how often and how often running, in one session.
class SidesSoFar {
 public:
  // False: a fourth time running, and nothing is noted.
  bool add(bool is_right) {
    run_ = count_ > 0 && is_right == last_ ? run_ + 1 : 1;
    last_ = is_right;
    ++count_;
    right_ += is_right ? 1 : 0;
    return run_ <= longest_run;
  }
  // As near to half as the number allows.
  [[nodiscard]] bool is_balanced() const { return std::abs(2 * right_ - count_) <= count_ % 2; }

 private:
  int run_ = 0, count_ = 0, right_ = 0;
  bool last_ = false;
};

// Coins are thrown for a round (for two with both orders, the second with the sides swapped) until
// both participants have each side equally often and no side more than three times running. Turned
// round, sides that pass pass too, so that each side is a fair coin still. So many throws do not
// serve all rounds where there are too many trials, or where a beginning allows no end.
Sides thrown_sides(Random coins, const std::array<Orders, 2>& orders, std::size_t step) {
  const std::size_t rounds = orders[0].size();
  Sides sides;
  std::array<SidesSoFar, 2> so_far;
  std::vector<bool> round(orders[0].front().size());
  for (int throws = 0; throws < most_throws && sides.size() < rounds; ++throws) {
    std::generate(round.begin(), round.end(), [&] { return coins.coin(); });
    std::array<SidesSoFar, 2> next = so_far;
    const auto passes = [&](std::size_t who, std::size_t i) {
      return std::ranges::all_of(orders[who][sides.size() + i], [&](std::size_t demonstration) {
        return next[who].add(round[demonstration] != (who != i));
      });
    };
    bool all_pass = passes(0, 0) && passes(1, 0);
    if (step == 2) all_pass = all_pass && passes(0, 1) && passes(1, 1);
    if (!all_pass || !next[0].is_balanced()) continue;
    so_far = next;
    sides.push_back(round);
    if (step == 2) {
      round.flip();
      sides.push_back(round);
    }
  }
  return sides;
}

// Sides of all rounds at once, changed a few at a time. With both orders a round that follows with
// the sides swapped is no variable of its own.
class Arrangement {
 public:
  Arrangement(Random& random, const std::array<Orders, 2>& orders, std::size_t step)
      : random_(random), n_(orders[0].front().size()), step_(step) {
    const std::size_t rounds = orders[0].size();
    places_.resize(rounds / step_ * n_);
    for (std::size_t who : {0U, 1U}) {
      for (std::size_t round = 0; round < rounds; ++round) {
        for (const std::size_t demonstration : orders[who][round]) {
          const std::size_t variable = round / step_ * n_ + demonstration;
          places_[variable].push_back({who, shown_[who].size()});
          shown_[who].push_back({variable, round % step_ == 1});
        }
      }
    }
    throw_coins();
  }

  // Changes some sides that leave as many right in each round, unless more runs are too long then.
  void change() {
    const std::size_t one = random_.below(is_right_.size());
    const std::size_t other = step_ == 2 ? one : one - one % n_ + random_.below(n_);
    if (step_ == 1 && is_right_[one] == is_right_[other]) return;
    const auto turn = [&] {
      is_right_[one].flip();
      if (other != one) is_right_[other].flip();
    };
    const auto long_runs = [&] { return long_runs_at(one) + long_runs_at(other); };
    const int before = long_runs();
    turn();
    if (long_runs() > before) turn();
  }

  [[nodiscard]] bool is_allowed() const {
    for (std::size_t variable = 0; variable < is_right_.size(); ++variable) {
      if (long_runs_at(variable) > 0) return false;
    }
    return true;
  }

  [[nodiscard]] Sides sides() const {
    Sides sides;
    for (std::size_t begin = 0; begin < is_right_.size(); begin += n_) {
      const auto first = is_right_.begin() + static_cast<std::ptrdiff_t>(begin);
      sides.emplace_back(first, first + static_cast<std::ptrdiff_t>(n_));
      if (step_ == 2) {
        sides.push_back(sides.back());
        sides.back().flip();
      }
    }
    return sides;
  }

  [[nodiscard]] std::size_t size() const { return is_right_.size(); }

 private:
  struct Shown {
    std::size_t variable;
    bool is_swapped;
  };
  struct Place {
    std::size_t who, trial;
  };

  // As many on both sides; of an odd number once more on one, and in the next round on the other.
  void throw_coins() {
    bool is_more_right = false;
    for (std::size_t round = 0; round < places_.size() / n_; ++round) {
      is_more_right = round % 2 == 0 ? random_.coin() : !is_more_right;
      const std::size_t right = (n_ + (is_more_right ? 1 : 0)) / 2;
      for (const std::size_t i : random_.permutation(n_)) {
        is_right_.push_back(step_ == 2 ? random_.coin() : i < right);
      }
    }
  }

  [[nodiscard]] bool side(std::size_t who, std::size_t trial) const {
    const Shown& shown = shown_[who][trial];
    return is_right_[shown.variable] != shown.is_swapped;
  }

  // Four times running on one side, among the trials that show the variable.
  [[nodiscard]] int long_runs_at(std::size_t variable) const {
    int runs = 0;
    for (const auto& [who, trial] : places_[variable]) {
      const std::size_t first = trial - std::min<std::size_t>(trial, longest_run);
      for (std::size_t begin = first; begin <= trial; ++begin) {
        if (begin + longest_run >= shown_[who].size()) break;
        bool is_one_side = true;
        for (std::size_t i = 1; i <= longest_run && is_one_side; ++i) {
          is_one_side = side(who, begin + i) == side(who, begin);
        }
        runs += is_one_side ? 1 : 0;
      }
    }
    return runs;
  }

  Random& random_;
  std::size_t n_, step_;
  std::vector<bool> is_right_;               // [variable]
  std::array<std::vector<Shown>, 2> shown_;  // [participant of the pair][trial]
  std::vector<std::vector<Place>> places_;   // [variable]: where it is shown
};

// Sides of so many trials that throws do not find them: coins, and then changes that make no more
// runs too long, until there are none and long after, so that what is allowed comes alike often.
Sides arranged_sides(Random random, const std::array<Orders, 2>& orders, std::size_t step) {
  constexpr std::size_t changes_of_each = 50;  // all runs are short enough after 25
  while (true) {
    Arrangement arrangement(random, orders, step);
    for (std::size_t i = 0; i < changes_of_each * arrangement.size(); ++i) arrangement.change();
    if (arrangement.is_allowed()) return arrangement.sides();
  }
}

}  // namespace

Sides sides_of_pair(std::uint64_t seed, std::uint64_t pair, const std::array<Orders, 2>& orders,
                    bool both_orders) {
  const std::size_t step = both_orders ? 2 : 1;
  const std::size_t n = orders[0].front().size(), rounds = orders[0].size();
  constexpr std::size_t most_coins = 6000000, largest_round = 100;
  const std::size_t attempts = n > largest_round ? 0 : most_coins / (most_throws * n);
  for (std::uint64_t attempt = 0; attempt < attempts; ++attempt) {
    Sides sides = thrown_sides(Random(seed, Purpose::sides, pair, attempt), orders, step);
    if (sides.size() == rounds) return sides;
    if (4 * (sides.size() + step) < rounds) break;  // other throws will not come to the end either
  }
  return arranged_sides(Random(seed, Purpose::arranged_sides, pair), orders, step);
}

std::vector<bool> sides_in_eights(std::uint64_t seed, std::uint64_t number, std::size_t trials) {
  Random coins(seed, Purpose::sides, number / 2);
  SidesSoFar so_far;
  std::vector<bool> sides;
  while (sides.size() < trials) {
    std::vector<bool> some(std::min<std::size_t>(8, trials - sides.size()));
    std::generate(some.begin(), some.end(), [&] { return coins.coin(); });
    SidesSoFar next = so_far;
    bool passes = true;
    for (const bool is_right : some) passes = next.add(is_right) && passes;
    if (!passes || !next.is_balanced()) continue;
    so_far = next;
    sides.insert(sides.end(), some.begin(), some.end());
  }
  if (number % 2 == 1) sides.flip();
  return sides;
}

}  // namespace pinchlab::study
