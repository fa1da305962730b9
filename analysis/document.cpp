// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace pinchlab::analysis {

namespace {

std::string percent_interval(double low, double high) {
  return fmt::format("{:.1f} to {:.1f}", 100.0 * low, 100.0 * high);
}
std::string percent_interval(const Estimate& low, const Estimate& high) {
  return low && high ? percent_interval(low.value, high.value) : dash;
}
std::string bayes_factor(double log_value) {
  const double value = std::exp(log_value);
  return value >= 1e4 || value < 1e-3 ? fmt::format("10^{:.1f}", log_value / std::log(10.0))
                                      : fmt::format("{:.3g}", value);
}

using Cells = std::vector<TextCell>;

class Writer {
 public:
  Writer(const Report& report, const AnswersTable& table) : report_(report), table_(table) {}

  Document write() {
    document_.title = fmt::format("Forced choice between {} and {}", pinch(), cable());
    add(Paragraph{plain_words(report_, table_)});
    demonstrations();
    groups();
    pooled();
    differences();
    document_.add(effect_blocks(report_));
    document_.add(graded_blocks(report_));
    document_.add(besides_blocks(report_.besides, alpha()));
    document_.add(input_blocks(report_, table_));
    return std::move(document_);
  }

 private:
  void add(Block block) { document_.blocks.push_back(std::move(block)); }
  [[nodiscard]] const std::string& pinch() const { return report_.options.pinch_label; }
  [[nodiscard]] const std::string& cable() const { return report_.options.cable_label; }
  [[nodiscard]] double alpha() const { return report_.options.alpha; }
  [[nodiscard]] std::string level() const { return confidence_level(alpha()); }
  [[nodiscard]] TextCell p_cell(const Estimate& p) const { return analysis::p_cell(p, alpha()); }

  // The layout of the thesis' Tables 5.3 and 5.4: one column a test, at most ten side by side.
  void thesis_table(const std::string& caption, const std::vector<const Row*>& rows, int decimals) {
    constexpr size_t most = 10;
    for (size_t begin = 0; begin < rows.size(); begin += most) {
      const size_t end = std::min(rows.size(), begin + most);
      TableBlock block;
      block.caption = begin == 0 ? caption : caption + " (continued)";
      block.header = {""};
      Cells first{{pinch()}}, second{{cable()}}, expected{{"Expected distribution"}};
      // Where answers are not independent the chi-square test has no p-value to give.
      const bool naive = rows[begin]->why_not_independent.empty();
      Cells p{{naive ? "Distribution probability (p-value)"
                     : fmt::format("p-value ({})", first_tested(rows).read.test)}};
      for (size_t i = begin; i < end; ++i) {
        const Row& row = *rows[i];
        block.header.push_back(row.name);
        first.push_back({fmt::format("{}", row.counts.pinch)});
        second.push_back({fmt::format("{}", row.counts.cable)});
        expected.push_back({fmt::format("{}", static_cast<double>(row.counts.total()) / 2.0)});
        const Estimate value = naive ? Estimate(row.p_chi_square) : row.read.p;
        p.push_back(
            {value ? p_rounded(value.value, decimals) : dash, value && value.value < alpha()});
      }
      block.rows = {first, second, expected, p};
      add(std::move(block));
    }
  }

  void detail_table(const std::string& caption, const std::vector<const Row*>& rows,
                    const std::vector<const ScaleValue*>& scales) {
    TableBlock block;
    block.caption = caption;
    block.header = {"",
                    pinch(),
                    cable(),
                    "share %",
                    "X²",
                    "p",
                    "p (exact)",
                    "Wilson %",
                    "Clopper–Pearson %",
                    "Cohen's h",
                    "p (exact, Holm)",
                    "p (exact, BH)",
                    "Bayes factor",
                    "JOD"};
    std::vector<double> exact;
    exact.reserve(rows.size());
    for (const Row* row : rows) exact.push_back(row->p_exact);
    const std::vector<double> by_holm = holm(exact);
    const std::vector<double> by_bh = benjamini_hochberg(exact);
    for (size_t i = 0; i < rows.size(); ++i) {
      const Row& row = *rows[i];
      block.rows.push_back({{row.name},
                            {fmt::format("{}", row.counts.pinch)},
                            {fmt::format("{}", row.counts.cable)},
                            {fixed(100.0 * row.share, 1)},
                            {fixed(row.chi_square, 3)},
                            p_cell(row.p_chi_square),
                            p_cell(row.p_exact),
                            {percent_interval(row.wilson.low, row.wilson.high)},
                            {percent_interval(row.clopper_pearson.low, row.clopper_pearson.high)},
                            {fixed(row.cohens_h, 3)},
                            p_cell(by_holm[i]),
                            p_cell(by_bh[i]),
                            {bayes_factor(row.log_bayes_factor)},
                            {fixed(scales[i]->jod, 2)}});
    }
    add(std::move(block));
  }

