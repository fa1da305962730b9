// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/threshold_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "analysis/design_check.h"
#include "analysis/gnuplot.h"
#include "analysis/json_estimate.h"
#include "analysis/pages.h"
#include "base/counted.h"
#include "base/csv.h"
#include "base/input_error.h"
#include "base/partial_file.h"

namespace pinchlab::analysis {

namespace {

using nlohmann::ordered_json;

const char* shape_name(Shape shape) {
  return shape == Shape::logistic  ? "logistic"
         : shape == Shape::weibull ? "Weibull"
                                   : "cumulative normal";
}

std::string hits_name(const LevelsTable& table) {
  return table.correct ? "correct answers" : "choices of the method under test";
}

std::string name_of(const Series& series) {
  return series.name.empty() ? "all answers" : series.name;
}

std::string number(const Estimate& value) {
  return value ? fmt::format("{:.4g}", value.value) : "–";
}
std::string interval(const Estimate& low, const Estimate& high) {
  if (!low && !high) return "–";
  return fmt::format("{} to {}", low ? number(low) : "unbounded",
                     high ? number(high) : "unbounded");
}

// How many participants are known: totals name none.
std::size_t participants_of(const Series& series) {
  return series.observers.front().name.empty() ? 0 : series.observers.size();
}

std::int64_t answers_of(const Series& series) {
  std::int64_t sum = 0;
  for (const Observer& observer : series.observers) {
    for (const LevelCell& cell : observer.cells) sum += cell.trials;
  }
  return sum;
}

// The totals of all participants at each level.
std::vector<LevelCell> totals_of(const Series& series) {
  std::map<double, LevelCell> sums;
  for (const Observer& observer : series.observers) {
    for (const LevelCell& cell : observer.cells) {
      LevelCell& sum = sums[cell.level];
      sum.level = cell.level;
      sum.trials += cell.trials;
      sum.hits += cell.hits;
    }
  }
  std::vector<LevelCell> totals;
  totals.reserve(sums.size());
  for (const auto& [level, sum] : sums) totals.push_back(sum);
  return totals;
}

double spread_of(const PsychometricFit& fit) {
  return fit.spread ? fit.spread.value : 0.0;
}

// What the fits and their intervals take participants for.
std::string how_participants(const ThresholdReport& report) {
  const auto has_spread = [](const PsychometricFit& fit) { return bool(fit.spread); };
  const bool any = std::ranges::any_of(report.fits, has_spread);
  const bool all = std::ranges::all_of(report.fits, has_spread);
  std::string text;
  if (any) {
    text = fmt::format(
        "Participants have their own thresholds, normally distributed{}; 11-point adaptive "
        "Gauss–Hermite quadrature. Profile intervals with the cut-off that is exact for the mean "
        "of as many normal values as there are participants.",
        report.model.shape == Shape::weibull ? " on the logarithmic axis" : "");
  }
  if (!all) {
    text += fmt::format(
        "{} one threshold; profile intervals with the cut-off of chi-square, one degree of "
        "freedom, which takes all answers as independent.",
        any ? " A single participant, or totals, have" : "A single participant, or totals, with");
  }
  return text;
}

// Share of hits at the threshold, of the average participant.
double share_at_threshold(const ThresholdReport& report, const PsychometricFit& fit) {
  return fit.curve.guess + (1.0 - fit.curve.guess - fit.curve.lapse) * report.model.threshold_at;
}

std::string level_text(const ThresholdReport& report) {
  return confidence_level(report.options.alpha);
}

void fit_tables(const ThresholdReport& report, const LevelsTable& table, Document& document) {
  TableBlock thresholds;
  thresholds.caption = fmt::format(
      "Thresholds and slopes with {} intervals: by profile likelihood, and by {} "
      "studies simulated from the fit (percentiles)",
      level_text(report), report.options.resamples);
  thresholds.header = {"",          "participants", "answers", "threshold", "profile",
                       "bootstrap", "slope",        "profile", "bootstrap", "spread of thresholds"};
  TableBlock fits;
  fits.caption = "Rates and goodness of fit; p: share of simulated studies that fit worse";
  fits.header = {"", "guesses", "lapses", "width", "deviance", "p"};
  for (size_t i = 0; i < table.series.size(); ++i) {
    const Series& series = table.series[i];
    const PsychometricFit& fit = report.fits[i];
    if (!fit.threshold) {
      document.blocks.push_back(Paragraph{
          fmt::format("{} is not estimable: {}.", name_of(series), fit.threshold.why_not)});
      continue;
    }
    thresholds.rows.push_back(
        {{name_of(series)},
         {participants_of(series) > 0 ? fmt::format("{}", participants_of(series)) : "–"},
         {fmt::format("{}", answers_of(series))},
         {number(fit.threshold), true},
         {interval(fit.threshold_low, fit.threshold_high)},
         {interval(fit.bootstrap_threshold_low, fit.bootstrap_threshold_high)},
         {number(fit.slope)},
         {interval(fit.slope_low, fit.slope_high)},
         {interval(fit.bootstrap_slope_low, fit.bootstrap_slope_high)},
         {number(fit.spread)}});
    fits.rows.push_back({{name_of(series)},
                         {fmt::format("{:.3f}", fit.guess.value)},
                         {fmt::format("{:.3f}", fit.lapse.value)},
                         {number(fit.width)},
                         {fmt::format("{:.2f}", fit.deviance.value)},
                         p_cell(fit.p_deviance, report.options.alpha)});
  }
  if (thresholds.rows.empty()) return;
  document.blocks.push_back(std::move(thresholds));
  document.blocks.push_back(FigureBlock{"psychometric"});
  document.blocks.push_back(std::move(fits));
}

std::string input_words(const LevelsTable& table) {
  std::int64_t answers = 0;
  std::set<std::string> people;
  for (const Series& series : table.series) {
    answers += answers_of(series);
    for (const Observer& observer : series.observers) people.insert(observer.name);
  }
  people.erase("");
  return fmt::format("{}{} to {} graded series.", counted(answers, "answer"),
                     people.empty() ? "" : " of " + counted(people.size(), "participant"),
                     table.series.size());
}

Document threshold_document(const ThresholdReport& report, const LevelsTable& table) {
  Document document;
  document.title = "Psychometric functions";
  document.blocks.push_back(Paragraph{threshold_words(report, table)});
  document.blocks.push_back(Heading{"Thresholds"});
  fit_tables(report, table, document);
  document.add(besides_blocks(report.besides, report.options.alpha));
  document.blocks.push_back(Heading{"What went in"});
  document.blocks.push_back(Paragraph{input_words(table)});
  document.add(circumstance_blocks(report.circumstances));
  for (const Exclusion& exclusion : table.exclusions) {
    document.blocks.push_back(
        Paragraph{fmt::format("{} was left out: {}.", exclusion.participant, exclusion.reason)});
  }
  TableBlock counts;
  counts.caption = fmt::format("Totals at each level: {} of all answers", hits_name(table));
  counts.header = {"", "level", "of all", "share %", "fitted %"};
  for (size_t i = 0; i < table.series.size(); ++i) {
    const PsychometricFit& fit = report.fits[i];
    for (const LevelCell& cell : totals_of(table.series[i])) {
      const double share = static_cast<double>(cell.hits) / static_cast<double>(cell.trials);
      counts.rows.push_back(
          {{name_of(table.series[i])},
           {fmt::format("{:g}", cell.level)},
           {fmt::format("{} of {}", cell.hits, cell.trials)},
           {fmt::format("{:.1f}", 100.0 * share)},
           {fit.threshold
                ? fmt::format("{:.1f}", 100.0 * population_psi(report.model, fit.curve,
                                                               spread_of(fit), cell.level))
                : "–"}});
    }
  }
  document.blocks.push_back(std::move(counts));
  document.blocks.push_back(Heading{"Methods"});
  const auto rate = [](const Rate& r, const char* name) {
    return r.free ? fmt::format("{} estimated within 0 to {:g}", name, r.most)
                  : fmt::format("{} fixed at {:g}", name, r.value);
  };
  document.blocks.push_back(Paragraph{fmt::format(
      "A {} function of the {} by maximum likelihood, {} and {}; the threshold is the level at "
      "which the function has {:g} % of its height between the two. {} The slope is that of the "
      "standard function's argument{}. Deviance of the "
      "levels' totals, against studies simulated from the fit and fitted again. alpha = {}, seed = "
      "{}, Pinchlab {}.",
      shape_name(report.model.shape),
      report.model.shape == Shape::weibull ? "logarithm of the level" : "level",
      rate(report.model.guess, "guesses"), rate(report.model.lapse, "lapses"),
      100.0 * report.model.threshold_at, how_participants(report),
      report.model.shape == Shape::weibull ? " (Weibull's exponent)" : "", report.options.alpha,
      report.options.seed, PINCHLAB_VERSION)});
  return document;
}

// The function of one series with its data, in one colour.
void add_series(const ThresholdReport& report, const Series& series, const PsychometricFit& fit,
                size_t index, std::string& data, std::string& plot) {
  constexpr const char* colours[] = {"#0072B2", "#D55E00", "#009E73",
                                     "#CC79A7", "#E69F00", "#56B4E9"};
  const std::string colour = fmt::format("lc rgb '{}'", colours[index % 6]);
  const std::vector<LevelCell> totals = totals_of(series);
  data += fmt::format("$points{} << EOD\n", index);
  for (const LevelCell& cell : totals) {
    const Interval wilson =
        wilson_interval({cell.hits, cell.trials - cell.hits}, report.options.alpha);
    data += fmt::format("{} {:.4f} {:.4f} {:.4f}\n", cell.level,
                        100.0 * static_cast<double>(cell.hits) / static_cast<double>(cell.trials),
                        100.0 * wilson.low, 100.0 * wilson.high);
  }
  data += "EOD\n";
  plot += fmt::format("{}$points{} using 1:2:3:4 with yerrorbars pt 7 ps 0.7 lw 1.5 {} {}",
                      plot.empty() ? "plot " : ", \\\n  ", index, colour,
                      fit.threshold ? "notitle" : "title " + gnuplot_quote(name_of(series)));
  if (!fit.threshold) return;
  data += fmt::format("$curve{} << EOD\n", index);
  const double low = totals.front().level, high = totals.back().level;
  for (int i = 0; i <= 200; ++i) {
    const double f = i / 200.0;
    const double level = report.model.shape == Shape::weibull ? low * std::pow(high / low, f)
                                                              : low + f * (high - low);
    data += fmt::format("{} {:.4f}\n", level,
                        100.0 * population_psi(report.model, fit.curve, spread_of(fit), level));
  }
  data += "EOD\n";
  plot += fmt::format(", \\\n  $curve{} using 1:2 with lines lw 2.5 {} title {}", index, colour,
                      gnuplot_quote(name_of(series)));
  if (!fit.threshold_low || !fit.threshold_high) return;
  data += fmt::format("$threshold{} << EOD\n{} {:.4f} {} {}\nEOD\n", index, fit.threshold.value,
                      100.0 * share_at_threshold(report, fit), fit.threshold_low.value,
                      fit.threshold_high.value);
  plot +=
      fmt::format(", \\\n  $threshold{} using 1:2:3:4 with xerrorbars pt 13 ps 1.6 lw 3 {} notitle",
                  index, colour);
}

Figure threshold_figure(const ThresholdReport& report, const LevelsTable& table) {
  std::string data, plot;
  double low = 1e300, high = -1e300, lowest = 100.0;
  for (size_t i = 0; i < table.series.size(); ++i) {
    add_series(report, table.series[i], report.fits[i], i, data, plot);
    for (const LevelCell& cell : totals_of(table.series[i])) {
      low = std::min(low, cell.level);
      high = std::max(high, cell.level);
      const Interval wilson =
          wilson_interval({cell.hits, cell.trials - cell.hits}, report.options.alpha);
      lowest = std::min(lowest, 100.0 * wilson.low);
    }
  }
  const bool logarithmic = report.model.shape == Shape::weibull;
  const double margin = 0.03 * (high - low);
  const std::string range =
      logarithmic ? fmt::format("set logscale x\nset xrange [{}:{}]\n", low / 1.06, high * 1.06)
                  : fmt::format("set xrange [{}:{}]\n", low - margin, high + margin);
  const std::string axes = fmt::format(
      "{}set yrange [{}:102]\nset ytics 0,25,100 format '%g %%' tc rgb '#333333'\nset xtics tc rgb "
      "'#333333'\nset grid ytics lc rgb '#e0e0e0' lt 1\nset border 3 lc rgb '#888888'\nset tics "
      "nomirror scale 0.5\nset xlabel 'level'\nset ylabel {}\nset key above\n",
      range, table.correct && lowest > 27.0 ? 25 : -2, gnuplot_quote(hits_name(table)));
  return {"psychometric",
          fmt::format("Share of {} at each level (all participants together, {} Wilson intervals), "
                      "the fitted functions of the population, and the thresholds with their "
                      "profile-likelihood intervals.",
                      hits_name(table), level_text(report)),
          gnuplot_script("psychometric", 760, 480, data + axes + plot + "\n")};
}

struct NamedEstimate {
  const char* name;
  const Estimate PsychometricFit::*value;
};
constexpr NamedEstimate estimates[] = {
    {"threshold", &PsychometricFit::threshold},
    {"threshold_low", &PsychometricFit::threshold_low},
    {"threshold_high", &PsychometricFit::threshold_high},
    {"threshold_bootstrap_low", &PsychometricFit::bootstrap_threshold_low},
    {"threshold_bootstrap_high", &PsychometricFit::bootstrap_threshold_high},
    {"slope", &PsychometricFit::slope},
    {"slope_low", &PsychometricFit::slope_low},
    {"slope_high", &PsychometricFit::slope_high},
    {"slope_bootstrap_low", &PsychometricFit::bootstrap_slope_low},
    {"slope_bootstrap_high", &PsychometricFit::bootstrap_slope_high},
    {"width", &PsychometricFit::width},
    {"guess", &PsychometricFit::guess},
    {"lapse", &PsychometricFit::lapse},
    {"spread", &PsychometricFit::spread},
    {"deviance", &PsychometricFit::deviance},
    {"p_deviance", &PsychometricFit::p_deviance}};

std::string thresholds_csv(const ThresholdReport& report, const LevelsTable& table) {
  std::string csv = "series,participants,answers";
  for (const NamedEstimate& estimate : estimates) csv += fmt::format(",{}", estimate.name);
  csv += "\n";
  for (size_t i = 0; i < table.series.size(); ++i) {
    const Series& series = table.series[i];
    csv += fmt::format("{},{},{}", csv_cell(name_of(series)), participants_of(series),
                       answers_of(series));
    for (const NamedEstimate& estimate : estimates) {
      const Estimate& value = report.fits[i].*estimate.value;
      csv += value ? fmt::format(",{}", value.value) : ",";
    }
    csv += "\n";
  }
  return csv;
}

std::string participants_csv(const ThresholdReport& report, const LevelsTable& table) {
  std::string csv = "series,participant,threshold\n";
  for (size_t i = 0; i < table.series.size(); ++i) {
    const auto& thresholds = report.fits[i].participant_thresholds;
    for (size_t j = 0; j < thresholds.size(); ++j) {
      csv += fmt::format("{},{},{}\n", csv_cell(name_of(table.series[i])),
                         csv_cell(table.series[i].observers[j].name), thresholds[j]);
    }
  }
  return csv;
}

}  // namespace

ThresholdReport analyse_thresholds(const LevelsTable& table, const PsychometricModel& model,
                                   const PsychometricOptions& options) {
  ThresholdReport report{
      model, options, {}, circumstances(table.sessions, table.has_session_records), {}};
  report.besides = analyse_besides(table.besides, options.alpha, options.seed);
  for (const Series& series : table.series) {
    for (const LevelCell& cell : totals_of(series)) {
      if (model.shape == Shape::weibull && cell.level <= 0.0) {
        throw InputError(
            "--function weibull",
            fmt::format("level {:g} is not positive; take logistic or normal, or leave "
                        "that level out",
                        cell.level));
      }
    }
    report.fits.push_back(fit_psychometric(model, series.observers, options));
  }
  return report;
}

std::string threshold_words(const ThresholdReport& report, const LevelsTable& table) {
  std::string text = table.is_pilot ? "Answers of a pilot." : "";
  for (size_t i = 0; i < table.series.size(); ++i) {
    const Series& series = table.series[i];
    const PsychometricFit& fit = report.fits[i];
    const std::string of = series.name.empty() ? "" : fmt::format(" of {}", series.name);
    if (!text.empty()) text += " ";
    if (!fit.threshold) {
      text += fmt::format("The threshold{} is not estimable: {}.", of, fit.threshold.why_not);
      continue;
    }
    text += fmt::format(
        "The threshold{} is at level {} ({} interval {}): there {:.0f} % of the answers are {} "
        "({}{}).",
        of, number(fit.threshold), level_text(report),
        interval(fit.threshold_low, fit.threshold_high), 100.0 * share_at_threshold(report, fit),
        table.correct ? "correct" : "for the method under test",
        counted(answers_of(series), "answer"),
        series.observers.size() > 1 ? fmt::format(" of {} participants", series.observers.size())
                                    : "");
    const std::vector<LevelCell> totals = totals_of(series);
    if (fit.threshold.value < totals.front().level || fit.threshold.value > totals.back().level)
      text += " It lies outside of the levels that were shown, so do not rely on it.";
    const bool has_interval = fit.threshold_low || fit.threshold_high;
    if (!fit.slope) {
      text += fmt::format(" {}: {}.", has_interval ? "Take its interval" : "Do not rely on it",
                          fit.slope.why_not);
    }
    if (fit.p_deviance && fit.p_deviance.value < report.options.alpha) {
      text += fmt::format(" The function does not fit these answers well ({}).",
                          p_equation(fit.p_deviance));
    }
  }
  return text + design_words(table.design);
}

std::string threshold_json(const ThresholdReport& report, const LevelsTable& table) {
  ordered_json document;
  document["format"] = "pinchlab-thresholds";
  document["version"] = 1;
  document["software_version"] = PINCHLAB_VERSION;
  document["answer"] = threshold_words(report, table);
  if (table.design) document["design"] = design_json(*table.design);
  document["function"] = shape_name(report.model.shape);
  document["threshold_at"] = report.model.threshold_at;
  document["hits"] = hits_name(table);
  document["alpha"] = report.options.alpha;
  document["seed"] = report.options.seed;
  document["resamples"] = report.options.resamples;
  document["excluded"] = ordered_json::array();
  for (const Exclusion& exclusion : table.exclusions) {
    document["excluded"].push_back(
        {{"participant", exclusion.participant}, {"reason", exclusion.reason}});
  }
  document["series"] = ordered_json::array();
  for (size_t i = 0; i < table.series.size(); ++i) {
    const Series& series = table.series[i];
    ordered_json object;
    object["name"] = name_of(series);
    object["participants"] = participants_of(series);
    object["answers"] = answers_of(series);
    for (const NamedEstimate& estimate : estimates) {
      const Estimate& value = report.fits[i].*estimate.value;
      put(object, estimate.name, value);
    }
    object["levels"] = ordered_json::array();
    for (const LevelCell& cell : totals_of(series)) {
      object["levels"].push_back(
          {{"level", cell.level}, {"hits", cell.hits}, {"trials", cell.trials}});
    }
    document["series"].push_back(std::move(object));
  }
  put_circumstances(document, report.circumstances);
  put_besides(document, report.besides);
  return document.dump(2) + "\n";
}

std::vector<std::string> write_threshold_report(const ThresholdReport& report,
                                                const LevelsTable& table,
                                                const std::filesystem::path& folder,
                                                bool with_figures) {
  StagingFolder staging(folder);
  std::vector<Figure> figures;
  if (with_figures) {
    figures.push_back(threshold_figure(report, table));
    std::ranges::move(besides_figures(report.besides), std::back_inserter(figures));
  }
  write_pages(threshold_document(report, table), std::move(figures), staging);
  staging.write("thresholds.csv", thresholds_csv(report, table));
  staging.write("participants.csv", participants_csv(report, table));
  for (const CsvTable& csv : besides_csv(report.besides)) staging.write(csv.name, csv.content);
  return keep_report(threshold_json(report, table), staging, table.sources);
}

}  // namespace pinchlab::analysis
