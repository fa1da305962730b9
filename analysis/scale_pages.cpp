// SPDX-License-Identifier: GPL-3.0-or-later
// The report of a scale, printed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/blocks.h"
#include "analysis/design_check.h"
#include "analysis/gnuplot.h"
#include "analysis/pages.h"
#include "analysis/scale_report.h"
#include "base/counted.h"
#include "base/partial_file.h"

namespace pinchlab::analysis {
namespace {

using Cells = std::vector<TextCell>;

std::string number(double value) {
  return fixed(value, 2);
}
std::string number(const Estimate& value) {
  return fixed(value, 2);
}
std::string interval(const Estimate& low, const Estimate& high) {
  return low && high ? fmt::format("{} to {}", number(low), number(high)) : "–";
}
std::string level_text(const ScaleReport& report) {
  return confidence_level(report.options.alpha);
}
const char* model_name(ScaleModel model) {
  return model == ScaleModel::bradley_terry ? "Bradley–Terry" : "Thurstone case V";
}
std::string unit_of(ScaleModel model) {
  return model == ScaleModel::bradley_terry ? "log-odds" : "standard deviations of one method";
}

const Estimate& p_equal(const ScaleReport& report) {
  return report.equal.p_sign_flip ? report.equal.p_sign_flip : report.equal.p_chi_square;
}

const char* how_equal(const EqualScale& equal) {
  if (!equal.p_sign_flip) return "against chi-square, answers taken as independent";
  return equal.exact ? "with all patterns of participants' choices turned round"
                     : "with the participants' choices turned round at random";
}

class Writer {
 public:
  Writer(const ScaleReport& report, const ComparisonsTable& table)
      : report_(report), table_(table) {}

  Document write() {
    document_.title = fmt::format("One scale for {} methods", table_.methods.size());
    add(Paragraph{scale_words(report_, table_)});
    add(Heading{"The scale"});
    scale();
    pairs();
    add(Heading{"Do demonstrations, sides and participants agree?"});
    agreement();
    observers();
    document_.add(besides_blocks(report_.besides, report_.options.alpha));
    add(Heading{"What went in"});
    input();
    add(Heading{"Methods"});
    methods();
    return std::move(document_);
  }

 private:
  void add(Block block) { document_.blocks.push_back(std::move(block)); }
  [[nodiscard]] TextCell p_cell(const Estimate& p) const {
    return analysis::p_cell(p, report_.options.alpha);
  }

  void scale() {
    const ScaleFit& fit = report_.fit();
    if (!fit.why_not.empty()) {
      add(Paragraph{fmt::format("There is no scale: {}.", fit.why_not)});
      return;
    }
    TableBlock block;
    block.caption = fmt::format(
        "Values on the {} scale ({}), which add up to 0, with {} intervals; beside them "
        "the other models' values",
        model_name(report_.options.model), unit_of(report_.options.model), level_text(report_));
    block.header = {"", "value", "interval", "Bradley–Terry", "Thurstone V", "JOD"};
    for (const std::size_t i : report_.order) {
      const ScaleValueOf& value = report_.all.values[i];
      const ScaleFit &bt = report_.all.bradley_terry, &normal = report_.all.thurstone;
      block.rows.push_back({{table_.methods[i]},
                            {number(value.value), true},
                            {interval(value.low, value.high)},
                            {bt.why_not.empty() ? number(bt.values[i]) : "–"},
                            {normal.why_not.empty() ? number(normal.values[i]) : "–"},
                            {normal.why_not.empty() ? number(jod_of(normal.values[i])) : "–"}});
    }
    add(std::move(block));
    add(FigureBlock{"scale"});
    if (report_.demonstrations.empty()) return;
    TableBlock each;
    each.caption = fmt::format("Values by demonstration ({}), with {} intervals",
                               model_name(report_.options.model), level_text(report_));
    each.header = {""};
    for (const std::size_t i : report_.order) each.header.push_back(table_.methods[i]);
    for (const Scale& one : report_.demonstrations) {
      Cells row{{one.name}};
      for (const std::size_t i : report_.order) {
        const ScaleValueOf& value = one.values[i];
        row.push_back({value.value ? fmt::format("{} ({})", number(value.value),
                                                 interval(value.low, value.high))
                                   : "–"});
      }
      each.rows.push_back(std::move(row));
    }
    add(std::move(each));
  }