  // What can be said of demonstrations that participants answered more than once.
  void participant_table(const std::vector<const Row*>& rows,
                         const std::vector<const ScaleValue*>& scales) {
    const Reading& first = first_tested(rows).read;
    TableBlock block;
    block.caption = fmt::format(
        "Every demonstration, participants as units: {} and {} interval ({}); p-values below {} "
        "are bold",
        first.test, level(), first.interval, alpha());
    block.header = {"",           pinch(),     cable(),    "share %", "p",
                    "interval %", "Cohen's h", "p (Holm)", "p (BH)",  "JOD"};
    for (size_t i = 0; i < rows.size(); ++i) {
      const Row& row = *rows[i];
      block.rows.push_back({{row.name},
                            {fmt::format("{}", row.counts.pinch)},
                            {fmt::format("{}", row.counts.cable)},
                            {fixed(100.0 * row.share, 1)},
                            p_cell(row.read.p),
                            {percent_interval(row.read.low, row.read.high)},
                            {fixed(row.cohens_h, 3)},
                            p_cell(row.read.p_holm),
                            p_cell(row.read.p_bh),
                            {fixed(scales[i]->jod, 2)}});
    }
    add(std::move(block));
    add(Paragraph{fmt::format(
        "Tests and intervals that count answers as independent (chi-square, exact binomial, "
        "Wilson, Clopper–Pearson, Bayes factor) are not given for single demonstrations: {}.",
        rows.front()->why_not_independent)});
    not_given("A test of one half", rows, &Reading::p);
    not_given("An interval", rows, &Reading::low);
  }

  // Which rows lack an estimate, and why.
  void not_given(const std::string& what, const std::vector<const Row*>& rows,
                 Estimate Reading::*estimate) {
    std::map<std::string, std::vector<std::string>> names;  // by reason
    for (const Row* row : rows) {
      const Estimate& value = row->read.*estimate;
      if (!value) names[value.why_not].push_back(row->name);
    }
    for (const auto& [reason, who] : names) {
      add(Paragraph{
          fmt::format("{} is not given for {}: {}.", what, fmt::join(who, ", "), reason)});
    }
  }

  void demonstrations() {
    add(Heading{"Demonstrations"});
    const std::vector<const Row*> rows = rows_of(report_.demonstrations);
    std::vector<const ScaleValue*> scales;
    for (const DemonstrationResult& result : report_.demonstrations)
      scales.push_back(&result.scale);
    const bool independent = rows.front()->why_not_independent.empty();
    thesis_table(independent ? "2AFC results, chi-square analysis" : "2AFC results", rows, 3);
    add(FigureBlock{"shares"});
    if (!independent) {
      participant_table(rows, scales);
      return;
    }
    detail_table(fmt::format("Every demonstration, with {} intervals; p-values below {} are bold",
                             level(), alpha()),
                 rows, scales);
    const bool small = std::any_of(rows.begin(), rows.end(), [&](const Row* row) {
      return (row->p_chi_square < alpha()) != (row->p_exact < alpha());
    });
    if (small) {
      add(
          Paragraph{"With few answers the chi-square test rejects more often than it should (at 16 "
                    "answers its "
                    "true false-positive rate is 0.077, not 0.05); where it and the exact test "
                    "disagree, go by the "
                    "exact one."});
    }
  }

  void groups() {
    add(Heading{"Groups"});
    std::vector<const Row*> rows;
    std::vector<const ScaleValue*> scales;
    for (const GroupResult& result : report_.groups) {
      rows.push_back(&result.row);
      scales.push_back(&result.scale);
    }
    thesis_table("2AFC results, chi-square analysis (aggregated)", rows, 4);
    add(FigureBlock{"groups"});
    detail_table("Every group, as if all its answers were independent", rows, scales);
    add(Paragraph{fmt::format("Groups come from {}.", table_.groups_from)});
  }

