// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "analysis/experiments/stability/border.h"
#include "analysis/experiments/stability/stability.h"

namespace pinchlab::experiments::stability {

namespace {

std::string title_of(const std::string& method) {
  if (method == "pinch") return "ours";
  if (method == "cable") return "plain cable";
  return method;
}

/// Results of one method, and of one series unless that is empty. A map's border is in x times y.
std::vector<Result> select(const ItemResults& done, const std::string& method,
                           const std::string& series) {
  std::vector<Result> found;
  for (Result result : done.results) {
    if (result.method != method || (!series.empty() && result.series != series)) continue;
    if (!done.item.y_name.empty()) result.x *= result.y;
    found.push_back(result);
  }
  return found;
}

std::vector<std::string> series_of(const ItemResults& done) {
  std::vector<std::string> names;
  for (const Result& result : done.results) {
    if (std::find(names.begin(), names.end(), result.series) == names.end())
      names.push_back(result.series);
  }
  return names;
}

/// One border where all series agree, else one a series.
std::string borders(const ItemResults& done, const std::string& method) {
  const std::vector<std::string> series = series_of(done);
  std::vector<std::string> texts;
  texts.reserve(series.size());
  for (const std::string& name : series) texts.push_back(border_text(select(done, method, name)));
  if (std::all_of(texts.begin(), texts.end(), [&](const auto& t) { return t == texts[0]; })) {
    return texts[0];
  }
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i] = series[i] + ": " + texts[i];
  return fmt::format("{}", fmt::join(texts, "<br>"));
}

std::string summary(const std::vector<ItemResults>& items) {
  std::vector<std::vector<std::string>> rows;
  for (const ItemResults& done : items) {
    const Item& item = done.item;
    rows.push_back({fmt::format("[{}](#{})", item.title, item.id),
                    item.border.empty() ? item.x_name : item.border, borders(done, "pinch"),
                    borders(done, "thesis"), borders(done, "cable"), item.why});
  }
  return markdown_table({"item", "along", "ours", "thesis", "plain cable", "why"}, rows);
}

/// The worst of each measure over an item's cases, by method.
std::string worst_table(const ItemResults& done) {
  std::vector<std::vector<std::string>> rows;
  for (const std::string& method : done.item.methods) {
    Measures worst;
    std::int64_t failed = 0, cases = 0, solves = 0, steps = 0, fallbacks = 0;
    int most = 0;
    for (const Result& r : select(done, method, "")) {
      const Measures& m = r.measures;
      worst.strain = std::max(worst.strain, m.strain);
      worst.squeeze = std::max(worst.squeeze, m.squeeze);
      worst.energy_gained = std::max(worst.energy_gained, m.energy_gained);
      worst.energy_lost = std::max(worst.energy_lost, m.energy_lost);
      worst.end_speed_m_s = std::max(worst.end_speed_m_s, m.end_speed_m_s);
      worst.error = std::max(worst.error, m.error);
      worst.finite = worst.finite && m.finite;
      ++cases;
      failed += r.verdict.failed() ? 1 : 0;
      solves += r.total_solves;
      steps += r.steps;
      fallbacks += r.fallbacks;
      most = std::max(most, r.most_solves);
    }
    const bool direct = most > 0;
    const auto number = [](double x) { return x == 0.0 ? "0" : fmt::format("{:.1e}", x); };
    rows.push_back(
        {title_of(method), fmt::format("{} of {}", failed, cases), worst.finite ? "yes" : "no",
         number(worst.strain), number(worst.squeeze), number(worst.energy_gained),
         number(worst.energy_lost), number(worst.end_speed_m_s), number(worst.error),
         direct ? fmt::format("{:.2f}, at most {}",
                              static_cast<double>(solves) / static_cast<double>(steps), most)
                : "sweeps",
         direct ? fmt::format("{} of {}", fallbacks, steps) : "-"});
  }
  return markdown_table({"method", "failed", "finite", "strain", "squeeze", "energy gained", "lost",
                         "end speed, m/s", "error", "solves a step", "fallbacks"},
                        rows);
}

/// Where ours has steps whose active set did not settle.
std::string unsettled(const ItemResults& done) {
  std::int64_t fallbacks = 0;
  std::vector<std::string> where;
  for (const Result& r : select(done, "pinch", "")) {
    fallbacks += r.fallbacks;
    if (r.fallbacks > 0) where.push_back(fmt::format("{} {}", r.series, value_text(r.x)));
  }
  if (fallbacks == 0) return "";
  return fmt::format(
      " In {} steps ({}) the active set of ours did not settle, and what flipped was held for the "
      "step; the measures count them like all others.",
      fallbacks, fmt::join(where, ", "));
}

std::string section(const ItemResults& done) {
  const Item& item = done.item;
  return fmt::format(
      "\n<a id=\"{0}\"></a>\n## {1}\n\n{2}\n\n![{1}](stability-{0}.svg)\n\n{3}{4} Largest measures "
      "over all cases ([table](stability-{0}.csv)):\n\n{5}",
      item.id, item.title, item.scene, item.why, unsettled(done), worst_table(done));
}

/// Totals that the introduction tells of ours.
std::string totals(const std::vector<ItemResults>& items) {
  std::int64_t runs = 0, failed = 0, steps = 0, fallbacks = 0, not_finite = 0;
  for (const ItemResults& done : items) {
    for (const Result& r : select(done, "pinch", "")) {
      ++runs;
      steps += r.steps;
      fallbacks += r.fallbacks;
      failed += r.verdict.failed() ? 1 : 0;
      not_finite += r.measures.finite ? 0 : 1;
    }
  }
  return fmt::format(
      "Ours: {} runs, {} steps, {} runs with numbers that are not finite, {} runs beyond a limit, "
      "{} steps whose active set did not settle.",
      runs, steps, not_finite, failed, fallbacks);
}

constexpr const char* introduction = R"(# How far each method holds, and how it fails beyond

Each scene is run along one parameter until a method fails. `ours` is the method `pinch` with the direct solver,
`thesis` all that the thesis describes (pinch joints with three rows, cables in 10 Gauss-Seidel sweeps a step, all-pairs
detection), `plain cable` cable joints without pinch, solved directly. 60 frames a second and 4 steps a frame unless the
item says otherwise. No item times anything: the numbers are the same in every run on one machine.

## When a run has failed

The limits were set before the runs and are the same for all methods. Each measure is taken at every step, from positions.

{}
The figures show the worst measure over its limit: 1 is the border, and the region above it is shaded. Where bodies
come to rest, energy may not be gained; where nothing takes energy away, it may not be lost either. "Energy at play"
is the weight of all that moves times the height that it may fall, and its energy of motion at the start.

## Summary

{}

`all` means that no case failed; `up to` and `from` name the last value that held, and in brackets the first that did not
and how it failed.

{})";

