// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <regex>

namespace pinchlab::experiments {
namespace {

Panel panel(const std::string& title, double low, double high) {
  Panel made{title, "load", "time, ns", {}, 8.0};
  for (const double y : {low, high}) {
    Curve curve;
    curve.label = "at " + std::to_string(y);
    for (const double x : {1.0, 1000.0}) curve.points.push_back({x, {y, y, y}});
    made.curves.push_back(curve);
  }
  return made;
}

double number_after(const std::string& text, const std::string& pattern) {
  std::smatch match;
  return std::regex_search(text, match, std::regex(pattern)) ? std::stod(match[1]) : 0.0;
}

TEST(Chart, NarrowRangesHaveTicsBetweenThePowersOfTen) {
  const std::string narrow = charts({panel("Narrow", 3.0, 40.0)}, 420);
  EXPECT_NE(narrow.find("5e+00,1e+01,2e+01"), std::string::npos) << narrow;
  EXPECT_NE(charts({panel("Wide", 3.0, 4e4)}, 420).find("set ytics autofreq"), std::string::npos);
}

// The axis ran through the label of the lowest curve.
TEST(Chart, LabelsAreWithinTheAxes) {
  const std::string text = charts({panel("One", 1e-12, 1e-2)}, 420);
  const double low = number_after(text, "set yrange \\[([^:]*):");
  const double label = number_after(text, "set label 'at 0.000000' at first [^,]*, first ([^ ]*)");
  const double decades = std::log10(number_after(text, "set yrange \\[[^:]*:([^\\]]*)") / low);
  EXPECT_GT(std::log10(label / low) / decades, 8.0 / (420.0 - 110.0)) << "half a label's height";
}

TEST(Chart, LongTitlesAreInTwoLines) {
  const std::string text = charts(
      {panel("Short", 1, 2), panel("A looping pendulum slips, sticks, slips and sticks", 1, 2)},
      420);
  EXPECT_NE(
      text.find("set title 'A looping pendulum slips,' . \"\\n\" . 'sticks, slips and sticks'"),
      std::string::npos)
      << text;
  EXPECT_NE(text.find("set title \"\\n\" . 'Short'"), std::string::npos) << "plots as high";
}

}  // namespace
}  // namespace pinchlab::experiments
