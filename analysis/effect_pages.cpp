// SPDX-License-Identifier: GPL-3.0-or-later
// What could have shaped the answers beside the clips, in the report.
#include <fmt/format.h>

#include "analysis/document.h"
#include "base/counted.h"

namespace pinchlab::analysis {
namespace {

std::vector<Block> reaction_blocks(const Report& report) {
  const Estimate& median = report.reaction_times.front().median_s;
  if (!median) return why_missing("A table of reaction times", median);
  TableBlock block;
  block.caption = "Reaction times in seconds, from the moment the buttons appear";
  block.header = {"",         "answers", "median", "lower quartile", "upper quartile",
                  "shortest", "longest"};
  for (const ReactionTimes& row : report.reaction_times) {
    block.rows.push_back({{row.name},
                          {fmt::format("{}", row.answers)},
                          {fixed(row.median_s, 2)},
                          {fixed(row.lower_quartile_s, 2)},
                          {fixed(row.upper_quartile_s, 2)},
                          {fixed(row.shortest_s, 2)},
                          {fixed(row.longest_s, 2)}});
  }
  return {std::move(block)};
}

}  // namespace

std::vector<Block> effect_blocks(const Report& report) {
  Document part;
  const std::string& pinch = report.options.pinch_label;
  part.add(Heading{"Side, order, time and attention"});
  const SideBias& side = report.side_bias;
  if (side.chosen.total() > 0) {
    part.add(Paragraph{fmt::format(
        "The left clip was chosen {} and the right one {}. The clip of {} was chosen "
        "in {} of {} answers when it was on the left and in {} of {} when it was on the right.",
        counted(side.chosen.pinch, "time"), counted(side.chosen.cable, "time"), pinch,
        side.shown_left.pinch, side.shown_left.total(), side.shown_right.pinch,
        side.shown_right.total())});
  }
  if (side.p) {
    part.add(Paragraph{fmt::format(
        "With demonstrations as strata and {} on either side equally often, the left clip "
        "would be chosen in {} % of the answers (Mantel–Haenszel X² = {}, {}; by sign flips "
        "over participants {}).",
        pinch, fixed(50.0 + 100.0 * side.bias.value, 1), fixed(side.chi_square, 3),
        p_equation(side.p), p_equation(side.p_sign_flip))});
  }
  if (side.chosen.total() > 0 && side.unknown > 0) {
    part.add(Paragraph{fmt::format("Of {} the side is not known; they are in no figure of sides.",
                                   counted(side.unknown, "answer"))});
  }
  part.add(why_missing("A side bias", side.p));
  const OrderEffect& order = report.order_effect;
  if (order.p_trend) {
    part.add(Paragraph{fmt::format(
        "From one place of the session to the next the share of answers for {} changes by {:+.1f} "
        "percentage points (line of least squares; Cochran–Armitage X² = {}, {}; by sign flips "
        "over "
        "participants {}).",
        pinch, 100.0 * order.share_by_place.value, fixed(order.chi_square, 3),
        p_equation(order.p_trend), p_equation(order.p_sign_flip))});
  }
  std::int64_t placed = 0;
  for (const Counts& counts : order.by_position) placed += counts.total();
  const std::int64_t unplaced = report.all().row.counts.total() - placed;
  if (placed > 0 && unplaced > 0) {
    part.add(Paragraph{
        fmt::format("Of {} the place in the session is not known; they are in no figure of order.",
                    counted(unplaced, "answer"))});
  }
  part.add(why_missing("An order effect", order.p_trend));
  if (side.chosen.total() > 0 || !order.by_position.empty()) part.add(FigureBlock{"effects"});
  part.add(reaction_blocks(report));
  part.add(circumstance_blocks(report.circumstances));
  return std::move(part.blocks);
}

}  // namespace pinchlab::analysis
