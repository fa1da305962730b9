// SPDX-License-Identifier: GPL-3.0-or-later
// The report of a scale as data.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "analysis/design_check.h"
#include "analysis/json_estimate.h"
#include "analysis/scale_report.h"
#include "base/csv.h"

namespace pinchlab::analysis {
namespace {

using nlohmann::ordered_json;

ordered_json scale_object(const Scale& scale, const ComparisonsTable& table) {
  ordered_json object = {{"name", scale.name}, {"answers", scale.answers}};
  object["methods"] = ordered_json::array();
  for (std::size_t i = 0; i < table.methods.size(); ++i) {
    const auto value = [&](const ScaleFit& fit) {
      return fit.why_not.empty() ? Estimate(fit.values[i]) : Estimate::none(fit.why_not);
    };
    ordered_json method = {{"name", table.methods[i]}};
    put(method, "value", scale.values[i].value);
    put(method, "low", scale.values[i].low);
    put(method, "high", scale.values[i].high);
    put(method, "bradley_terry", value(scale.bradley_terry));
    put(method, "thurstone", value(scale.thurstone));
    put(method, "jod",
        scale.thurstone.why_not.empty() ? Estimate(jod_of(scale.thurstone.values[i]))
                                        : Estimate::none(scale.thurstone.why_not));
    object["methods"].push_back(std::move(method));
  }
  return object;
}

std::string values_csv(const ScaleReport& report, const ComparisonsTable& table) {
  std::string csv = "demonstration,method,value,low,high\n";
  std::vector<const Scale*> scales = {&report.all};
  for (const Scale& one : report.demonstrations) scales.push_back(&one);
  const auto cell = [](const Estimate& value) {
    return value ? fmt::format("{}", value.value) : "";
  };
  for (const Scale* scale : scales) {
    for (std::size_t i = 0; i < table.methods.size(); ++i) {
      const ScaleValueOf& value = scale->values[i];
      csv += fmt::format("{},{},{},{},{}\n", csv_cell(scale->name), csv_cell(table.methods[i]),
                         cell(value.value), cell(value.low), cell(value.high));
    }
  }
  return csv;
}

std::string pairs_csv(const ScaleReport& report, const ComparisonsTable& table) {
  std::string csv = "first,second,first_wins,second_wins,ties,difference,low,high,p,p_holm\n";
  const auto cell = [](const Estimate& value) {
    return value ? fmt::format("{}", value.value) : "";
  };
  for (const ScalePair& pair : report.pairs) {
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csv_cell(table.methods[pair.first]),
                       csv_cell(table.methods[pair.second]), pair.wins, pair.losses, pair.ties,
                       report.fit().why_not.empty() ? fmt::format("{}", pair.difference) : "",
                       cell(pair.low), cell(pair.high), cell(pair.p), cell(pair.p_holm));
  }
  return csv;
}

std::string participants_csv(const ScaleReport& report, const ComparisonsTable& table) {
  std::string csv =
      "participant,answers,log_likelihood_per_answer,far_out,rounds,circular_triads\n";
  for (const ObserverFit& fit : report.observers) {
    csv += fmt::format(
        "{},{},{},{},{},{}\n", csv_cell(table.participants[fit.participant]), fit.answers,
        fit.log_likelihood ? fmt::format("{}", fit.log_likelihood.value) : "",
        fit.is_far_out ? 1 : 0, report.transitivity.rounds_of_participant[fit.participant],
        report.transitivity.of_participant[fit.participant]);
  }
  return csv;
}

// Every two methods against one another.
void put_pairs(const ScaleReport& report, const ComparisonsTable& table, ordered_json& document) {
  document["pairs"] = ordered_json::array();
  for (const ScalePair& pair : report.pairs) {
    ordered_json object = {{"first", table.methods[pair.first]},
                           {"second", table.methods[pair.second]},
                           {"first_wins", pair.wins},
                           {"second_wins", pair.losses},
                           {"ties", pair.ties}};
    const std::string& why_not = report.fit().why_not;
    put(object, "difference",
        why_not.empty() ? Estimate(pair.difference) : Estimate::none(why_not));
    put(object, "low", pair.low);
    put(object, "high", pair.high);
    put(object, "p", pair.p);
    put(object, "p_holm", pair.p_holm);
    document["pairs"].push_back(std::move(object));
  }
}

// Do methods and demonstrations differ, does the model fit, does the side matter?
void put_tests(const ScaleReport& report, ordered_json& document) {
  ordered_json equal = {{"score", report.equal.score},
                        {"df", report.equal.df},
                        {"sign_flip_exact", report.equal.exact}};
  put(equal, "p_chi_square", report.equal.p_chi_square);
  put(equal, "p_sign_flip", report.equal.p_sign_flip);
  document["equal"] = std::move(equal);
  ordered_json difference;
  put(difference, "statistic", report.difference.statistic);
  put(difference, "p", report.difference.p);
  document["demonstrations_differ"] = std::move(difference);
  const ScaleFit& fit = report.fit();
  if (fit.why_not.empty()) document["fit"] = {{"deviance", fit.deviance}, {"df", fit.df}};
  ordered_json side;
  put(side, "value", report.p_side ? report.with_side.side : Estimate::none(report.p_side.why_not));
  put(side, "p", report.p_side);
  document["left"] = std::move(side);
}

void put_transitivity(const Transitivity& t, ordered_json& document) {
  ordered_json transitivity = {{"rounds", t.rounds},
                               {"circular_triads", t.triads},
                               {"rounds_without", t.without},
                               {"by_chance_a_round", t.by_chance},
                               {"triples", t.triples},
                               {"weak_broken", t.weak},
                               {"moderate_broken", t.moderate},
                               {"strong_broken", t.strong}};
  put(transitivity, "consistence", t.consistence);
  put(transitivity, "p", t.p);
  document["transitivity"] = std::move(transitivity);
}

}  // namespace