  void pairs() {
    TableBlock block;
    block.caption = fmt::format(
        "Pairs: how often the first was chosen, and differences on the scale with {} intervals; p "
        "of no difference, Holm's over the pairs",
        level_text(report_));
    block.header = {"",           "chosen",   "share %", "by the scale %",
                    "difference", "interval", "p",       "p (Holm)"};
    if (table_.ties > 0) block.header.insert(block.header.begin() + 2, "ties");
    for (const ScalePair& pair : report_.pairs) {
      const std::int64_t decided = pair.wins + pair.losses;
      Cells row{
          {fmt::format("{} over {}", table_.methods[pair.first], table_.methods[pair.second])},
          {fmt::format("{} of {}", pair.wins, decided)}};
      if (table_.ties > 0) row.push_back({fmt::format("{}", pair.ties)});
      row.push_back({decided > 0 ? fmt::format("{:.1f}", 100.0 * static_cast<double>(pair.wins) /
                                                             static_cast<double>(decided))
                                 : "–"});
      const bool has_scale = report_.fit().why_not.empty();
      row.push_back({has_scale ? fmt::format("{:.1f}", 100.0 * pair.expected_share) : "–"});
      row.push_back({has_scale ? number(pair.difference) : "–"});
      row.push_back({interval(pair.low, pair.high)});
      row.push_back({p_text(pair.p)});
      row.push_back(p_cell(pair.p_holm));
      block.rows.push_back(std::move(row));
    }
    add(std::move(block));
  }

  void agreement() {
    const ScaleFit& fit = report_.fit();
    TableBlock block;
    block.caption = "Tests; the first is the one of equal methods to read";
    block.header = {"", "statistic", "df", "p"};
    const auto df = [](double value) { return fmt::format("{:g}", value); };
    const EqualScale& equal = report_.equal;
    block.rows.push_back({{fmt::format("All methods equal, sign flips over participants{}",
                                       equal.exact ? " (exact)" : "")},
                          {number(equal.score)},
                          {"–"},
                          p_cell(equal.p_sign_flip)});
    block.rows.push_back({{"All methods equal, answers taken as independent"},
                          {number(equal.score)},
                          {df(equal.df)},
                          {p_text(equal.p_chi_square)}});
    if (report_.demonstrations.size() > 1) {
      block.rows.push_back({{"Demonstrations have one scale, exchanged within participants"},
                            {number(report_.difference.statistic)},
                            {"–"},
                            p_cell(report_.difference.p)});
    }
    if (fit.why_not.empty() && fit.df > 0) {
      block.rows.push_back({{"The scale fits the pairs (deviance, answers taken as independent)"},
                            {number(fit.deviance)},
                            {df(fit.df)},
                            {p_text(chi_square_p(fit.deviance, fit.df))}});
    }
    if (report_.p_side) {
      block.rows.push_back(
          {{fmt::format("The left is chosen no more than the right: its value {}",
                        number(report_.with_side.side))},
           {number(report_.with_side.side.value / report_.with_side.side_se.value)},
           {"–"},
           p_cell(report_.p_side)});
    }
    add(std::move(block));
    const Transitivity& t = report_.transitivity;
    if (t.rounds > 0) {
      add(Paragraph{fmt::format(
          "Circular triads (A over B over C over A): {} in {} of all pairs by one "
          "participant, {:.2f} a round where chance gives {:.2f} of at most {:g} ({} that "
          "chance gives so few); {} none. Kendall's coefficient of consistence is "
          "{:.3f} on average.",
          t.triads, counted(t.rounds, "round"),
          static_cast<double>(t.triads) / static_cast<double>(t.rounds), t.by_chance, t.most,
          p_equation(t.p), counted(t.without, "round") + (t.without == 1 ? " has" : " have"),
          t.consistence.value)});
    }
    if (t.triples > 0) {
      add(Paragraph{fmt::format(
          "Of {} of methods, the shares of all answers break weak stochastic transitivity in {}, "
          "moderate in {}, strong in {}.",
          counted(t.triples, "triple"), t.weak, t.moderate, t.strong)});
    }
  }

