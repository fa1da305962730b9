// SPDX-License-Identifier: GPL-3.0-or-later
// The stability tests themselves: that they find what is wrong, and that ours holds where the page
// says so.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "analysis/experiments/stability/border.h"
#include "analysis/experiments/stability/scenes.h"
#include "analysis/experiments/stability/stability.h"
#include "sim/cable/cable.h"
#include "sim/step.h"

namespace pinchlab::experiments::stability {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(StabilityCriteria, NothingWrongIsNoFailure) {
  EXPECT_FALSE(judge({}).failed());
  EXPECT_EQ(judge({}).worst, Failure::none);
}

TEST(StabilityCriteria, EachMeasureFailsJustBeyondItsLimit) {
  const Limits limits;
  const std::tuple<double Measures::*, double, Failure> all[] = {
      {&Measures::strain, limits.strain, Failure::strain},
      {&Measures::squeeze, limits.squeeze, Failure::squeeze},
      {&Measures::length, limits.length, Failure::length},
      {&Measures::energy_gained, limits.energy, Failure::energy_gained},
      {&Measures::energy_lost, limits.energy, Failure::energy_lost},
      {&Measures::end_speed_m_s, limits.end_speed_m_s, Failure::restless},
      {&Measures::error, limits.error, Failure::wrong},
  };
  for (const auto& [measure, limit, failure] : all) {
    Measures m;
    m.*measure = 0.999 * limit;
    EXPECT_FALSE(judge(m).failed()) << to_string(failure);
    m.*measure = 1.001 * limit;
    EXPECT_TRUE(judge(m).failed()) << to_string(failure);
    EXPECT_EQ(judge(m).worst, failure);
    m.*measure = nan;
    EXPECT_TRUE(judge(m).failed()) << to_string(failure);
    EXPECT_EQ(judge(m).worst, Failure::not_finite);
  }
}

TEST(StabilityCriteria, TheWorstMeasureCounts) {
  Measures m;
  m.strain = 2e-3;
  m.squeeze = 0.5;
  EXPECT_EQ(judge(m).worst, Failure::squeeze);
  EXPECT_NEAR(judge(m).severity, 500.0, 1e-9);
  m.passed_through = true;
  EXPECT_EQ(judge(m).worst, Failure::passed_through);
  m.finite = false;
  EXPECT_EQ(judge(m).worst, Failure::not_finite);
  EXPECT_TRUE(judge(m).failed());
}

TEST(StabilityMeasures, SqueezeOfAWrapASpanAndAPinchedSpan) {
  const double w = cable_half_width;
  const Scene scene = roller_on_drum(0);
  World world = make_world(scene, Method::pinch);
  EXPECT_EQ(squeeze(scene, world), 0.0);
  world.position[1].y() = pulley_radius + 0.25 + 0.6 * w;  // of 2 w between them
  EXPECT_NEAR(squeeze(scene, world), 0.7, 1e-12);
  world.position[1] = -world.position[1];  // under the drum, where no cable lies
  EXPECT_EQ(squeeze(scene, world), 0.0);
  world.position[1] = {-0.85, -1.5};  // on the way to the left anchor
  EXPECT_GT(squeeze(scene, world), 1.0);

  const Scene stack = zigzag_stack(2);
  World pinched = make_world(stack, Method::pinch);
  EXPECT_EQ(squeeze(stack, pinched), 0.0);
  pinched.position[2].y() = pinched.position[1].y() + 0.5 + 1.9 * w;
  EXPECT_NEAR(squeeze(stack, pinched), 0.05, 1e-12);
}

TEST(StabilityMeasures, StrainIsExcessOverLength) {
  const Scene scene = ball_at_span(0.0, 0.0);
  World world = make_world(scene, Method::pinch);
  EXPECT_NEAR(strain(scene, world), 0.0, 1e-15);
  world.cables[0].segments[1].length += 0.04;
  EXPECT_NEAR(strain(scene, world), 0.01, 1e-12);
}

Case pendulum() {
  Case test;
  test.scene = unwinding_pendulum();
  test.energy = EnergyLaw::keeps;
  test.energy_at_play_j = energy_at_play(test.scene, 1.0);
  return test;
}

TEST(StabilityMeasures, WatchFindsWhatIsWrong) {
  EXPECT_FALSE(watch(pendulum(), "pinch", Method::pinch).verdict.failed());
  Case restless = pendulum();
  restless.rests = true;
  EXPECT_EQ(watch(restless, "pinch", Method::pinch).verdict.worst, Failure::restless);

  Case driven;  // a load that is wound up by a torque
  driven.scene = build::load_chain(1, 1.0, 1.0, 1.0);
  driven.scene.bodies[2].torque = -5.0;
  driven.energy = EnergyLaw::falls;
  driven.energy_at_play_j = energy_at_play(driven.scene, 1.0);
  EXPECT_EQ(watch(driven, "pinch", Method::pinch).verdict.worst, Failure::energy_gained);

  Case dragged = pendulum();
  dragged.scene.bodies[1].linear_drag = 1.0;
  EXPECT_EQ(watch(dragged, "pinch", Method::pinch).verdict.worst, Failure::energy_lost);

  Case wrong = pendulum();
  wrong.error = [](const Scene&, const World&) { return 0.02; };
  EXPECT_EQ(watch(wrong, "pinch", Method::pinch).verdict.worst, Failure::wrong);

  Case passed = pendulum();
  passed.passed_through = [](const Scene&, const World&) { return true; };
  EXPECT_EQ(watch(passed, "pinch", Method::pinch).verdict.worst, Failure::passed_through);

  Case lost = pendulum();
  lost.scene.gravity.y() = -1e308;  // finite itself
  const Result result = watch(lost, "pinch", Method::pinch);
  EXPECT_EQ(result.verdict.worst, Failure::not_finite);
  EXPECT_LT(result.steps, step_count(lost));
}

std::vector<Result> made_up(const std::vector<std::pair<double, double>>& severities) {
  std::vector<Result> results;
  for (const auto& [x, severity] : severities) {
    Result result;
    result.x = x;
    result.verdict = {severity, severity > 10.0 ? Failure::strain : Failure::squeeze};
    results.push_back(result);
  }
  return results;
}

TEST(StabilityBorder, InWords) {
  EXPECT_EQ(border_text(made_up({{1, 0.1}, {10, 0.2}})), "all");
  EXPECT_EQ(border_text(made_up({{1, 2.0}, {10, 3.0}})), "none (squeezed)");
  EXPECT_EQ(border_text(made_up({{100, 20.0}, {1, 0.1}, {10, 0.2}, {1000, 2.0}})),
            "up to 10 (100: stretched)");
  EXPECT_EQ(border_text(made_up({{1, 2.0}, {10, 0.2}, {infinity, 0.1}})), "from 10 (1: squeezed)");
  EXPECT_EQ(border_text(made_up({{1, 2.0}, {10, 0.2}, {20, 0.1}, {30, 99.0}})),
            "10 to 20 (stretched)");
  EXPECT_EQ(border_text(made_up({{1, 0.1}, {10, 2.0}, {20, 0.1}})), "2 of 3 (10: squeezed)");
  // The worse of two at one value counts.
  EXPECT_EQ(border_text(made_up({{1, 0.1}, {10, 0.1}, {10, 2.0}})), "up to 1 (10: squeezed)");
  EXPECT_EQ(border_text(made_up({{1, 0.1}, {10, nan}})).substr(0, 7), "up to 1");
}

TEST(StabilityBorder, Values) {
  EXPECT_EQ(value_text(infinity), "infinite");
  EXPECT_EQ(value_text(0.0), "0");
  EXPECT_EQ(value_text(31.6227766), "31.6");
  EXPECT_EQ(value_text(11743.0), "11743");
  EXPECT_EQ(value_text(1e9), "1e9");
  EXPECT_EQ(value_text(3.16e-5), "3.2e-5");
}

class StabilityItem : public ::testing::TestWithParam<std::size_t> {};

TEST_P(StabilityItem, HoldsEverywhere) {
  const Item item = stability_items(true)[GetParam()];
  for (const Case& test : item.cases) {
    const Result result = watch(test, "pinch", Method::pinch);
    EXPECT_TRUE(result.measures.finite) << test.series << ", " << test.x;
    EXPECT_LT(result.measures.length, 1e-12) << test.series << ", " << test.x;
    EXPECT_FALSE(result.verdict.failed())
        << test.series << ", " << test.x << ": " << to_string(result.verdict.worst) << ", "
        << result.verdict.severity << " times its limit";
  }
}

std::string name_of_item(const ::testing::TestParamInfo<std::size_t>& test) {
  std::string name = stability_items(true)[test.param].id;
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, StabilityItem,
                         ::testing::Range(std::size_t{0}, stability_items(true).size()),
                         name_of_item);

TEST(StabilityPage, TablesAreTheSameInEveryRunAndThePageNamesAllItems) {
  Item item = stacks(true);
  item.cases.resize(3);
  Progress progress("test", 1e9);
  const ItemResults first = run_item(item, progress), second = run_item(item, progress);
  EXPECT_EQ(first.results.size(), 3u * item.methods.size());
  EXPECT_EQ(results_table(first).text(), results_table(second).text());
  const std::string page = page_text({first});
  EXPECT_NE(page.find("| [Stacks](#stack) | rollers on top of one another | all |"),
            std::string::npos)
      << page;
  EXPECT_NE(page.find("![Stacks](stability-stack.svg)"), std::string::npos);
}

/// An item as if each of its cases held.
ItemResults all_held(const Item& item) {
  ItemResults done{item, {}};
  for (const std::string& method : item.methods) {
    for (const Case& test : item.cases) {
      Result result;
      result.method = method;
      result.series = test.series;
      result.x = test.x;
      result.y = test.y;
      result.verdict.severity = 0.5;
      done.results.push_back(result);
    }
  }
  return done;
}

int times_in(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t i = text.find(part); i != std::string::npos; i = text.find(part, i + 1)) ++count;
  return count;
}

