// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/plan.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/sha256.h"

namespace pinchlab::study {
namespace {

PlanOptions named(int demonstrations) {
  PlanOptions options;
  for (int i = 1; i <= demonstrations; ++i) {
    options.demonstrations.push_back("demo-" + std::to_string(i));
  }
  return options;
}

PlanOptions eight() {
  return named(8);
}

std::vector<std::string> order_of(const std::vector<PlannedTrial>& plan) {
  std::vector<std::string> order;
  for (const PlannedTrial& trial : plan) {
    order.push_back(trial.demonstration);
  }
  return order;
}

// p of Pearson's X^2 against equal counts.
double p_uniform(const std::map<std::string, int>& counts, std::size_t cells) {
  double total = 0, chi_square = 0;
  for (const auto& [cell, count] : counts) {
    total += count;
  }
  const double expected = total / static_cast<double>(cells);
  chi_square = expected * static_cast<double>(cells - counts.size());
  for (const auto& [cell, count] : counts) {
    chi_square += (count - expected) * (count - expected) / expected;
  }
  return gsl_cdf_chisq_Q(chi_square, static_cast<double>(cells - 1));
}

// Seeds are independent studies, so that 10,000 of them are a sample. With the fixed seeds the
// test always gives the same p; 1e-4 would have been met by chance once in ten thousand choices.
TEST(Plan, OrdersAndSidesAreUniform) {
  PlanOptions options = eight();
  options.demonstrations.resize(4);
  std::map<std::string, int> orders, sides, positions;
  for (std::uint64_t seed = 0; seed < 10000; ++seed) {
    const auto plan = make_plan(seed, seed % 11, options);
    std::string order, side;
    for (std::size_t i = 0; i < plan.size(); ++i) {
      order += plan[i].demonstration;
      positions[plan[i].demonstration + std::to_string(i)] += 1;
    }
    for (const std::string& name : options.demonstrations) {
      const auto trial = std::ranges::find(plan, name, &PlannedTrial::demonstration);
      side += to_string(trial->pinch);
    }
    ++orders[order];
    ++sides[side];
  }
  EXPECT_GT(p_uniform(orders, 24), 1e-4);
  EXPECT_GT(p_uniform(sides, 6), 1e-4) << "two of four, in every way";
  EXPECT_GT(p_uniform(positions, 16), 1e-4);
}

TEST(Plan, EveryBlockOfTwoSeesBothSides) {
  for (std::uint64_t number = 0; number < 200; number += 2) {
    std::map<std::string, std::set<Side>> sides;
    for (const std::uint64_t i : {number, number + 1}) {
      for (const PlannedTrial& trial : make_plan(3, i, eight())) {
        sides[trial.demonstration].insert(trial.pinch);
      }
    }
    ASSERT_EQ(sides.size(), 8U);
    for (const auto& [name, both] : sides) {
      EXPECT_EQ(both.size(), 2U) << name << " of participants " << number;
    }
  }
}

TEST(Plan, EveryBlockOfNSeesEachDemonstrationInEachPosition) {
  for (const std::size_t n : {1U, 2U, 3U, 5U, 8U}) {
    PlanOptions options = eight();
    options.demonstrations.resize(n);
    options.repetitions = 2;
    for (std::uint64_t block = 0; block < 20; ++block) {
      std::vector<std::set<std::string>> seen(2 * n);
      for (std::uint64_t i = 0; i < n; ++i) {
        const auto order = order_of(make_plan(5, block * n + i, options));
        for (std::size_t position = 0; position < order.size(); ++position) {
          seen[position].insert(order[position]);
        }
      }
      for (const auto& names : seen) {
        EXPECT_EQ(names.size(), n);
      }
    }
  }
}

TEST(Plan, ForEvenNumbersEachFollowsEveryOtherOnceABlock) {
  for (std::uint64_t block = 0; block < 10; ++block) {
    std::set<std::pair<std::string, std::string>> pairs;
    for (std::uint64_t i = 0; i < 8; ++i) {
      const auto order = order_of(make_plan(1, block * 8 + i, eight()));
      for (std::size_t j = 1; j < order.size(); ++j) {
        pairs.emplace(order[j - 1], order[j]);
      }
    }
    EXPECT_EQ(pairs.size(), 56U);
  }
}

TEST(Plan, ForOddNumbersEachFollowsEveryOtherTwiceInABlockAndItsMirror) {
  for (const std::size_t n : {3U, 5U, 7U}) {
    PlanOptions options = eight();
    options.demonstrations.resize(n);
    for (std::uint64_t block = 0; block < 10; block += 2) {
      std::map<std::pair<std::string, std::string>, int> pairs;
      for (std::uint64_t i = 0; i < 2 * n; ++i) {
        const auto order = order_of(make_plan(1, block * n + i, options));
        for (std::size_t j = 1; j < order.size(); ++j) {
          ++pairs[{order[j - 1], order[j]}];
        }
      }
      EXPECT_EQ(pairs.size(), n * (n - 1));
      for (const auto& [pair, count] : pairs) {
        EXPECT_EQ(count, 2) << pair.first << " before " << pair.second;
      }
    }
  }
}

void expect_balanced_sides(const std::vector<PlannedTrial>& plan) {
  int right = 0, run = 0;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    right += plan[i].pinch == Side::right ? 1 : 0;
    run = i > 0 && plan[i].pinch == plan[i - 1].pinch ? run + 1 : 1;
    ASSERT_LE(run, 3) << "up to trial " << i;
  }
  const int trials = static_cast<int>(plan.size());
  ASSERT_LE(std::abs(2 * right - trials), trials % 2);
}

// Nobody can learn to press one side.
TEST(Plan, SidesAreBalancedWithinEveryParticipant) {
  for (const int n : {1, 2, 3, 5, 8}) {
    for (const int repetitions : {1, 2, 5}) {
      for (const bool both_orders : {false, true}) {
        PlanOptions options = named(n);
        options.repetitions = repetitions;
        options.both_orders = both_orders;
        for (std::uint64_t number = 0; number < 100; ++number) {
          SCOPED_TRACE(fmt::format("{} demonstrations, participant {}", n, number));
          expect_balanced_sides(make_plan(number / 10, number, options));
        }
      }
    }
  }
}

struct Design {
  int demonstrations, repetitions;
  bool both_orders;
};

PlanOptions options_of(const Design& design) {
  PlanOptions options = named(design.demonstrations);
  options.repetitions = design.repetitions;
  options.both_orders = design.both_orders;
  return options;
}

// What no throws of coins would end: as many trials as a study may have.
const std::vector<Design> large_designs = {
    {38, 20, false}, {40, 20, false}, {48, 8, false}, {101, 1, false},  {333, 3, false},
    {500, 2, false}, {999, 1, false}, {25, 20, true}, {1000, 1, false}, {500, 1, true}};

TEST(Plan, LargeDesignsKeepWhatSmallOnesDo) {
  for (const Design& design : large_designs) {
    const PlanOptions options = options_of(design);
    for (const std::uint64_t pair : {0U, 3U}) {
      SCOPED_TRACE(fmt::format("{} demonstrations {} times, participants {} and the next",
                               design.demonstrations, design.repetitions, 2 * pair));
      std::map<std::pair<std::string, int>, std::vector<Side>> sides;  // by demonstration and round
      for (const std::uint64_t number : {2 * pair, 2 * pair + 1}) {
        const auto plan = make_plan(1, number, options);
        expect_balanced_sides(plan);
        for (const PlannedTrial& trial : plan) {
          sides[{trial.demonstration, trial.round}].push_back(trial.pinch);
        }
      }
      const int rounds = design.repetitions * (design.both_orders ? 2 : 1);
      ASSERT_EQ(sides.size(), static_cast<std::size_t>(design.demonstrations * rounds));
      for (const auto& [trial, of_pair] : sides) {
        ASSERT_EQ(of_pair.size(), 2U);
        ASSERT_EQ(of_pair[0], opposite(of_pair[1]));
        if (design.both_orders && trial.second % 2 == 0) {
          ASSERT_EQ(of_pair[0], opposite(sides.at({trial.first, trial.second + 1})[0]));
        }
      }
    }
  }
}

TEST(Plan, SidesOfLargeDesignsAreCoins) {
  std::map<std::string, int> neighbours, rights;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const auto plan = make_plan(seed, 0, named(101));
    ++neighbours[fmt::format("{} {}", to_string(plan[50].pinch), to_string(plan[70].pinch))];
    ++rights[fmt::format("{}", std::ranges::count(plan, Side::right, &PlannedTrial::pinch))];
  }
  EXPECT_GT(p_uniform(neighbours, 4), 1e-4);
  EXPECT_GT(p_uniform(rights, 2), 1e-4) << "50 or 51";
}