  void observers() {
    const std::string why_not = why_nobody_is_compared(report_.observers);
    std::string names;
    for (const ObserverFit& fit : report_.observers) {
      if (!fit.is_far_out) continue;
      names += fmt::format("{}{} ({:.2f} an answer, {} circular triads)", names.empty() ? "" : ", ",
                           table_.participants[fit.participant], fit.log_likelihood.value,
                           report_.transitivity.of_participant[fit.participant]);
    }
    if (report_.observers.empty()) return;
    if (!why_not.empty()) {
      add(Paragraph{"Who chooses far otherwise than the others is not looked for: " + why_not +
                    "."});
      return;
    }
    add(Paragraph{
        names.empty()
            ? "No participant chooses far otherwise than the others (log-likelihood under the "
              "scale "
              "of all others, 1.5 interquartile ranges)."
            : fmt::format("Far from the others (log-likelihood under the scale of all others, "
                          "below the first quartile by 1.5 interquartile ranges): {}. Look at "
                          "their answers; that they differ is no reason to leave them out.",
                          names)});
  }

  void input() {
    add(Paragraph{fmt::format(
        "{}{}{} to pairs of {} methods{}.", counted(table_.answers, "answer"),
        table_.participants.empty() ? ""
                                    : " of " + counted(table_.participants.size(), "participant"),
        table_.ties > 0 ? ", " + ties_among(table_.ties) + "," : "", table_.methods.size(),
        table_.demonstrations.size() > 1
            ? fmt::format(" in {} demonstrations", table_.demonstrations.size())
            : "")});
    for (const Exclusion& exclusion : table_.exclusions) {
      add(Paragraph{fmt::format("{} was left out: {}.", exclusion.participant, exclusion.reason)});
    }
    document_.add(circumstance_blocks(report_.circumstances));
  }

  void methods() {
    add(Paragraph{fmt::format(
        "Bradley and Terry's model{} by maximum likelihood{}; Thurstone's case V{}. {} Equal "
        "methods: score statistic of Bradley and Terry's model, {}. Demonstrations: squared "
        "residual wins, demonstrations exchanged "
        "within participants. alpha = {}, seed = {}, {} resamples, Pinchlab {}.",
        table_.ties > 0 ? " with Davidson's ties" : "",
        report_.options.model == ScaleModel::bradley_terry ? " (read)" : "",
        table_.ties > 0 ? " with Glenn and David's ties" : "",
        report_.fit().robust.size > 0
            ? fmt::format("Intervals and tests of pairs: sandwich covariance over {} participants, "
                          "Student's t with {} df.",
                          report_.fit().clusters, report_.fit().clusters - 1)
            : "Intervals and tests of pairs take all answers as independent.",
        how_equal(report_.equal), report_.options.alpha, report_.options.seed,
        report_.options.resamples, PINCHLAB_VERSION)});
  }

