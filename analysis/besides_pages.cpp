// SPDX-License-Identifier: GPL-3.0-or-later
// Confidence and places in the report.
#include <fmt/format.h>
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>

#include <algorithm>
#include <cmath>

#include "analysis/besides.h"
#include "analysis/gnuplot.h"
#include "analysis/json_estimate.h"
#include "analysis/report.h"
#include "base/csv.h"

namespace pinchlab::analysis {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t most_panels = 48;  // of the map; places.csv holds the rest

struct Quartiles {
  double low = 0, median = 0, high = 0;
};

Quartiles quartiles_of(const std::vector<ClickedPlace>& clicks, double ClickedPlace::*part) {
  std::vector<double> values;
  values.reserve(clicks.size());
  for (const ClickedPlace& click : clicks) values.push_back(click.*part);
  std::ranges::sort(values);
  const auto at = [&](double f) {
    return gsl_stats_quantile_from_sorted_data(values.data(), 1, values.size(), f);
  };
  return {at(0.25), at(0.5), at(0.75)};
}

std::string interval(const Estimate& low, const Estimate& high) {
  return low && high ? fmt::format("{} to {}", fixed(low, 2), fixed(high, 2)) : dash;
}

std::string reference_of(const Confidence& confidence) {
  return confidence.is_of_hits ? "hits and misses at the same level"
                               : "choices with and against most of the other participants";
}

std::vector<Block> confidence_blocks(const Confidence& confidence, double alpha) {
  TableBlock table;
  table.caption =
      fmt::format("Confidence: means of the participants' means, with {} intervals (Student's t)",
                  confidence_level(alpha));
  table.header = {"",
                  "answers",
                  "mean",
                  "interval",
                  confidence.is_of_hits ? "in hits" : "with most others",
                  confidence.is_of_hits ? "in misses" : "against most others"};
  for (const ConfidenceRow& row : confidence.rows) {
    table.rows.push_back({{row.name},
                          {fmt::format("{}", row.answers)},
                          {fixed(row.mean, 2)},
                          {interval(row.low, row.high)},
                          {fixed(row.mean_with, 2)},
                          {fixed(row.mean_against, 2)}});
  }
  std::string text;
  if (!confidence.area) {
    text = fmt::format("Whether confidence goes with the answers cannot be said: {}.",
                       confidence.area.why_not);
  } else {
    const SignedRank& test = confidence.test;
    text = fmt::format(
        "Does confidence tell {} apart? Of one answer of each kind by one participant, the {} was "
        "given with more confidence in {} (area under the type 2 ROC curve, ties count half, mean "
        "of the {} participants with answers of both kinds; {} interval {}; 50 % is by chance, "
        "Wilcoxon's signed-rank test over participants, {}).",
        reference_of(confidence), confidence.is_of_hits ? "hit" : "choice with the others",
        percent(confidence.area.value), test.positive + test.negative + test.zeros,
        confidence_level(alpha),
        confidence.area_low ? fmt::format("{:.1f} to {:.1f} %", 100 * confidence.area_low.value,
                                          100 * confidence.area_high.value)
                            : dash,
        p_equation(test.p));
  }
  return {Heading{"Confidence"}, Paragraph{text}, std::move(table)};
}

std::vector<Block> place_blocks(const Places& places, double alpha) {
  TableBlock table;
  table.caption =
      "Clicks on where it looks wrong, clip by clip: medians and quartiles of their shares of the "
      "clip's width (from the left) and height (from the top), and of the second of the clip";
  table.header = {"", "clip", "shown", "clicks", "participants", "x %", "y %", "second"};
  for (const PlaceRow& row : places.rows) {
    std::vector<TextCell> cells{{row.stimulus},
                                {row.clip},
                                {fmt::format("{}", row.shown)},
                                {fmt::format("{}", row.clicks.size())},
                                {fmt::format("{}", row.participants)}};
    const auto add = [&](double ClickedPlace::*part, double unit, int decimals) {
      if (row.clicks.empty()) {
        cells.push_back({dash});
        return;
      }
      const Quartiles q = quartiles_of(row.clicks, part);
      cells.push_back({fmt::format("{:.{}f} ({:.{}f} to {:.{}f})", unit * q.median, decimals,
                                   unit * q.low, decimals, unit * q.high, decimals)});
    };
    add(&ClickedPlace::x, 100, 0);
    add(&ClickedPlace::y, 100, 0);
    add(&ClickedPlace::time_s, 1, 2);
    table.rows.push_back(std::move(cells));
  }
  std::string text =
      fmt::format("In {} of {} answers the participant clicked on where it looks wrong.",
                  places.clicks, places.answers);
  if (places.p_sign_flip) {
    const bool differ = places.p_sign_flip.value < alpha;
    text += fmt::format(
        " {} clicks are in clips of {}, {} in clips of {}: {} (sign flips over participants, "
        "{}).",
        places.on_first, places.first, places.on_second, places.second,
        differ ? "more than chance between the two" : "no more than chance between the two",
        p_equation(places.p_sign_flip));
  }
  return {Heading{"Where it looks wrong"}, Paragraph{text}, FigureBlock{"places"},
          std::move(table)};
}

// One panel: the clip as a square, its clicks in it.
std::string panel(const PlaceRow& row) {
  std::string text = fmt::format("set title {} offset 0,-0.8 noenhanced\n$clicks << EOD\n",
                                 gnuplot_quote(fmt::format("{}, {}", row.stimulus, row.clip)));
  for (const ClickedPlace& click : row.clicks) {
    text += fmt::format("{:.4f} {:.4f}\n", 100 * click.x, 100 * click.y);
  }
  return text + "EOD\nplot $clicks using 1:2 with points pt 7 ps 0.5 lc rgb '#80D55E00' notitle\n";
}

}  // namespace

