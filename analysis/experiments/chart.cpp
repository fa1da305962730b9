// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/gnuplot.h"

namespace pinchlab::experiments {

namespace {

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

struct Label {
  std::string text;
  int style;
  double x, y;
};

/// Moves labels apart by at least `gap` decades, each as little as may be: from the middle of what
/// overlaps.
void spread_labels(std::vector<Label>& labels, double gap) {
  std::sort(labels.begin(), labels.end(), [](const Label& a, const Label& b) { return a.y < b.y; });
  std::vector<double> place;
  place.reserve(labels.size());
  for (const Label& label : labels) place.push_back(std::log10(label.y));
  for (int round = 0; round < 200; ++round) {
    for (std::size_t i = 1; i < place.size(); ++i) {
      const double lacking = gap - (place[i] - place[i - 1]);
      if (lacking <= 0.0) continue;
      place[i - 1] -= 0.5 * lacking;
      place[i] += 0.5 * lacking;
    }
  }
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i].y = std::pow(10.0, place[i]);
}

std::string data_block(const std::string& name, const Curve& curve) {
  std::string text = fmt::format("{} << EOD\nx,y,low,high\n", name);
  for (const CurvePoint& p : curve.points) {
    if (p.y.median > 0.0) {
      text += fmt::format("{},{},{},{}\n", p.x, p.y.median, std::max(p.y.low, p.y.median * 1e-3),
                          p.y.high);
    }
  }
  return text + "EOD\n";
}

void add_range(const Panel& panel, Range& x, Range& y) {
  for (const Curve& curve : panel.curves) {
    for (const CurvePoint& p : curve.points) {
      if (!(p.y.median > 0.0)) continue;
      x.add(p.x);
      y.add(p.y.median);
    }
  }
}

/// The tics of a range: powers of ten, or 1, 2 and 5 times these in less than two decades.
std::string y_tics(const Range& y) {
  if (y.high / y.low >= 100.0) return "set ytics autofreq\n";
  std::string tics;
  const int first = static_cast<int>(std::floor(std::log10(y.low)));
  for (int decade = first; std::pow(10.0, decade) <= y.high; ++decade) {
    for (const int digit : {1, 2, 5}) {
      const double value = digit * std::pow(10.0, decade);
      if (value < y.low || value > y.high) continue;
      tics += fmt::format("{}{:.0e}", tics.empty() ? "" : ",", value);
    }
  }
  return fmt::format("set ytics ({})\n", tics);
}

/// Where a title is to be broken so that it does not reach beyond its panel; 0: nowhere.
std::size_t break_of(const std::string& title) {
  constexpr std::size_t longest = 44;  // characters
  if (title.size() <= longest) return 0;
  const std::size_t space = title.find(' ', title.size() / 2);
  return space == std::string::npos ? 0 : space;
}

/// A title in one line or two; `lines` of the row's panels, so that their plots are as high.
std::string title_text(const std::string& title, int lines) {
  const std::size_t end = break_of(title);
  if (end == 0) return (lines > 1 ? "\"\\n\" . " : "") + analysis::gnuplot_quote(title);
  return analysis::gnuplot_quote(title.substr(0, end)) + " . \"\\n\" . " +
         analysis::gnuplot_quote(title.substr(end + 1));
}

std::string panel_commands(const Panel& panel, std::size_t number, int height_px, int title_lines,
                           const Range& x, Range y) {
  std::string data, bands, lines;
  std::vector<Label> labels;
  for (std::size_t c = 0; c < panel.curves.size(); ++c) {
    const Curve& curve = panel.curves[c];
    const CurvePoint* last = nullptr;
    for (const CurvePoint& p : curve.points) {
      if (p.y.median > 0.0) last = &p;
    }
    if (last == nullptr) continue;
    labels.push_back({curve.label, curve.style, last->x, last->y.median});
    const std::string name = fmt::format("$p{}c{}", number, c);
    data += data_block(name, curve);
    const std::string dash = curve.dashed ? " dt (6,4)" : "";
    lines += fmt::format(", \\\n  {} using 1:2 with linespoints ls {}{} notitle", name, curve.style,
                         dash);
    if (curve.spread) {
      bands += fmt::format(
          ", \\\n  {} using 1:3:4 with filledcurves ls {} fs transparent solid "
          "0.2 noborder notitle",
          name, curve.style);
    }
  }
  if (labels.empty()) return "";
  const double decades = std::log10(y.high / y.low) + 0.2;
  const double line_share = 19.0 / (height_px - 110.0);  // of the plot's height
  spread_labels(labels, decades * line_share);
  const double half_label = std::pow(10.0, 0.6 * decades * line_share);
  for (const Label& label : labels) {
    y.add(label.y / half_label);  // not on the axis
    y.add(label.y * half_label);
  }
  y = {y.low * std::pow(10.0, -0.1), y.high * std::pow(10.0, 0.1)};
  std::string text = data;
  text += fmt::format(
      "unset label\nset title {} offset 0,-0.5\nset xlabel {}\nset ylabel {}\n"
      "set xrange [{}:{}]\nset yrange [{}:{}]\nset xtics 1,10,{}\n{}",
      title_text(panel.title, title_lines), analysis::gnuplot_quote(panel.x_label),
      analysis::gnuplot_quote(panel.y_label), x.low / 1.25, x.high * panel.label_room, y.low,
      y.high, x.high, y_tics(y));
  for (const Label& label : labels) {
    text += fmt::format("set label {} at first {}, first {} left tc ls {}\n",
                        analysis::gnuplot_quote(label.text), label.x * 1.25, label.y, label.style);
  }
  return text + "plot NaN notitle" + bands + lines + '\n';
}

}  // namespace

std::string charts(const std::vector<Panel>& panels, int height_px, Scale scale) {
  Range all_x, all_y;
  for (const Panel& panel : panels) add_range(panel, all_x, all_y);
  const int lines =
      std::ranges::any_of(panels, [](const Panel& p) { return break_of(p.title) > 0; }) ? 2 : 1;
  std::string text = "set logscale xy\nset format '%g'\nset key off\nset mxtics 1\nset mytics 1\n";
  if (panels.size() > 1) text += fmt::format("set multiplot layout 1,{}\n", panels.size());
  for (std::size_t i = 0; i < panels.size(); ++i) {
    Range x, y = scale == Scale::common ? all_y : Range{};
    add_range(panels[i], x, y);
    text += panel_commands(panels[i], i, height_px, lines, x, y);
  }
  return text + (panels.size() > 1 ? "unset multiplot\n" : "");
}

}  // namespace pinchlab::experiments