  void pooled() {
    add(Heading{"Pooled tests, naive and corrected"});
    add(Paragraph{
        "Answers of one participant resemble each other, so they are not as many independent "
        "pieces of evidence as there are answers: the naive test counts them as if they were, "
        "the corrected ones take the participant as the unit and so keep their false-positive "
        "rate (Rao–Scott against chi-square with many participants only; below about 50 read "
        "its F version)."});
    TableBlock block;
    block.caption = fmt::format("Pooled tests of one half ({} intervals)", level());
    block.header = {"",
                    "participants",
                    "X² (naive)",
                    "p (naive)",
                    "design effect",
                    "X² (Rao–Scott)",
                    "p (Rao–Scott)",
                    "p (Rao–Scott, F)",
                    "p (sign flip)",
                    "p (sign flip, Holm)",
                    "p (bootstrap)",
                    "share %, bootstrap"};
    for (const GroupResult& result : report_.groups) {
      const Pooled& pooled = result.pooled;
      const Estimate flip_holm =
          pooled.sign_flip.p ? Estimate(result.p_sign_flip_holm) : pooled.sign_flip.p;
      block.rows.push_back(
          {{result.row.name},
           {pooled.participants > 0 ? fmt::format("{}", pooled.participants) : dash},
           {fixed(pooled.chi_square, 3)},
           p_cell(pooled.p_naive),
           {fixed(pooled.rao_scott.design_effect, 3)},
           {fixed(pooled.rao_scott.chi_square, 3)},
           p_cell(pooled.rao_scott.p),
           p_cell(pooled.rao_scott.p_f),
           p_cell(pooled.sign_flip.p),
           p_cell(flip_holm),
           p_cell(pooled.bootstrap.p),
           {percent_interval(pooled.bootstrap.low, pooled.bootstrap.high)}});
    }
    add(std::move(block));
    document_.add(why_missing("Rao–Scott", report_.all().pooled.rao_scott.chi_square));
    document_.add(why_missing("The sign-flip test", report_.all().pooled.sign_flip.p));
    const ClusterBootstrap& bootstrap = report_.all().pooled.bootstrap;
    document_.add(why_missing("The cluster bootstrap", bootstrap.p));
    if (bootstrap.p) document_.add(why_missing("The cluster bootstrap's interval", bootstrap.low));
    mixed_models();
  }

  void mixed_models() {
    TableBlock block;
    block.caption = fmt::format(
        "Mixed logistic model with random intercepts of participant and demonstration "
        "(Laplace, log-odds, {} profile intervals)",
        level());
    block.header = {
        "", "intercept", "interval", "p", "sd participants", "sd demonstrations", "mean share %"};
    for (const GroupResult& result : report_.groups) {
      const MixedModel& model = result.mixed_model;
      if (!model.intercept) {
        add(Paragraph{fmt::format("The mixed model of {} is not estimable: {}.", result.row.name,
                                  model.intercept.why_not)});
        continue;
      }
      const auto sd = [](const Estimate& value) {
        return value && value.value == 0.0 ? "0 (boundary)" : fixed(value, 3);
      };
      block.rows.push_back(
          {{result.row.name},
           {fixed(model.intercept, 3)},
           {fmt::format("{} to {}", fixed(model.intercept_low, 3), fixed(model.intercept_high, 3))},
           p_cell(model.p),
           {sd(model.sd_participant)},
           {sd(model.sd_demonstration)},
           {model.mean_share ? fixed(100.0 * model.mean_share.value, 1) : dash}});
    }
    if (!block.rows.empty()) add(std::move(block));
  }

  void differences() {
    add(Heading{"Do the demonstrations differ?"});
    TableBlock block;
    block.caption = "Differences between the demonstrations of a group";
    block.header = {
        "", "X² (heterogeneity)", "df", "p", "participants who chose in all", "Cochran's Q", "df",
        "p"};
    for (const GroupResult& result : report_.groups) {
      block.rows.push_back({{result.row.name},
                            {fixed(result.heterogeneity.chi_square, 3)},
                            {fixed(result.heterogeneity.df, 0)},
                            p_cell(result.heterogeneity.p),
                            {result.pooled.participants > 0 && result.demonstrations.size() > 1
                                 ? fmt::format("{}", result.cochran_q.participants)
                                 : dash},
                            {fixed(result.cochran_q.q, 3)},
                            {fixed(result.cochran_q.df, 0)},
                            p_cell(result.cochran_q.p)});
    }
    add(std::move(block));
    const Difference all = difference_read(report_.all());
    if (all.p && all.p.value < alpha()) {
      add(
          Paragraph{"The demonstrations differ, so what holds for “all” need not hold for any "
                    "single one; read the "
                    "groups and the demonstrations first."});
    }
    document_.add(
        why_missing("X² over all demonstrations", report_.all().heterogeneity.chi_square));
    document_.add(why_missing("Cochran's Q over all demonstrations", report_.all().cochran_q.q));
  }

  const Report& report_;
  const AnswersTable& table_;
  Document document_;
};

}  // namespace

std::vector<Block> why_missing(const std::string& what, const Estimate& estimate) {
  if (estimate) return {};
  return {Paragraph{fmt::format("{} is not given: {}.", what, estimate.why_not)}};
}

Document make_document(const Report& report, const AnswersTable& table) {
  return Writer(report, table).write();
}

}  // namespace pinchlab::analysis
