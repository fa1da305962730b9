// SPDX-License-Identifier: GPL-3.0-or-later
// Figures: the worst measure over its limit against the parameter, or as a map; above 1 is failure.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "analysis/experiments/stability/stability.h"
#include "analysis/gnuplot.h"
#include "base/at.h"

namespace pinchlab::experiments::stability {

namespace {

constexpr double lowest = 1e-9, highest = 1e5;  // of severities that are drawn
constexpr double top = 1e7;                     // of the axis: above all curves 'failed' is written
constexpr int panel_px = 330;
constexpr int legend_labels = 10;  // the number of its first one

/// A single panel is wider, for the legend above it, px.
int figure_width(int panels) {
  return 64 + (panels == 1 ? 450 : panels * panel_px);
}

std::string method_title(const std::string& method) {
  if (method == "pinch") return "ours (pinch)";
  if (method == "thesis") return "thesis";
  if (method == "cable") return "plain cable joints";
  return "pinch joints without contact rows";
}

/// The same look for a method in all figures.
int line_style(const std::string& method) {
  if (method == "pinch") return 1;
  if (method == "thesis") return 2;
  if (method == "cable") return 3;
  return 4;
}

std::vector<std::string> series_of(const Item& item) {
  std::vector<std::string> names;
  for (const Case& test : item.cases) {
    if (std::find(names.begin(), names.end(), test.series) == names.end())
      names.push_back(test.series);
  }
  return names;
}

/// Places the plot of panel number `panel`, `apart_px` from the next, under `keys_px` of legend.
std::string panel_margins(int panel, int panels, double apart_px, int keys_px, int height_px) {
  const double left = 64.0, right = 12.0, width = figure_width(panels);
  const double inner = (width - left - right - apart_px * (panels - 1)) / panels;
  const double x = left + panel * (inner + apart_px);
  return fmt::format(
      "set lmargin at screen {:.4f}\nset rmargin at screen {:.4f}\n"
      "set bmargin at screen {:.4f}\nset tmargin at screen {:.4f}\n",
      x / width, (x + inner) / width, 66.0 / height_px, 1.0 - (30.0 + keys_px) / height_px);
}

/// The methods of an item in their colours, in a row on top.
std::string legend(const Item& item, int width_px, int height_px) {
  std::string text;
  double x = 74.0;  // px
  for (std::size_t m = 0; m < item.methods.size(); ++m) {
    const std::string title = method_title(item.methods[m]);
    text += fmt::format(
        "set label {} '{}' at screen {:.4f}, screen {:.4f} left noenhanced point ls {} offset "
        "0.8,0\n",
        m + legend_labels, title, x / width_px, 1.0 - 14.0 / height_px,
        line_style(item.methods[m]));
    x += 36.0 + 8.0 * static_cast<double>(title.size());
  }
  return text;
}

/// Values that a logarithmic axis cannot show are drawn at its ends.
std::pair<double, double> drawn_range(const Item& item) {
  double low = infinity, high = 0.0;
  for (const Case& test : item.cases) {
    if (test.x <= 0.0 || test.x == infinity) continue;
    low = std::min(low, test.x);
    high = std::max(high, test.x);
  }
  for (const Case& test : item.cases) {
    if (test.x == 0.0 && item.log_x) low = std::min(low, 1e-4);
    if (test.x == 0.0 && !item.log_x) low = 0.0;
    if (test.x == infinity) high = std::max(high, 1e3);
  }
  return {low, high};
}

std::string speeds_panel(const ItemResults& done, const std::string& table) {
  std::string text =
      "unset object\nunset label\nunset logscale x\nset yrange [1e-5:100]\nset ytics auto\n"
      "set logscale y\nset format y '10^{%L}'\nset ytics 1e-5,10\nset ylabel 'm/s'\nset xrange "
      "[0:4]\nset format x '%g'\n"
      "set xtics auto\nset xlabel 'time, s'\nset title 'fastest roller of four'\nplot ";
  for (std::size_t m = 0; m < done.item.methods.size(); ++m) {
    const std::string& method = done.item.methods[m];
    text += fmt::format(
        "{}'{}-speeds.csv' using (column('time_s')):(strcol('method') eq '{}' ? "
        "column('speed_m_s') + 1e-9 : NaN) with lines lw 1.5 lc rgb word(colours, {}) notitle",
        m == 0 ? "" : ", \\\n  ", table, method, line_style(method));
  }
  return text + "\n";
}

/// gnuplot finds a series in the table by its name, and would cut that at a comma or a quote.
void check_panel(const ItemResults& done, const std::string& series) {
  if (series.find_first_of(",\"") != std::string::npos) {
    throw std::logic_error(
        fmt::format("stability-{}: series \"{}\" cannot be drawn: gnuplot cuts "
                    "its name; leave out commas and quotes",
                    done.item.id, series));
  }
  if (std::ranges::none_of(done.results, [&series](const Result& r) {
        return r.series == series && !std::isnan(r.verdict.severity);
      })) {
    throw std::logic_error(
        fmt::format("stability-{}: nothing to draw of series \"{}\"", done.item.id, series));
  }
}

Drawing draw_curves(const ItemResults& done) {
  const Item& item = done.item;
  const std::vector<std::string> series = series_of(item);
  for (const std::string& name : series) check_panel(done, name);
  const std::string table = "stability-" + item.id;
  const int panels = static_cast<int>(series.size()) + (item.shows_speeds ? 1 : 0);
  const int height_px = 340;
  Drawing drawing{figure_width(panels), height_px, ""};
  const double apart_px = item.shows_speeds ? 70.0 : 22.0;
  const auto [low, high] = drawn_range(item);
  std::string& text = drawing.commands;
  text += fmt::format(
      "set termoption enhanced\nset style line 3 lc rgb '#009E73' lw 1.5 pt 8 ps 1.0\ncolours = "
      "'#0072B2 #D55E00 #009E73 #CC79A7'\n"
      "shown(s) = s > {1} ? {1} : s < {0} ? {0} : s\n"
      "place(x) = x < {2} ? {2} : x > {3} ? {3} : x\n"
      "set multiplot\nset logscale y\nset yrange [{4}:{5}]\nset ytics 1e-9,1e3\n"
      "set format y '10^{{%L}}'\n"
      "set object 1 rectangle from graph 0, first 1 to graph 1, graph 1 fc rgb '#f3e3e0' fs solid "
      "noborder behind\n"
      "set label 1 'failed' at graph 0.02, graph 0.94 tc rgb '#8a4a3a'\n",
      lowest, highest, low, high, lowest / 3.0, top);
  if (item.log_x) {
    text += fmt::format("set logscale x\nset xrange [{}:{}]\n", low / 1.3, high * 1.3);
    text += high / low >= 1e3 ? "set format x '10^{%L}'\n" : "set format x '%g'\n";
    if (high / low > 1e6) text += "set xtics 100\n";
  } else {
    text +=
        fmt::format("set xrange [{}:{}]\n", low - 0.03 * (high - low), high + 0.03 * (high - low));
  }
  text += "set ylabel 'worst measure / its limit' offset 1,0\nunset key\n" +
          legend(item, drawing.width_px, height_px);
  for (std::size_t s = 0; s < series.size(); ++s) {
    text += panel_margins(static_cast<int>(s), panels, apart_px, 24, height_px);
    text += fmt::format("set title {} noenhanced offset 0,-0.6\nset xlabel {} noenhanced\n",
                        analysis::gnuplot_quote(series[s]), analysis::gnuplot_quote(item.x_name));
    if (s == 1) text += "unset ylabel\nset format y ''\n";
    text += "plot 1 with lines lw 1 dt 2 lc rgb '#8a4a3a' notitle";
    // Ours last, on top.
    for (std::size_t m = item.methods.size(); m-- > 0;) {
      const std::string& method = item.methods[m];
      text += fmt::format(
          ", \\\n  '{}.csv' using (place(column('x'))):(strcol('method') eq '{}' && "
          "strcol('series') eq {} ? shown(column('severity')) : NaN) with linespoints ls {} "
          "notitle",
          table, method, analysis::gnuplot_quote(series[s]), line_style(method));
    }
    text += "\n";
    if (s > 0) continue;  // all panels would draw the legend, on top of one another
    for (int m = 0; m < static_cast<int>(item.methods.size()); ++m)
      text += fmt::format("unset label {}\n", legend_labels + m);
  }
  if (item.shows_speeds) {
    text += panel_margins(panels - 1, panels, apart_px, 24, height_px) + speeds_panel(done, table);
  }
  text += "unset multiplot\n";
  return drawing;
}

/// Lines between cells of a map that hold and cells that fail.
std::string map_border(const ItemResults& done, const std::string& method,
                       const std::vector<double>& xs, const std::vector<double>& ys) {
  const auto failed = [&](std::size_t i, std::size_t j) {
    return std::any_of(done.results.begin(), done.results.end(), [&](const Result& r) {
      return r.method == method && r.x == xs[i] && r.y == ys[j] && r.verdict.failed();
    });
  };
  const auto line = [](double x0, double y0, double x1, double y1) {
    return fmt::format("set arrow from {},{} to {},{} nohead front lw 3 lc rgb '#000000'\n", x0, y0,
                       x1, y1);
  };
  std::string text = "unset arrow\n";
  for (std::size_t i = 0; i < xs.size(); ++i) {
    for (std::size_t j = 0; j < ys.size(); ++j) {
      const auto x = static_cast<double>(i), y = static_cast<double>(j);
      if (i + 1 < xs.size() && failed(i, j) != failed(i + 1, j)) {
        text += line(x + 0.5, y - 0.5, x + 0.5, y + 0.5);
      }
      if (j + 1 < ys.size() && failed(i, j) != failed(i, j + 1)) {
        text += line(x - 0.5, y + 0.5, x + 0.5, y + 0.5);
      }
    }
  }
  return text;
}

std::string tics(const std::vector<double>& values) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += fmt::format("{}'{:g}' {}", i == 0 ? "" : ", ", values[i], i);
  }
  return "(" + text + ")";
}

