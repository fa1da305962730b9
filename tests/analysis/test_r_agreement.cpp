// SPDX-License-Identifier: GPL-3.0-or-later
// The same figures from R, where it is installed.
#include <gsl/gsl_rng.h>

#include <cmath>
#include <cstdio>
#include <sstream>

#include "analysis/besides.h"
#include "analysis/clustered.h"
#include "analysis/gsl_support.h"
#include "analysis/scale_report.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

namespace fs = std::filesystem;

// Runs an R script and returns the numbers that it prints.
std::vector<double> run_r(const test::TemporaryFolder& folder, const std::string& script) {
  const fs::path file = folder.write("script.R", script);
  const fs::path out = folder.path() / "out.txt";
  const std::string command =
      fmt::format("Rscript --vanilla '{}' > '{}' 2> /dev/null", file.string(), out.string());
  if (std::system(command.c_str()) != 0) return {};
  std::istringstream text(test::read_text(out));
  std::vector<double> numbers;
  for (double value = 0.0; text >> value;) numbers.push_back(value);
  return numbers;
}

bool has_r() {
  return std::system("Rscript --version > /dev/null 2>&1") == 0;
}

TEST(AgreementWithR, TestsAndIntervals) {
  if (!has_r()) GTEST_SKIP() << "Rscript is not installed (Debian: r-base-core)";
  const std::vector<Counts> rows{{15, 1}, {6, 10}, {0, 9}, {203, 180}, {51234, 50000}, {1, 0}};
  std::string script = "options(digits = 17)\nout <- c()\n";
  for (const Counts& c : rows) {
    script += fmt::format(
        "b <- binom.test({0}, {1})\n"
        "out <- c(out, suppressWarnings(chisq.test(c({0}, {2}))$p.value), b$p.value, b$conf.int,\n"
        "  suppressWarnings(prop.test({0}, {1}, correct = FALSE)$conf.int))\n",
        c.pinch, c.total(), c.cable);
  }
  script +=
      "p <- c(.01, .04, .03, .005, .8, .04)\nout <- c(out, p.adjust(p, 'holm'), p.adjust(p, "
      "'BH'))\n"
      "write(formatC(out, digits = 17, format = 'g'), stdout(), ncolumns = 1)\n";
  const test::TemporaryFolder folder;
  const std::vector<double> r = run_r(folder, script);
  std::vector<double> ours;
  for (const Counts& c : rows) {
    const Row row = make_row("x", c, 0.05);
    ours.insert(ours.end(), {row.p_chi_square, row.p_exact, row.clopper_pearson.low,
                             row.clopper_pearson.high, row.wilson.low, row.wilson.high});
  }
  const std::vector<double> p{.01, .04, .03, .005, .8, .04};
  for (double value : holm(p)) ours.push_back(value);
  for (double value : benjamini_hochberg(p)) ours.push_back(value);
  ASSERT_EQ(r.size(), ours.size());
  for (size_t i = 0; i < r.size(); ++i)
    EXPECT_NEAR(ours[i], r[i], 1e-9 * std::abs(r[i]) + 1e-12) << i;
}

// The second column on of what analysis/reproduce.R makes of answers, row by row.
std::vector<double> reproduced(const fs::path& csv, const test::TemporaryFolder& folder) {
  const fs::path out = folder.path() / "tables.csv";
  const std::string command =
      fmt::format("Rscript --vanilla '{}/analysis/reproduce.R' '{}' > '{}' 2> /dev/null",
                  PINCHLAB_SOURCE_DIR, csv.string(), out.string());
  if (std::system(command.c_str()) != 0) return {};
  std::istringstream lines(test::read_text(out));
  std::string line;
  std::getline(lines, line);
  std::vector<double> numbers;
  while (std::getline(lines, line)) {
    std::istringstream cells(line.substr(line.find(',') + 1));
    for (std::string cell; std::getline(cells, cell, ',');) numbers.push_back(std::stod(cell));
  }
  return numbers;
}

TEST(AgreementWithR, TheScriptReproducesTheTables) {
  if (!has_r()) GTEST_SKIP() << "Rscript is not installed (Debian: r-base-core)";
  const test::TemporaryFolder folder;
  const Rng rng = make_rng(RandomUse::study, 12);
  std::string two = "participant,demonstration,choice\n";
  std::string many = "participant,demonstration,left,right,choice\n";
  for (int p = 0; p < 20; ++p) {
    for (int j = 1; j <= 3; ++j) {
      two += fmt::format("p{},{},{}\n", p, j,
                         gsl_rng_uniform(rng.get()) < 0.2 + 0.2 * j ? "pinch" : "cable");
      for (const char* pair : {"ab", "bc", "ca"}) {
        const double share = pair[0] == 'c' ? 0.3 : 0.65;
        many += fmt::format("p{},{},{},{},{}\n", p, j, pair[0], pair[1],
                            pair[gsl_rng_uniform(rng.get()) < share ? 0 : 1]);
      }
    }
  }
  const fs::path answers = folder.write("two.csv", two);
  std::vector<double> ours;
  const AnswersTable table = read_answers({answers}, {});
  for (const DemonstrationResult& result : analyse_table(table, {}).demonstrations) {
    const Row& row = result.row;
    ours.insert(ours.end(),
                {static_cast<double>(row.counts.pinch), static_cast<double>(row.counts.cable),
                 row.share, row.p_exact, row.wilson.low, row.wilson.high});
  }
  const auto expect_equal = [&](const std::vector<double>& r) {
    ASSERT_EQ(r.size(), ours.size());
    for (size_t i = 0; i < r.size(); ++i)
      EXPECT_NEAR(ours[i], r[i], 1e-6 * std::abs(r[i]) + 1e-9) << i;
  };
  expect_equal(reproduced(answers, folder));
  const fs::path comparisons = folder.write("many.csv", many);
  const ComparisonsTable methods = read_comparisons({comparisons}, {});
  ours.clear();
  for (const ScaleValueOf& value : analyse_scale(methods, {}).all.values)
    ours.insert(ours.end(), {value.value.value, value.low.value, value.high.value});
  expect_equal(reproduced(comparisons, folder));
}