std::vector<Block> besides_blocks(const Besides& besides, double alpha) {
  Document part;
  if (besides.confidence) part.add(confidence_blocks(*besides.confidence, alpha));
  if (besides.places) part.add(place_blocks(*besides.places, alpha));
  return std::move(part.blocks);
}

void put_besides(ordered_json& document, const Besides& besides) {
  if (besides.confidence) {
    const Confidence& confidence = *besides.confidence;
    ordered_json object = {{"of", reference_of(confidence)}};
    const SignedRank& test = confidence.test;
    object["participants"] = test.positive + test.negative + test.zeros;
    put(object, "area", confidence.area);
    put(object, "area_low", confidence.area_low);
    put(object, "area_high", confidence.area_high);
    put(object, "p_signed_rank", test.p);
    put(object, "p_sign", test.p_sign);
    object["rows"] = ordered_json::array();
    for (const ConfidenceRow& row : confidence.rows) {
      ordered_json one = {{"name", row.name}, {"answers", row.answers}};
      put(one, "mean", row.mean);
      put(one, "low", row.low);
      put(one, "high", row.high);
      put(one, "mean_with", row.mean_with);
      put(one, "mean_against", row.mean_against);
      object["rows"].push_back(std::move(one));
    }
    document["confidence"] = std::move(object);
  }
  if (!besides.places) return;
  const Places& places = *besides.places;
  ordered_json object = {{"answers", places.answers}, {"clicks", places.clicks}};
  if (!places.first.empty()) {
    object["by_clip"] = {{places.first, places.on_first}, {places.second, places.on_second}};
  }
  put(object, "p_sign_flip", places.p_sign_flip);
  object["rows"] = ordered_json::array();
  for (const PlaceRow& row : places.rows) {
    ordered_json one = {{"stimulus", row.stimulus},
                        {"clip", row.clip},
                        {"shown", row.shown},
                        {"clicks", row.clicks.size()},
                        {"participants", row.participants}};
    if (!row.clicks.empty()) {
      one["x_median"] = quartiles_of(row.clicks, &ClickedPlace::x).median;
      one["y_median"] = quartiles_of(row.clicks, &ClickedPlace::y).median;
      one["time_s_median"] = quartiles_of(row.clicks, &ClickedPlace::time_s).median;
    }
    object["rows"].push_back(std::move(one));
  }
  document["places"] = std::move(object);
}

std::vector<CsvTable> besides_csv(const Besides& besides) {
  std::vector<CsvTable> tables;
  const auto cell = [](const Estimate& value) {
    return value ? fmt::format("{}", value.value) : "";
  };
  if (besides.confidence) {
    CsvTable csv{"confidence.csv", "name,answers,mean,low,high,mean_with,mean_against\n"};
    for (const ConfidenceRow& row : besides.confidence->rows) {
      csv.content +=
          fmt::format("{},{},{},{},{},{},{}\n", csv_cell(row.name), row.answers, cell(row.mean),
                      cell(row.low), cell(row.high), cell(row.mean_with), cell(row.mean_against));
    }
    tables.push_back(std::move(csv));
  }
  if (besides.places) {
    CsvTable csv{"places.csv", "participant,stimulus,clip,x,y,time_s\n"};
    for (const BesidesAnswer& answer : besides.answers) {
      if (!answer.place) continue;
      csv.content += fmt::format("{},{},{},{},{},{}\n", csv_cell(answer.participant),
                                 csv_cell(stimulus_of(answer)), csv_cell(answer.place->clip),
                                 answer.place->x, answer.place->y, answer.place->time_s);
    }
    tables.push_back(std::move(csv));
  }
  return tables;
}

std::vector<Figure> besides_figures(const Besides& besides) {
  if (!besides.places) return {};
  const std::vector<PlaceRow>& rows = besides.places->rows;
  const std::size_t panels = std::min(rows.size(), most_panels);
  constexpr std::size_t columns = 4;
  const std::size_t lines = (panels + columns - 1) / columns;
  std::string body = fmt::format(
      "set multiplot layout {},{} margins 0.04,0.98,0.03,{} spacing 0.05,{}\nset size square\nset "
      "xrange [0:100]\nset yrange [100:0]\nset xtics 0,50,100 format ''\nset ytics 0,50,100 format "
      "''\nset grid lc rgb '#e0e0e0' lt 1\nset border 15 lc rgb '#888888'\nset tics scale 0\n",
      lines, columns, 1 - 0.2 / static_cast<double>(lines), 0.25 / static_cast<double>(lines));
  std::size_t drawn = 0;
  for (; drawn < panels; ++drawn) body += panel(rows[drawn]);
  return {{"places",
           fmt::format("Clicks on where it looks wrong, in the frame of each clip (left to right, "
                       "top to bottom, as shown){}.",
                       panels < rows.size() ? fmt::format("; {} of {} clips, places.csv has all",
                                                          panels, rows.size())
                                            : ""),
           gnuplot_script("places", 960, 30 + 250 * static_cast<int>(lines),
                          body + "unset multiplot\n")}};
}

}  // namespace pinchlab::analysis
