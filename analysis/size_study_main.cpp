// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the false-positive rate of each pooled test under clustering and draws the chart of
// analysis/results: pinchlab_size_study --out analysis/results

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>

#include "analysis/gnuplot.h"
#include "analysis/result_main.h"
#include "analysis/size_study.h"
#include "base/number_option.h"
#include "base/partial_file.h"

using namespace pinchlab::analysis;
using pinchlab::number_in;
using pinchlab::StagingFolder;
using pinchlab::whole_in;

namespace {

struct Settings : ResultSettings {
  int studies = 10000;
  int resamples = 499;
  double alpha = 0.05;
};

struct Measured {
  SizeCondition condition;
  std::array<double, 6> rates;
};

constexpr std::array<int, 2> participants_of_panel{16, 64};
constexpr std::array<double, 7> correlations{0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5};

std::vector<Measured> measure(const Settings& settings) {
  std::vector<Measured> all;
  const auto start = std::chrono::steady_clock::now();
  const size_t total = participants_of_panel.size() * correlations.size();
  for (int participants : participants_of_panel) {
    for (double icc : correlations) {
      const SizeCondition condition{participants, 8, icc};
      all.push_back({condition, false_positive_rates(condition, settings.studies, settings.alpha,
                                                     settings.resamples, settings.seed)});
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
      fmt::print(stderr, "\r{} of {} conditions, about {:.0f} s left ", all.size(), total,
                 spent.count() / static_cast<double>(all.size()) *
                     static_cast<double>(total - all.size()));
    }
  }
  fmt::print(stderr, "\n");
  return all;
}

std::string csv_of(const std::vector<Measured>& all) {
  std::string csv = "participants,demonstrations,icc,test,false_positive_rate\n";
  for (const Measured& one : all) {
    for (size_t test = 0; test < one.rates.size(); ++test) {
      csv += fmt::format("{},{},{},\"{}\",{}\n", one.condition.participants,
                         one.condition.demonstrations, one.condition.icc, pooled_test_names[test],
                         one.rates[test]);
    }
  }
  return csv;
}

std::string chart_of(const std::vector<Measured>& all, const Settings& settings) {
  constexpr const char* colours[] = {"#D55E00", "#E69F00", "#56B4E9",
                                     "#0072B2", "#009E73", "#CC79A7"};
  constexpr int points[] = {7, 5, 9, 11, 13, 15};
  constexpr double sizes[] = {1.2, 0.6, 0.7,
                              0.7, 0.8, 0.7};  // tests that agree stay visible under each other
  const double band = 3.0 * std::sqrt(settings.alpha * (1.0 - settings.alpha) / settings.studies);
  // A logarithmic axis keeps the tests that hold their size apart and the naive ones in the
  // picture.
  std::string body = fmt::format(
      "set multiplot layout 1,2 margins 0.10,0.98,0.15,0.80 spacing 0.07\nset xrange [-0.01:0.51]\n"
      "set logscale y\nset yrange [0.02:0.5]\nset ytics (0.02, 0.03, 0.04, 0.05, 0.07, 0.1, 0.2, "
      "0.3, 0.4)\n"
      "set xlabel 'correlation of one participant''s answers (ICC)'\nset grid ytics lc rgb "
      "'#e0e0e0' lt 1\n"
      "set border 3\nset tics nomirror scale 0.5\nset xtics 0,0.1,0.5\n"
      "set object 1 rectangle from graph 0, first {} to graph 1, first {} fc rgb '#dddddd' fs "
      "solid noborder behind\n",
      settings.alpha - band, settings.alpha + band);
  for (size_t panel = 0; panel < participants_of_panel.size(); ++panel) {
    std::string plot = "plot ";
    for (size_t test = 0; test < pooled_test_names.size(); ++test) {
      body += fmt::format("$p{}t{} << EOD\n", panel, test);
      for (const Measured& one : all) {
        if (one.condition.participants != participants_of_panel[panel]) continue;
        body += fmt::format("{} {}\n", one.condition.icc, one.rates[test]);
      }
      body += "EOD\n";
      plot +=
          fmt::format("{}$p{}t{} using 1:2 with linespoints lw 2 ps {} pt {} lc rgb '{}' title {}",
                      test == 0 ? "" : ", \\\n  ", panel, test, sizes[test], points[test],
                      colours[test], gnuplot_quote(pooled_test_names[test]));
    }
    body += fmt::format(
        "set title '{} participants' offset 0,-0.5\nset ylabel '{}'\n{}\n{}\n",
        participants_of_panel[panel], panel == 0 ? "false-positive rate" : "",
        panel == 0 ? "set key at screen 0.5, 0.99 center top maxrows 2 width 1" : "unset key",
        plot);
  }
  return gnuplot_script("pooled-test-size", 960, 480, body + "unset multiplot\n");
}

std::string page_of(const std::vector<Measured>& all, const Settings& settings) {
  std::string page = fmt::format(
      "# False-positive rates of the pooled tests\n\n"
      "Written by `pinchlab_size_study --out analysis/results --studies {} --resamples {} --alpha "
      "{} --seed {}`.\n\n"
      "Each rate is the share of {} simulated studies without any true preference in which the "
      "test claims one. Eight "
      "answers a participant, whose own preference is drawn from a symmetric beta distribution, so "
      "that answers of one "
      "participant have the intraclass correlation (ICC) given. A test that holds its size stays "
      "at {} (grey band: "
      "three standard errors of the simulation).\n\n"
      "![False-positive rates of the pooled tests over the intraclass "
      "correlation](pooled-test-size.svg)\n",
      settings.studies, settings.resamples, settings.alpha, settings.seed, settings.studies,
      settings.alpha);
  for (int participants : participants_of_panel) {
    page += fmt::format("\n## {} participants\n\n| ICC |", participants);
    for (const char* name : pooled_test_names) page += fmt::format(" {} |", name);
    page += "\n|--:|";
    for (size_t i = 0; i < pooled_test_names.size(); ++i) page += "--:|";
    page += "\n";
    for (const Measured& one : all) {
      if (one.condition.participants != participants) continue;
      page += fmt::format("| {} |", one.condition.icc);
      for (double rate : one.rates) page += fmt::format(" {:.4f} |", rate);
      page += "\n";
    }
  }
  return page;
}

void run(const Settings& settings) {
  const std::vector<Measured> all = measure(settings);
  StagingFolder staging(settings.out);
  staging.write("pooled-test-size.gp", chart_of(all, settings));
  run_gnuplot(staging.path(), "pooled-test-size.gp");
  staging.add("pooled-test-size.svg");
  staging.add("pooled-test-size.pdf");
  staging.write("pooled-test-size.csv", csv_of(all));
  staging.write("pooled-test-size.md", page_of(all, settings));
  staging.keep();
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  return result_main(
      argc, argv, "pinchlab_size_study",
      "Simulates studies without a true preference and charts how often each pooled test claims "
      "one",
      settings,
      [&](CLI::App& app) {
        app.add_option("--studies", settings.studies, "Simulated studies a condition")
            ->capture_default_str()
            ->check(whole_in(100, 1000000));
        app.add_option("--resamples", settings.resamples, "Bootstrap resamples a study")
            ->capture_default_str()
            ->check(whole_in(99, 100000));
        app.add_option("--alpha", settings.alpha, "Level at which each test rejects")
            ->capture_default_str()
            ->check(number_in(0.001, 0.5));
      },
      [&] { run(settings); });
}
