// SPDX-License-Identifier: GPL-3.0-or-later
// The first paragraph of every report: the answer, in words that need no statistics.
#include <fmt/format.h>

#include <cmath>

#include "analysis/design_check.h"
#include "analysis/document.h"
#include "base/counted.h"

namespace pinchlab::analysis {

namespace {

std::string out_of(const Counts& counts) {
  return fmt::format("{} of {}", counts.pinch, counts.total());
}

// "a", "a and b", "a, b and c"; long lists are cut.
std::string list_of(const std::vector<std::string>& items) {
  constexpr size_t most = 12;
  std::string text;
  const size_t shown = items.size() > most ? most : items.size();
  for (size_t i = 0; i < shown; ++i) {
    const bool last = i + 1 == items.size();
    text += i == 0 ? "" : last ? " and " : ", ";
    text += items[i];
  }
  if (items.size() > most) text += fmt::format(" and {} more", items.size() - most);
  return text;
}

std::string p_in_words(const Estimate& estimate) {
  if (!estimate) return "no p-value: " + estimate.why_not;
  const double p = estimate.value;
  return p < 0.0001 ? "p < 0.0001" : p > 0.99995 ? "p = 1" : fmt::format("p = {:.4f}", p);
}

// A sentence may begin with the name of a method.
std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z')
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

// Whether a preference is claimed: in a design that may stop early, by the bound of its look.
bool is_found(const Row& all, double alpha, const std::optional<DesignCheck>& design) {
  if (design && design->bayes_factor)
    return all.log_bayes_factor >= std::log(*design->bayes_factor);
  if (!all.read.p) return false;
  if (design && design->p_at_most) return all.read.p.value <= *design->p_at_most;
  return all.read.p.value < alpha;
}

std::string bound_in_words(const Row& all, const std::optional<DesignCheck>& design) {
  if (design && design->bayes_factor) {
    return fmt::format(
        "; Bayes factor {:.3g}, and the design asks for {:g} or more; p and interval are as for a "
        "single look",
        std::exp(all.log_bayes_factor), *design->bayes_factor);
  }
  if (design && design->p_at_most) {
    return fmt::format(
        "; p at most {:.3g} is what the design asks for at its look at {}, p and interval are as "
        "for a single one",
        *design->p_at_most, counted(design->look, "participant"));
  }
  return "";
}

std::string verdict(const Report& report, const AnswersTable& table) {
  const std::optional<DesignCheck>& design = table.design;
  const GroupResult& all = report.all();
  const Reading& read = all.row.read;
  const std::string& pinch = report.options.pinch_label;
  const std::string& cable = report.options.cable_label;
  const std::string found =
      !is_found(all.row, report.options.alpha, design)
          ? fmt::format("No clear preference between {} and {}", pinch, cable)
          : fmt::format("{} was preferred to {}", all.row.share > 0.5 ? pinch : cable,
                        all.row.share > 0.5 ? cable : pinch);
  const bool one = report.demonstrations.size() == 1;
  const std::string where =
      one ? fmt::format(" in demonstration {}", report.demonstrations[0].row.name)
          : fmt::format(" over the {} demonstrations", report.demonstrations.size());
  const bool are_people = one && table.answers_per_demonstration == 1;
  return fmt::format("{}: {} {} {}{} ({}; {}{}{}).", found, out_of(all.row.counts),
                     are_people ? "preferred" : "answers chose", pinch, where,
                     percent(all.row.share), p_in_words(read.p), read.p ? ", " + read.test : "",
                     bound_in_words(all.row, design));
}

std::string demonstrations_in_words(const Report& report) {
  const std::vector<const Row*> rows = rows_of(report.demonstrations);
  const Reading& first = first_tested(rows).read;
  if (!first.p) {
    return fmt::format(" The demonstrations cannot be tested one by one: {}.", first.p.why_not);
  }
  std::vector<std::string> for_pinch, for_cable, unclear, robust, untested;
  for (const Row* shown : rows) {
    const Row& row = *shown;
    const std::string item = fmt::format("{} ({})", row.name, out_of(row.counts));
    if (!row.read.p) {
      untested.push_back(item);
    } else if (row.read.p.value >= report.options.alpha) {
      unclear.push_back(item);
    } else {
      (row.share > 0.5 ? for_pinch : for_cable).push_back(item);
      if (row.read.p_holm.value < report.options.alpha) robust.push_back(row.name);
    }
  }
  const std::string& pinch = report.options.pinch_label;
  std::string text = fmt::format(" Taken one by one ({}, p < {}), {} was preferred in {} of ",
                                 first.test, report.options.alpha, pinch,
                                 for_pinch.empty() ? "none" : fmt::format("{}", for_pinch.size()));
  text += for_pinch.empty() ? fmt::format("the {} demonstrations.", report.demonstrations.size())
                            : fmt::format("{} demonstrations: {}.", report.demonstrations.size(),
                                          list_of(for_pinch));
  if (!for_cable.empty()) {
    text += fmt::format(" {} was preferred in {}.", capitalised(report.options.cable_label),
                        list_of(for_cable));
  }
  if (!unclear.empty()) text += fmt::format(" No clear preference shows in {}.", list_of(unclear));
  if (!untested.empty()) {
    text += fmt::format(" Not tested, for want of a second participant: {}.", list_of(untested));
  }
  if (for_pinch.size() + for_cable.size() > 0) {
    text += robust.empty()
                ? " None of these holds once Holm's correction allows for testing so many."
                : fmt::format(" Once Holm's correction allows for testing so many, {} remain{}.",
                              list_of(robust), robust.size() == 1 ? "s" : "");
  }
  return text;
}

std::string groups_in_words(const Report& report) {
  std::vector<std::string> items;
  for (size_t i = 0; i + 1 < report.groups.size(); ++i) {
    const GroupResult& group = report.groups[i];
    items.push_back(fmt::format("{} {} answers ({}, {})", out_of(group.row.counts), group.row.name,
                                percent(group.row.share), p_in_words(group.row.read.p)));
  }
  return items.empty() ? ""
                       : fmt::format(" By group, {} was chosen in {}.", report.options.pinch_label,
                                     list_of(items));
}

}  // namespace

std::string plain_words(const Report& report, const AnswersTable& table) {
  std::string text = (table.is_pilot ? "Answers of a pilot. " : "") + verdict(report, table);
  if (report.demonstrations.size() > 1) {
    text += demonstrations_in_words(report);
    text += groups_in_words(report);
  }
  const Difference difference = difference_read(report.all());
  if (difference.p && difference.p.value < report.options.alpha) {
    const int everybody = report.all().pooled.participants;
    const std::string of_whom =
        difference.participants > 0 && difference.participants < everybody
            ? fmt::format(" over the {} of {} participants who chose in all of them",
                          difference.participants, everybody)
            : "";
    text += fmt::format(
        " The demonstrations differ from one another ({} = {:.2f}{}, df {}, {}), so the figure "
        "over all of them is an average of unlike cases.",
        difference.name, difference.statistic.value, of_whom, difference.df.value,
        p_in_words(difference.p));
  }
  if (!report.graded.empty() && report.graded.back().ties > 0) {
    std::vector<std::string> only_ties;
    for (const GradedPreference& row : report.graded) {
      if (row.ties == row.answers) only_ties.push_back(row.name);
    }
    text += fmt::format(" {} of {} answers {} in no count here{}.", report.graded.back().ties,
                        report.graded.back().answers,
                        report.graded.back().ties == 1 ? "was a tie, and is" : "were ties, and are",
                        only_ties.empty() ? "" : ": all of those to " + list_of(only_ties));
  }
  if (!table.exclusions.empty()) {
    text += fmt::format(" {} participant{} left out (listed below with the reasons).",
                        table.exclusions.size(), table.exclusions.size() == 1 ? " was" : "s were");
  }
  return capitalised(std::move(text)) + design_words(table.design);
}

}  // namespace pinchlab::analysis