/// The same tics without their numbers.
std::string bare_tics(const std::vector<double>& values) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += fmt::format("{}'' {}", i == 0 ? "" : ", ", i);
  }
  return "set ytics (" + text + ")\n";
}

/// gnuplot's conditional chain from a value of `column` to its number.
std::string number_of(const std::string& column, const std::vector<double>& values) {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += fmt::format("column('{}') == {:g} ? {} : ", column, values[i], i);
  }
  return "(" + text + "NaN)";
}

Drawing draw_map(const ItemResults& done) {
  const Item& item = done.item;
  std::set<double> x_set, y_set;
  for (const Case& test : item.cases) {
    x_set.insert(test.x);
    y_set.insert(test.y);
  }
  const std::vector<double> xs(x_set.begin(), x_set.end()), ys(y_set.begin(), y_set.end());
  const int panels = static_cast<int>(item.methods.size()), height_px = 330;
  Drawing drawing{figure_width(panels), height_px, ""};
  std::string& text = drawing.commands;
  text += fmt::format(
      "set termoption enhanced\nset multiplot\nunset grid\nunset key\nset border 15\n"
      "shown(s) = s > {1} ? {1} : s < {0} ? {0} : s\n"
      "label(s) = s > 1e4 ? '>10^4' : s < 1e-3 ? '<0.001' : s < 10 ? sprintf('%.2g', s) : "
      "sprintf('%.0f', s)\n"
      // Blue below 1, orange above, lighter towards 1: tells failure apart without red and green.
      "set palette defined (-3 '#0072B2', -0.001 '#d6e8f2', 0 '#fbe3d2', 4 '#D55E00')\n"
      "set cbrange [-3:4]\nunset colorbox\nset xtics {2}\nset ytics {3}\n"
      "set xrange [-0.5:{4}]\nset yrange [-0.5:{5}]\nset xlabel '{6}'\nset ylabel '{7}'\n",
      1e-3, 1e4, tics(xs), tics(ys), static_cast<double>(xs.size()) - 0.5,
      static_cast<double>(ys.size()) - 0.5, item.x_name, item.y_name);
  const std::string x = number_of("x", xs), y = number_of("y", ys);
  for (int m = 0; m < panels; ++m) {
    const std::string& method = at(item.methods, m);
    text += panel_margins(m, panels, 22.0, 0, height_px) + map_border(done, method, xs, ys);
    text += fmt::format("set title '{}' offset 0,-0.6\n", method_title(method));
    if (m == 1) text += "unset ylabel\n" + bare_tics(ys);
    const std::string mine = fmt::format("strcol('method') eq '{}'", method);
    text += fmt::format(
        "plot 'stability-{0}-map.csv' using ({1} ? {2} : NaN):{3}:(0.5):(0.5):"
        "(log10(shown(column('severity')))) with boxxyerror fs solid lc palette notitle, \\\n"
        "  '' using ({1} ? {2} : NaN):{3}:(label(column('severity'))) with labels font ',10' "
        "notitle\n",
        item.id, mine, x, y);
  }
  text += "unset multiplot\n";
  return drawing;
}

}  // namespace

Drawing draw(const ItemResults& item) {
  return item.item.y_name.empty() ? draw_curves(item) : draw_map(item);
}

}  // namespace pinchlab::experiments::stability
