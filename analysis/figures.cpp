// SPDX-License-Identifier: GPL-3.0-or-later
// Gnuplot scripts of the report's figures. Each stands alone with its data, so that a paper's
// authors can restyle it.
#include <fmt/format.h>

#include <algorithm>

#include "analysis/document.h"
#include "analysis/gnuplot.h"

namespace pinchlab::analysis {

namespace {

// Okabe and Ito's colours, which colour-blind readers tell apart.
constexpr const char* group_colours[] = {"#0072B2", "#D55E00", "#009E73",
                                         "#CC79A7", "#E69F00", "#56B4E9"};
constexpr const char* grey = "#555555";

constexpr size_t most_rows = 60;  // of one figure; the tables hold the rest

// What a caption says of rows that a figure has no room for.
std::string left_out(size_t shown, size_t all, const char* what) {
  return shown < all ? fmt::format(" {} of {} {}; the tables hold all.", shown, all, what) : "";
}

int height_of_rows(size_t rows) {
  return 130 + 34 * static_cast<int>(rows);
}

// Axes of a figure with one row an item: shares in percent to the right, row 1 on top.
std::string row_axes(const std::vector<std::string>& labels, const std::string& x_label) {
  std::string script = fmt::format(
      "set xrange [0:100]\nset yrange [{}:0.3]\nset xtics 0,25,100 format '%g %%' tc rgb "
      "'#333333'\nset xlabel {}\n"
      "set grid xtics lc rgb '#e0e0e0' lt 1\nset border 3 lc rgb '#888888'\nset tics nomirror "
      "scale 0.5\n"
      "set arrow from 50, graph 0 to 50, graph 1 nohead dt 2 lw 1.5 lc rgb '#333333'\nset ytics (",
      static_cast<double>(labels.size()) + 0.7, gnuplot_quote(x_label));
  for (size_t i = 0; i < labels.size(); ++i) {
    script += fmt::format("{}{} {}", i == 0 ? "" : ", ", gnuplot_tic(labels[i]), i + 1);
  }
  return script + ") tc rgb '#333333'\n";
}

std::string interval_line(double share, double low, double high, double y) {
  return fmt::format("{:.6f} {:.6f} {:.6f} {}\n", 100.0 * share, 100.0 * low, 100.0 * high, y);
}

Figure shares_figure(const Report& report) {
  const size_t rows = std::min(report.demonstrations.size(), most_rows);
  std::vector<std::string> labels;
  std::string data;
  std::string counts;
  // One data block a group, so that each gets its colour and its entry in the key.
  std::vector<std::string> names;
  for (size_t i = 0; i + 1 < report.groups.size(); ++i) names.push_back(report.groups[i].row.name);
  names.emplace_back("");
  std::vector<std::string> blocks(names.size());
  for (size_t i = 0; i < rows; ++i) {
    const DemonstrationResult& result = report.demonstrations[i];
    labels.push_back(result.row.name);
    const std::string group = result.groups.empty() ? "" : result.groups.front();
    const auto index =
        static_cast<size_t>(std::find(names.begin(), names.end(), group) - names.begin());
    const Reading& read = result.row.read;
    blocks[index] +=
        interval_line(result.row.share, read.low ? read.low.value : result.row.share,
                      read.high ? read.high.value : result.row.share, static_cast<double>(i + 1));
    counts += fmt::format("set label '{}/{}' at graph 1.02, first {} left textcolor rgb '{}'\n",
                          result.row.counts.pinch, result.row.counts.total(), i + 1, grey);
  }
  std::string plot;
  for (size_t i = 0; i < blocks.size(); ++i) {
    if (blocks[i].empty()) continue;
    data += fmt::format("$data{} << EOD\n{}EOD\n", i, blocks[i]);
    const bool named = i + 1 < blocks.size();
    plot += fmt::format("{}$data{} using 1:4:2:3 with xerrorbars pt 7 ps 0.9 lw 2 lc rgb '{}' {}",
                        plot.empty() ? "plot " : ", \\\n  ", i, named ? group_colours[i % 6] : grey,
                        named ? "title " + gnuplot_quote(names[i]) : "notitle");
  }
  const std::string& pinch = report.options.pinch_label;
  const std::string level = fmt::format("{:g} %", 100.0 * (1.0 - report.options.alpha));
  return {"shares",
          fmt::format("Share of answers for {} in each demonstration with {} intervals ({}); the "
                      "dashed line is chance. Right: answers for {} of all.{}",
                      pinch, level, first_tested(rows_of(report.demonstrations)).read.interval,
                      pinch, left_out(rows, report.demonstrations.size(), "demonstrations")),
          gnuplot_script("shares", 760, height_of_rows(rows),
                         data + row_axes(labels, "answers for " + pinch) + counts +
                             "set rmargin 9\nset key above\n" + plot + "\n")};
}

Figure groups_figure(const Report& report) {
  const size_t rows = std::min(report.groups.size(), most_rows);
  std::vector<std::string> labels;
  std::string naive;
  std::string corrected;
  std::string counts;
  for (size_t i = 0; i < rows; ++i) {
    const GroupResult& result = report.groups[report.groups.size() - rows + i];
    labels.push_back(result.row.name);
    const auto y = static_cast<double>(i + 1);
    naive +=
        interval_line(result.row.share, result.row.wilson.low, result.row.wilson.high, y - 0.12);
    const ClusterBootstrap& bootstrap = result.pooled.bootstrap;
    if (bootstrap.low) {
      corrected +=
          interval_line(result.row.share, bootstrap.low.value, bootstrap.high.value, y + 0.12);
    }
    counts += fmt::format("set label '{}/{}' at graph 1.02, first {} left textcolor rgb '{}'\n",
                          result.row.counts.pinch, result.row.counts.total(), y, grey);
  }
  std::string plot =
      "plot $naive using 1:4:2:3 with xerrorbars pt 6 ps 0.9 lw 2 lc rgb '#888888' "
      "title 'answers as independent (Wilson)'";
  std::string data = fmt::format("$naive << EOD\n{}EOD\n", naive);
  if (!corrected.empty()) {
    data += fmt::format("$corrected << EOD\n{}EOD\n", corrected);
    plot +=
        ", \\\n  $corrected using 1:4:2:3 with xerrorbars pt 5 ps 0.9 lw 2 lc rgb '#0072B2' "
        "title 'participants as units (cluster bootstrap)'";
  }
  const std::string& pinch = report.options.pinch_label;
  return {"groups",
          fmt::format("Share of answers for {} in each group with {:g} % intervals, taking all "
                      "answers as independent "
                      "and taking participants as units; the dashed line is chance.{}",
                      pinch, 100.0 * (1.0 - report.options.alpha),
                      left_out(rows, report.groups.size(), "groups")),
          gnuplot_script("groups", 760, height_of_rows(rows) + 20,
                         data + row_axes(labels, "answers for " + pinch) + counts +
                             "set rmargin 11\nset key above\n" + plot + "\n")};
}

// Points of shares over an upright axis in percent.
std::string point_line(double x, const Counts& counts, double alpha) {
  const Interval interval = wilson_interval(counts, alpha);
  const double share = static_cast<double>(counts.pinch) / static_cast<double>(counts.total());
  return fmt::format("{} {:.6f} {:.6f} {:.6f}\n", x, 100.0 * share, 100.0 * interval.low,
                     100.0 * interval.high);
}

constexpr const char* upright_axes =
    "set yrange [0:100]\nset ytics 0,25,100 format '%g %%' tc rgb '#333333'\nset grid ytics lc rgb "
    "'#e0e0e0' lt 1\n"
    "set border 3 lc rgb '#888888'\nset tics nomirror scale 0.5\nset key off\nunset arrow\n"
    "set arrow from graph 0, first 50 to graph 1, first 50 nohead dt 2 lw 1.5 lc rgb '#333333'\n";

std::string order_panel(const Report& report) {
  const auto& positions = report.order_effect.by_position;
  std::string data = "$order << EOD\n";
  const size_t shown = std::min<size_t>(positions.size(), 200);
  for (size_t i = 0; i < shown; ++i) {
    if (positions[i].total() == 0) continue;  // all ties
    data += point_line(static_cast<double>(i + 1), positions[i], report.options.alpha);
  }
  return data + "EOD\n" +
         fmt::format(
             "{}set title 'Order'\nset xrange [0.5:{}]\nset xtics autofreq {} tc rgb "
             "'#333333'\nset xlabel 'place "
             "of the "
             "answer in the session'\nset ylabel {}\n"
             "plot $order using 1:2:3:4 with yerrorbars pt 7 ps 0.8 lw 2 lc rgb '#0072B2'\n",
             upright_axes, static_cast<double>(shown) + 0.5, shown <= 12 ? "1" : "",
             gnuplot_quote("answers for " + report.options.pinch_label));
}

std::string side_panel(const Report& report) {
  const SideBias& side = report.side_bias;
  const std::string& pinch = report.options.pinch_label;
  std::string data = "$side << EOD\n";
  data += point_line(1.0, side.chosen, report.options.alpha);
  if (side.shown_left.total() > 0) data += point_line(2.0, side.shown_left, report.options.alpha);
  if (side.shown_right.total() > 0) data += point_line(3.0, side.shown_right, report.options.alpha);
  return data + "EOD\n" +
         fmt::format(
             "{}set title 'Side'\nset xrange [0.5:3.5]\nset xlabel ' '\nset ylabel 'share of "
             "answers'\n"
             "set xtics ('left clip chosen' 1, 'shown left' 2, 'shown right' 3) tc rgb '#333333'\n"
             "set label {} at 2.5, graph -0.17 center\n"
             "plot $side using 1:2:3:4 with yerrorbars pt 7 ps 0.8 lw 2 lc rgb '#D55E00'\n",
             upright_axes, gnuplot_quote(pinch + " chosen, by where it was"));
}

Figure effects_figure(const Report& report) {
  const bool order = !report.order_effect.by_position.empty();
  const bool side = report.side_bias.chosen.total() > 0;
  std::string body = order && side ? "set multiplot layout 1,2\n" : "";
  if (order) body += order_panel(report);
  if (side) body += side_panel(report);
  if (order && side) body += "unset multiplot\n";
  return {"effects",
          fmt::format("Answers for {} by their place in the session, and answers by side of the "
                      "screen, with {:g} % "
                      "Wilson intervals; the dashed line is one half.",
                      report.options.pinch_label, 100.0 * (1.0 - report.options.alpha)),
          gnuplot_script("effects", order && side ? 960 : 560, 380, body)};
}

}  // namespace

std::vector<Figure> make_figures(const Report& report) {
  std::vector<Figure> figures{shares_figure(report), groups_figure(report)};
  if (!report.order_effect.by_position.empty() || report.side_bias.chosen.total() > 0) {
    figures.push_back(effects_figure(report));
  }
  for (Figure& figure : besides_figures(report.besides)) figures.push_back(std::move(figure));
  return figures;
}

}  // namespace pinchlab::analysis
