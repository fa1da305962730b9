// SPDX-License-Identifier: GPL-3.0-or-later
// Plans of studies of several methods and of thresholds.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "study/config.h"
#include "study/plan.h"
#include "tests/study/config_error.h"

namespace pinchlab::study {
namespace {

using nlohmann::json;

PlanOptions methods(std::size_t count, int demonstrations, int pairs) {
  PlanOptions options;
  for (int i = 0; i < demonstrations; ++i) {
    options.demonstrations.push_back("demo-" + std::to_string(i));
  }
  for (std::size_t i = 0; i < count; ++i) options.methods.push_back(std::string(1, char('a' + i)));
  options.pairs_per_demonstration = pairs;
  return options;
}

using Pair = std::pair<std::string, std::string>;

TEST(PairPlan, TournamentsHoldEachPairOnce) {
  for (const std::size_t m : {3U, 4U, 5U, 6U, 7U, 10U}) {
    const auto pairs = tournament(m);
    ASSERT_EQ(pairs.size(), m * (m - 1) / 2);
    std::set<std::pair<std::size_t, std::size_t>> seen;
    const std::size_t a_round = m / 2;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      seen.insert(std::minmax(pairs[i].first, pairs[i].second));
      EXPECT_LT(std::max(pairs[i].first, pairs[i].second), m);
      EXPECT_NE(pairs[i].first, pairs[i].second);
      for (std::size_t j = i - i % a_round; j < i; ++j) {  // of the same round
        const std::set<std::size_t> four = {pairs[i].first, pairs[i].second, pairs[j].first,
                                            pairs[j].second};
        EXPECT_EQ(four.size(), 4U) << m << " methods";
      }
    }
    EXPECT_EQ(seen.size(), pairs.size());
  }
}

TEST(PairPlan, CompleteDesignsShowEveryPairInEveryDemonstration) {
  const PlanOptions options = methods(4, 3, 0);
  for (std::uint64_t number = 0; number < 8; ++number) {
    std::map<std::string, std::set<Pair>> seen;
    const auto plan = make_plan(5, number, options);
    ASSERT_EQ(plan.size(), 18U);
    for (std::size_t i = 0; i < plan.size(); ++i) {
      seen[plan[i].demonstration].insert({plan[i].first, plan[i].second});
      EXPECT_TRUE(i == 0 || plan[i].demonstration != plan[i - 1].demonstration);
    }
    for (const auto& [name, pairs] : seen) EXPECT_EQ(pairs.size(), 6U) << name;
  }
}

TEST(PairPlan, IncompleteDesignsAreBalanced) {
  for (const auto& [m, demonstrations, k] :
       {std::tuple{4U, 8, 1}, {4U, 3, 2}, {5U, 4, 3}, {3U, 5, 1}, {6U, 2, 5}}) {
    const PlanOptions options = methods(m, demonstrations, k);
    const std::size_t pairs = m * (m - 1) / 2;
    std::map<std::pair<std::string, Pair>, int> shown, on_left;
    for (std::uint64_t number = 0; number < 2 * pairs; ++number) {
      const auto plan = make_plan(11, number, options);
      ASSERT_EQ(plan.size(), static_cast<std::size_t>(demonstrations * k));
      std::map<Pair, int> own;
      std::map<std::string, int> left, right;
      std::map<std::string, std::set<Pair>> of_demonstration;
      for (const PlannedTrial& trial : plan) {
        const Pair pair = {trial.first, trial.second};
        ASSERT_LT(trial.first, trial.second);
        ++own[pair];
        EXPECT_TRUE(of_demonstration[trial.demonstration].insert(pair).second) << "a pair twice";
        const bool is_left = trial.pinch == Side::left;
        ++left[is_left ? trial.first : trial.second];
        ++right[is_left ? trial.second : trial.first];
        ++shown[{trial.demonstration, pair}];
        on_left[{trial.demonstration, pair}] += is_left ? 1 : -1;
      }
      int fewest = own.size() < pairs ? 0 : 1000, most = 0;
      for (const auto& [pair, count] : own) {
        fewest = std::min(fewest, count);
        most = std::max(most, count);
      }
      EXPECT_LE(most - fewest, 1) << "pairs of one participant";
      for (const std::string& method : options.methods) {
        EXPECT_LE(std::abs(left[method] - right[method]), 1) << "sides of one participant";
      }
    }
    EXPECT_EQ(shown.size(), pairs * static_cast<std::size_t>(demonstrations));
    for (const auto& [what, count] : shown) {
      EXPECT_EQ(count, 2 * k) << what.first << what.second.first << what.second.second;
      EXPECT_EQ(on_left[what], 0) << "the two of a couple see opposite sides";
    }
  }
}

TEST(PairPlan, SidesAndPairsAreFair) {
  const PlanOptions options = methods(4, 2, 1);
  std::map<Pair, int> first;
  int left = 0;
  constexpr int studies = 6000;
  for (std::uint64_t seed = 0; seed < studies; ++seed) {
    const auto plan = make_plan(seed, 4, options);
    ++first[{plan[0].first, plan[0].second}];
    left += plan[0].pinch == Side::left ? 1 : 0;
  }
  ASSERT_EQ(first.size(), 6U);
  for (const auto& [pair, count] : first) EXPECT_NEAR(count, 1000, 120);  // 4 standard deviations
  EXPECT_NEAR(left, 3000, 160);
}

TEST(PairPlan, GradedClipsAreShownAsOftenAsAsked) {
  PlanOptions options;
  options.demonstrations = {"squeeze"};
  for (const double level : {0.1, 0.2, 0.4}) options.graded.push_back({"squeeze", level});
  options.repetitions = 4;
  EXPECT_EQ(answers_per_demonstration(options), 12);
  const auto plan = make_plan(3, 1, options);
  std::map<double, int> levels;
  std::map<double, int> left;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    ASSERT_TRUE(plan[i].level);
    ++levels[*plan[i].level];
    EXPECT_EQ(plan[i].first, "reference");
    EXPECT_TRUE(i == 0 || plan[i].level != plan[i - 1].level);
  }
  EXPECT_EQ(levels, (std::map<double, int>{{0.1, 4}, {0.2, 4}, {0.4, 4}}));
  std::set<std::string> keys;
  for (const PlannedTrial& trial : plan) keys.insert(clip_key(trial));
  EXPECT_EQ(keys, (std::set<std::string>{"squeeze @ 0.1", "squeeze @ 0.2", "squeeze @ 0.4"}));
}