// Studies that have begun go on with the sides that they had, whether the first throws served for
// all rounds or some were begun anew.
TEST(Plan, SeedsGiveThePlansOfEarlierVersions) {
  const auto hash = [](const Design& design) {
    std::string text;
    for (std::uint64_t number = 0; number < 4; ++number) {
      for (const PlannedTrial& trial : make_plan(5, number, options_of(design))) {
        text += fmt::format("{} {}\n", trial.demonstration, to_string(trial.pinch));
      }
    }
    return sha256(text).substr(0, 16);
  };
  EXPECT_EQ(hash({8, 1, false}), "ebd9b96bc20b94f9");
  EXPECT_EQ(hash({8, 5, true}), "d2737287ca52cb50");
  EXPECT_EQ(hash({37, 20, false}), "f6326604ae1af3c7");
}

TEST(Plan, IsAFunctionOfSeedNumberAndOptions) {
  EXPECT_EQ(make_plan(42, 17, eight()), make_plan(42, 17, eight()));
  EXPECT_NE(make_plan(42, 17, eight()), make_plan(43, 17, eight()));
  EXPECT_NE(order_of(make_plan(42, 16, eight())), order_of(make_plan(42, 17, eight())));
  // Large seeds count whole.
  EXPECT_NE(make_plan(largest_seed, 0, eight()),
            make_plan(largest_seed - (1ULL << 40U), 0, eight()));
}