TEST(AgreementWithR, MixedModelOfLme4) {
  if (!has_r()) GTEST_SKIP() << "Rscript is not installed (Debian: r-base-core)";
  const test::TemporaryFolder folder;
  if (run_r(folder, "library(lme4)\ncat(1)\n").empty())
    GTEST_SKIP() << "lme4 is not installed (Debian: r-cran-lme4)";
  const Rng rng = make_rng(RandomUse::study, 77);
  std::string csv = "participant,demonstration,choice\n";
  for (int p = 0; p < 40; ++p) {
    const double lean = 0.25 + 0.6 * gsl_rng_uniform(rng.get());
    for (int j = 1; j <= 8; ++j) {
      const double share = std::min(1.0, lean * (0.7 + 0.06 * j));
      csv += fmt::format("p{:02},{},{}\n", p, j,
                         gsl_rng_uniform(rng.get()) < share ? "pinch" : "cable");
    }
  }
  const fs::path file = folder.write("data.csv", csv);
  const std::vector<double> r = run_r(
      folder,
      fmt::format(
          "suppressMessages(library(lme4))\nd <- read.csv('{}'); d$y <- as.integer(d$choice == "
          "'pinch')\n"
          "m <- glmer(y ~ 1 + (1 | participant) + (1 | demonstration), d, family = binomial)\n"
          "cat(fixef(m), attr(VarCorr(m)$participant, 'stddev'), attr(VarCorr(m)$demonstration, "
          "'stddev'),\n"
          "  -2 * as.numeric(logLik(m)))\n",
          file.string()));
  ASSERT_EQ(r.size(), 4U);
  const AnswersTable table = read_answers({file}, {});
  const MixedModel model = fit_mixed_model(mixed_data(table, table.groups.back()), 0.05);
  EXPECT_NEAR(model.intercept.value, r[0], 2e-3);
  EXPECT_NEAR(model.sd_participant.value, r[1], 2e-3);
  EXPECT_NEAR(model.sd_demonstration.value, r[2], 2e-3);
  EXPECT_NEAR(model.deviance.value, r[3], 1e-3);
}

// The type 2 area of a participant is Mann and Whitney's statistic over the number of pairs.
TEST(AgreementWithR, ConfidenceInHits) {
  if (!has_r()) GTEST_SKIP() << "Rscript is not installed (Debian: r-base-core)";
  const Rng rng = make_rng(RandomUse::bootstrap, 11);
  std::vector<BesidesAnswer> answers;
  std::string csv = "who,hit,confidence\n";
  for (int who = 0; who < 25; ++who) {
    for (int trial = 0; trial < 30; ++trial) {
      BesidesAnswer& answer = answers.emplace_back();
      answer.participant = fmt::format("p{}", who);
      answer.demonstration = "squeeze";
      answer.level = 1;
      answer.is_hit = gsl_rng_uniform(rng.get()) < 0.7;
      answer.first = answer.chosen = *answer.is_hit ? "reference" : "graded";
      answer.confidence = 1 + static_cast<int>(gsl_rng_uniform_int(rng.get(), 5)) +
                          (*answer.is_hit && trial % 3 == 0 ? 1 : 0);
      csv +=
          fmt::format("{},{},{}\n", answer.participant, *answer.is_hit ? 1 : 0, *answer.confidence);
    }
  }
  const test::TemporaryFolder folder;
  const fs::path data = folder.write("data.csv", csv);
  const std::vector<double> r =
      run_r(folder, fmt::format("d <- read.csv('{}')\n"
                                "area <- sapply(split(d, d$who), function(p) {{\n"
                                "  a <- p$confidence[p$hit == 1]; b <- p$confidence[p$hit == 0]\n"
                                "  suppressWarnings(wilcox.test(a, b)$statistic) / length(a) / "
                                "length(b)\n"
                                "}})\n"
                                "write(formatC(c(mean(area), t.test(area)$conf.int), digits = 17, "
                                "format = 'g'), stdout(), ncolumns = 1)\n",
                                data.string()));
  const Confidence ours = *analyse_besides(answers, 0.05, 1).confidence;
  ASSERT_EQ(r.size(), 3U);
  EXPECT_NEAR(ours.area.value, r[0], 1e-12);
  EXPECT_NEAR(ours.area_low.value, r[1], 1e-12);
  EXPECT_NEAR(ours.area_high.value, r[2], 1e-12);
  EXPECT_GT(r[1], 0.5);
}

}  // namespace
}  // namespace pinchlab::analysis