TEST(PairPlan, ConfigurationsAreCheckedWholly) {
  const json good = {{"demonstrations", {"a"}}, {"methods", {"pinch", "cable", "thesis"}}};
  EXPECT_EQ(error_with_format(good), "");
  const auto with = [&](const char* key, const json& value) {
    json document = good;
    document[key] = value;
    return error_with_format(document);
  };
  EXPECT_EQ(with("pairs_per_demonstration", 3), "");
  EXPECT_NE(with("pairs_per_demonstration", 4).find("pairs_per_demonstration"), std::string::npos);
  EXPECT_NE(with("methods", {"a", "b"}).find("three or more"), std::string::npos);
  EXPECT_NE(with("methods", {"a", "b", "a"}).find("none twice"), std::string::npos);
  EXPECT_NE(with("methods", {"a", "b", "baseline"}).find("baseline"), std::string::npos);
  EXPECT_NE(with("methods", {"a", "b", "c-d"}).find("c-d"), std::string::npos);
  EXPECT_NE(with("both_orders", true).find("both_orders"), std::string::npos);
  EXPECT_NE(error_with_format({{"methods", {"a", "b", "c"}}}).find("must be named"),
            std::string::npos);
  EXPECT_NE(error_with_format({{"demonstrations", {"a"}}, {"pairs_per_demonstration", 1}})
                .find("needs methods"),
            std::string::npos);

  const json clip = {{"level", 0.1}, {"left", "l.mp4"}, {"right", "r.mp4"}};
  json other = clip;
  other["level"] = 0.2;
  const auto series = [](const json& clips) {
    return json{{"series", {{{"name", "squeeze"}, {"clips", clips}}}}};
  };
  EXPECT_EQ(error_with_format(series({clip, other})), "");
  EXPECT_NE(error_with_format(series(json::array({clip}))).find("two clips"), std::string::npos);
  EXPECT_NE(error_with_format(series({clip, clip})).find("stands twice"), std::string::npos);
  other["right"] = "l.mp4";
  EXPECT_NE(error_with_format(series({clip, other})).find("same file"), std::string::npos);
  other["right"] = "../r.mp4";
  EXPECT_NE(error_with_format(series({clip, other})).find(".mp4 file"), std::string::npos);
  other["right"] = "r.mp4";
  other["level"] = "0.2";
  EXPECT_NE(error_with_format(series({clip, other})).find("level"), std::string::npos);
  json both = series({clip, clip});
  both["demonstrations"] = {"a"};
  EXPECT_NE(error_with_format(both).find("cannot be combined"), std::string::npos);
}

}  // namespace
}  // namespace pinchlab::study
