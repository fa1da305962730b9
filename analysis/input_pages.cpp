// SPDX-License-Identifier: GPL-3.0-or-later
// What went into the report, what participants wrote, and how it was computed.
#include <fmt/format.h>

#include <algorithm>

#include "analysis/document.h"
#include "base/counted.h"

namespace pinchlab::analysis {
namespace {

std::vector<Block> went_in(const Report& report, const AnswersTable& table) {
  Document part;
  part.add(Heading{"What went in"});
  const Input& input = report.input;
  const std::string answers = counted(input.answers, "answer");
  const std::string demonstrations = counted(input.demonstrations, "demonstration");
  std::string text =
      table.participants.empty()
          ? fmt::format("A table of counts with {} to {}; who gave which is not known.", answers,
                        demonstrations)
          : fmt::format("{} of {}{} to {}, read from {}.", answers,
                        counted(input.participants, "participant"),
                        input.ties > 0 ? ", " + ties_among(input.ties) + "," : "", demonstrations,
                        counted(table.sources.size(), "file"));
  if (!table.incomplete.empty()) {
    const size_t shown = std::min<size_t>(table.incomplete.size(), 20);
    const std::vector<std::string> names(
        table.incomplete.begin(), table.incomplete.begin() + static_cast<std::ptrdiff_t>(shown));
    text += fmt::format(" Answers are missing from {}: {}{}.",
                        counted(table.incomplete.size(), "participant"), fmt::join(names, ", "),
                        shown < table.incomplete.size() ? ", ..." : "");
  }
  part.add(Paragraph{text});
  if (table.exclusions.empty()) return std::move(part.blocks);
  TableBlock block;
  block.caption = "Participants left out of everything above";
  block.header = {"participant", "reason"};
  for (const Exclusion& exclusion : table.exclusions) {
    block.rows.push_back({{exclusion.participant}, {exclusion.reason}});
  }
  part.add(std::move(block));
  return std::move(part.blocks);
}

std::vector<Block> free_text_blocks(const AnswersTable& table) {
  Document part;
  TableBlock block;
  block.caption = "What participants wrote";
  block.header = {"participant", "question", "text"};
  for (const auto& [participant, session] : table.sessions) {
    for (const auto& [question, text] : session.free_text) {
      const bool blank = text.find_first_not_of(" \t\r\n") == std::string::npos;
      if (!blank) block.rows.push_back({{table.participants[participant]}, {question}, {text}});
    }
  }
  if (block.rows.empty()) return std::move(part.blocks);
  part.add(Heading{"Free texts"});
  part.add(std::move(block));
  return std::move(part.blocks);
}

std::vector<Block> methods_blocks(const Report& report) {
  Document part;
  part.add(Heading{"Methods"});
  const SignFlip& flip = report.all().pooled.sign_flip;
  part.add(Paragraph{
      fmt::format("Chi-square tests against one half, df 1, without continuity correction; exact "
                  "binomial tests two-sided; "
                  "Holm and Benjamini–Hochberg over the demonstrations, and over the groups, of "
                  "those with the same members one; the "
                  "Bayes factor compares a share "
                  "with the prior Beta(1, 1) (uniform) to a share of 1/2; Rao–Scott first-order "
                  "correction with participants as "
                  "clusters, against chi-square (df 1) and against F(1, participants − 1); "
                  "sign-flip tests {}; studentised "
                  "cluster bootstrap with {} resamples; 1 JOD is the difference at which 3 of 4 "
                  "people choose the better clip. "
                  "alpha = {}, seed = {}, Pinchlab {}.",
                  flip.exact ? "exact" : "by 99999 random flips", report.options.bootstrap,
                  report.options.alpha, report.options.seed, PINCHLAB_VERSION)});
  return std::move(part.blocks);
}

}  // namespace

std::vector<Block> input_blocks(const Report& report, const AnswersTable& table) {
  Document part;
  part.add(went_in(report, table));
  part.add(free_text_blocks(table));
  part.add(methods_blocks(report));
  return std::move(part.blocks);
}

}  // namespace pinchlab::analysis