double jod_of(double thurstone) {
  constexpr double three_quarters = 0.6744897501960817;  // normal quantile
  return thurstone / std::numbers::sqrt2 / three_quarters;
}

std::string scale_json(const ScaleReport& report, const ComparisonsTable& table) {
  ordered_json document;
  document["format"] = "pinchlab-scale";
  document["version"] = 1;
  document["software_version"] = PINCHLAB_VERSION;
  document["answer"] = scale_words(report, table);
  if (table.design) document["design"] = design_json(*table.design);
  document["model"] =
      report.options.model == ScaleModel::bradley_terry ? "bradley-terry" : "thurstone";
  document["alpha"] = report.options.alpha;
  document["seed"] = report.options.seed;
  document["resamples"] = report.options.resamples;
  document["participants"] = table.participants.size();
  document["answers"] = table.answers;
  document["ties"] = table.ties;
  document["excluded"] = ordered_json::array();
  for (const Exclusion& exclusion : table.exclusions) {
    document["excluded"].push_back(
        {{"participant", exclusion.participant}, {"reason", exclusion.reason}});
  }
  document["scale"] = scale_object(report.all, table);
  document["demonstrations"] = ordered_json::array();
  for (const Scale& one : report.demonstrations)
    document["demonstrations"].push_back(scale_object(one, table));
  put_pairs(report, table, document);
  put_tests(report, document);
  put_transitivity(report.transitivity, document);
  document["far_out"] = ordered_json::array();
  for (const ObserverFit& observer : report.observers) {
    if (observer.is_far_out)
      document["far_out"].push_back(table.participants[observer.participant]);
  }
  const std::string why_not = why_nobody_is_compared(report.observers);
  if (!why_not.empty()) document["far_out_reason"] = why_not;
  put_circumstances(document, report.circumstances);
  put_besides(document, report.besides);
  return document.dump(2) + "\n";
}

std::vector<CsvTable> scale_csv(const ScaleReport& report, const ComparisonsTable& table) {
  std::vector<CsvTable> tables = {{"scale.csv", values_csv(report, table)},
                                  {"pairs.csv", pairs_csv(report, table)}};
  if (!report.observers.empty())
    tables.push_back({"participants.csv", participants_csv(report, table)});
  for (CsvTable& csv : besides_csv(report.besides)) tables.push_back(std::move(csv));
  return tables;
}

}  // namespace pinchlab::analysis