  const ScaleReport& report_;
  const ComparisonsTable& table_;
  Document document_;
};

Figure scale_figure(const ScaleReport& report, const ComparisonsTable& table) {
  const std::size_t rows = report.order.size();
  std::string script = fmt::format(
      "set yrange [{}:0.3]\nset xtics tc rgb '#333333'\nset xlabel {}\nset grid xtics lc rgb "
      "'#e0e0e0' lt 1\nset border 3 lc rgb '#888888'\nset tics nomirror scale 0.5\nset arrow from "
      "0, graph 0 to 0, graph 1 nohead dt 2 lw 1.5 lc rgb '#333333'\nset key above\nset ytics (",
      static_cast<double>(rows) + 0.7,
      gnuplot_quote(
          fmt::format("value ({}), higher: chosen more often", unit_of(report.options.model))));
  std::string all, each;
  for (std::size_t i = 0; i < rows; ++i) {
    const std::size_t method = report.order[i];
    script += fmt::format("{}{} {}", i == 0 ? "" : ", ", gnuplot_tic(table.methods[method]), i + 1);
    const ScaleValueOf& value = report.all.values[method];
    all += fmt::format("{:.6f} {:.6f} {:.6f} {}\n", value.value.value,
                       (value.low ? value.low : value.value).value,
                       (value.high ? value.high : value.value).value, i + 1);
    for (const Scale& one : report.demonstrations) {
      if (one.values[method].value) {
        each += fmt::format("{:.6f} {:.2f}\n", one.values[method].value.value,
                            static_cast<double>(i) + 1.22);
      }
    }
  }
  script += ") tc rgb '#333333'\n$all << EOD\n" + all + "EOD\n";
  if (!each.empty()) script += "$each << EOD\n" + each + "EOD\n";
  script += fmt::format(
      "plot $all using 1:4:2:3 with xerrorbars pt 7 ps 1.1 lw 2.5 lc rgb '#0072b2' title {}",
      gnuplot_quote(fmt::format("all answers, {} interval", level_text(report))));
  if (!each.empty()) {
    script +=
        ", \\\n  $each using 1:2 with points pt 6 ps 0.8 lc rgb '#777777' title 'single "
        "demonstrations'";
  }
  return {"scale",
          fmt::format("Values of the methods on the {} scale; dots with bars: all answers with {} "
                      "intervals{}.",
                      model_name(report.options.model), level_text(report),
                      each.empty() ? "" : "; rings: single demonstrations"),
          gnuplot_script("scale", 760, 130 + 60 * static_cast<int>(rows), script + "\n")};
}

}  // namespace

std::string scale_words(const ScaleReport& report, const ComparisonsTable& table) {
  const ScaleFit& fit = report.fit();
  const Estimate& p = p_equal(report);
  const std::string test = report.equal.p_sign_flip
                               ? "sign flips over participants"
                               : "score test that takes all answers as independent";
  const bool differ = p && p.value < report.options.alpha;
  std::string text =
      (table.is_pilot ? "Answers of a pilot. " : "") +
      fmt::format("The methods {} ({}, {}). ",
                  differ ? "are not chosen equally often" : "cannot be told apart by these answers",
                  test, p_equation(p));
  if (!fit.why_not.empty()) {
    return text + fmt::format("They have no scale: {}.", fit.why_not) + design_words(table.design);
  }
  text += fmt::format("From the most chosen to the least, on the {} scale:",
                      model_name(report.options.model));
  for (const std::size_t i : report.order) {
    const ScaleValueOf& value = report.all.values[i];
    text += fmt::format("{} {} {} ({})", i == report.order.front() ? "" : ",", table.methods[i],
                        number(value.value), interval(value.low, value.high));
  }
  text += fmt::format(" ({} intervals).", level_text(report));
  std::string apart, together, untested;
  for (const ScalePair& pair : report.pairs) {
    std::string& list = !pair.p_holm                               ? untested
                        : pair.p_holm.value < report.options.alpha ? apart
                                                                   : together;
    list += fmt::format("{}{} {} {}", list.empty() ? "" : ", ", table.methods[pair.first],
                        &list == &apart ? "over" : "and", table.methods[pair.second]);
  }
  if (differ && !apart.empty())
    text += fmt::format(" After Holm's correction these hold: {}.", apart);
  if (!together.empty()) text += fmt::format(" Not told apart: {}.", together);
  if (!untested.empty()) {
    text += fmt::format(" Not tested, since participants do not differ at all: {}.", untested);
  }
  if (report.difference.p && report.difference.p.value < report.options.alpha) {
    text += fmt::format(
        " Demonstrations differ in their scales ({}), so that the common one is an average of "
        "unlike cases.",
        p_equation(report.difference.p));
  }
  return text + design_words(table.design);
}

std::vector<std::string> write_scale_report(const ScaleReport& report,
                                            const ComparisonsTable& table,
                                            const std::filesystem::path& folder,
                                            bool with_figures) {
  StagingFolder staging(folder);
  std::vector<Figure> figures;
  if (with_figures && report.fit().why_not.empty()) figures.push_back(scale_figure(report, table));
  if (with_figures) std::ranges::move(besides_figures(report.besides), std::back_inserter(figures));
  write_pages(Writer(report, table).write(), std::move(figures), staging);
  for (const CsvTable& csv : scale_csv(report, table)) staging.write(csv.name, csv.content);
  return keep_report(scale_json(report, table), staging, table.sources);
}

}  // namespace pinchlab::analysis