std::string limits_table() {
  const Limits limits;
  const auto number = [](double x) { return fmt::format("{:g}", x); };
  return markdown_table(
      {"failure", "limit", "why this limit"},
      {{"not finite", "never", "a number is lost"},
       {"passed through", "never", "a body has crossed a cable"},
       {"stretched: cable in the spans beyond what it has, over its length", number(limits.strain),
        "a steel rope stretches by some thousandths under its working load"},
       {"squeezed: overlap of a body with a cable, over the cable's full width",
        number(limits.squeeze), "of a cable drawn 16 pixels wide, a sixtieth of a pixel"},
       {"length lost: wraps and spans against the cable's length", number(limits.length),
        "a millimetre a kilometre: far above round-off, far below what shows"},
       {"energy gained or lost, of that at play", number(limits.energy), "half a percent of speed"},
       {"restless: speed of any body or rim in the last tenth of a run that ends at rest, m/s",
        number(limits.end_speed_m_s), "a pixel in six seconds where 6 m fill 960 pixels"},
       {"wrong: motion against the closed form, relative", number(limits.error),
        "a hundredth is seen side by side, less hardly"}});
}

}  // namespace

std::string page_text(const std::vector<ItemResults>& items) {
  std::string text = fmt::format(introduction, limits_table(), totals(items), summary(items));
  for (const ItemResults& done : items) text += section(done);
  return text;
}

}  // namespace pinchlab::experiments::stability