// gnuplot cut "from a drum, heavy rope" at its comma, and drew an empty panel.
TEST(StabilityFigures, EachPanelHasPointsAndTheLegendIsDrawnOnce) {
  for (const Item& item : stability_items(true)) {
    const Drawing drawing = draw(all_held(item));
    if (!item.y_name.empty()) continue;
    const auto methods = static_cast<int>(item.methods.size());
    EXPECT_EQ(times_in(drawing.commands, "\nset label 1"), 1 + methods) << item.id;
    EXPECT_EQ(times_in(drawing.commands, "\nunset label 1"), methods) << item.id;
    const std::size_t first = drawing.commands.find("set title");
    EXPECT_LT(drawing.commands.find("unset label 1"),
              drawing.commands.find("set title", first + 1));
  }
  ItemResults done = all_held(long_swing(true));
  done.item.cases.front().series = "a drum, a heavy rope";
  EXPECT_THROW(draw(done), std::logic_error) << "a comma";
  done.item.cases.front().series = "one that never ran";
  EXPECT_THROW(draw(done), std::logic_error) << "no points";
}

TEST(StabilityPage, MapTakesTheWorstSeries) {
  ItemResults done;
  done.item.methods = {"pinch"};
  for (const double severity : {0.1, 3.0, 0.2}) {
    Result result;
    result.method = "pinch";
    result.series = severity > 1.0 ? "bad" : "good";
    result.x = 60.0;
    result.y = 4.0;
    result.verdict = {severity, Failure::strain};
    done.results.push_back(result);
  }
  EXPECT_EQ(map_table(done).text(),
            "method,x,y,severity,series,worst\npinch,60,4,3,bad,stretched\n");
}

}  // namespace
}  // namespace pinchlab::experiments::stability