TEST(Plan, OptionsDoNotChangeWhatOthersDraw) {
  PlanOptions more = eight();
  more.training = {"demo-1"};
  more.attention_checks = {"check"};
  const auto plain = make_plan(9, 4, eight());
  auto plan = make_plan(9, 4, more);
  ASSERT_EQ(plan.size(), plain.size() + 2);
  EXPECT_EQ(plan.front().kind, TrialKind::training);
  std::erase_if(plan, [](const PlannedTrial& trial) { return trial.kind != TrialKind::main; });
  EXPECT_EQ(plan, plain);
}

TEST(Plan, BothOrdersShowBothSides) {
  PlanOptions options = eight();
  options.both_orders = true;
  options.repetitions = 3;
  for (std::uint64_t number = 0; number < 30; ++number) {
    std::map<std::string, int> left, all;
    const auto plan = make_plan(2, number, options);
    for (std::size_t i = 0; i < plan.size(); ++i) {
      left[plan[i].demonstration] += plan[i].pinch == Side::left ? 1 : 0;
      ++all[plan[i].demonstration];
      if (i > 0) {
        EXPECT_NE(plan[i - 1].demonstration, plan[i].demonstration) << "twice running";
      }
    }
    ASSERT_EQ(all.size(), 8U);
    for (const auto& [name, count] : all) {
      EXPECT_EQ(count, 6);
      EXPECT_EQ(left[name], 3);
    }
  }
}

TEST(Plan, ChecksAreSpreadAndNeverFirst) {
  PlanOptions options = eight();
  options.attention_checks = {"check-a", "check-b"};
  std::map<std::string, int> right;
  for (std::uint64_t number = 0; number < 400; ++number) {
    const auto plan = make_plan(6, number, options);
    ASSERT_EQ(plan.size(), 10U);
    EXPECT_EQ(plan.front().kind, TrialKind::main);
    const auto a = std::ranges::find(plan, "check-a", &PlannedTrial::demonstration) - plan.begin();
    const auto b = std::ranges::find(plan, "check-b", &PlannedTrial::demonstration) - plan.begin();
    EXPECT_LE(a, 4);
    EXPECT_GE(b, 5);
    right["check-a"] += plan[static_cast<std::size_t>(a)].pinch == Side::right ? 1 : 0;
  }
  EXPECT_EQ(right["check-a"], 200);  // balanced in every block of two
}

}  // namespace
}  // namespace pinchlab::study
