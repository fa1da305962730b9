// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numbers>
#include <vector>

#include "base/html.h"
#include "base/output_file.h"

namespace pinchlab {
namespace {

using nlohmann::ordered_json;

std::string name_of(const ordered_json& entry) {
  const auto scene = entry.at("scene").get<std::string>();
  return scene.substr(0, scene.rfind('.'));
}

std::vector<const ordered_json*> reports(const Manifest& manifest) {
  std::vector<const ordered_json*> found;
  for (const ordered_json& entry : manifest.entries) {
    if (entry.value("role", "") == "report" && entry.contains("report")) found.push_back(&entry);
  }
  return found;
}

std::string seconds_or_never(const ordered_json& value) {
  return value.is_null() ? "never" : fmt::format("{:.2f}", value.get<double>());
}

/// The first thing that happens in the clip with pinch joints, and when; or nothing.
const ordered_json* first_event(const ordered_json& report) {
  for (const ordered_json& event : report.at("pinch").at("events")) {
    const auto what = event.at("what").get<std::string>();
    if (what.find("pinched") != std::string::npos) return &event;
  }
  return nullptr;
}

double number(const ordered_json& object, const char* key) {
  return object.at(key).get<double>();
}

// Where nothing differs no body is the farthest.
std::string largest_distance(const ordered_json& report) {
  const auto body = report.at("largest_distance_body").get<std::string>();
  if (body.empty()) return "0";
  return fmt::format("{:.0f} ({}) at {:.2f}", number(report, "largest_distance_px"), body,
                     number(report, "largest_distance_at_s"));
}

std::vector<std::string> cells(const ordered_json& entry) {
  const ordered_json& report = entry.at("report");
  const ordered_json *pinch = &report.at("pinch"), *baseline = &report.at("baseline");
  const ordered_json* event = first_event(report);
  return {name_of(entry),
          fmt::format("{:.2f}", number(entry, "duration_s")),
          event == nullptr ? "never" : fmt::format("{:.2f}", number(*event, "from_s")),
          seconds_or_never(report.at("first_difference_s")),
          fmt::format("{:.0f}", 100.0 * number(report, "same_share")),
          largest_distance(report),
          fmt::format("{:.0f}", number(report, "largest_turn_rad") * 180.0 / std::numbers::pi),
          fmt::format("{:.0f} / {:.0f}", 100.0 * number(*pinch, "still_share"),
                      100.0 * number(*baseline, "still_share")),
          fmt::format("{:.2f} / {:.2f}", number(*pinch, "longest_still_s"),
                      number(*baseline, "longest_still_s")),
          fmt::format("{:.0f} / {:.0f}", number(*pinch, "end_speed_px_s"),
                      number(*baseline, "end_speed_px_s"))};
}

const std::vector<std::string> headings = {"pair",
                                           "length s",
                                           "first pinch s",
                                           "differs from s",
                                           "same %",
                                           "largest distance px",
                                           "largest turn deg",
                                           "still %",
                                           "longest still s",
                                           "speed at end px/s"};

std::string bars(const ordered_json& intervals, double scale, double y, const char* look) {
  std::string svg;
  for (const ordered_json& interval : intervals) {
    const double from = interval[0].get<double>(), to = interval[1].get<double>();
    fmt::format_to(std::back_inserter(svg),
                   R"(<rect class="{}" x="{:.1f}" y="{:.0f}" width="{:.1f}" height="12"/>)", look,
                   from * scale, y, std::max(1.5, (to - from) * scale));
  }
  return svg;
}

/// Time from left to right: when the clips differ, when each stands still, and what happens.
std::string timeline(const ordered_json& entry) {
  const ordered_json& report = entry.at("report");
  const double duration = number(entry, "duration_s"), scale = 640.0 / duration;
  std::string svg, ticks;
  double y = 4.0;
  const auto row = [&](const std::string& name, const std::string& content) {
    fmt::format_to(std::back_inserter(svg), R"(<text x="650" y="{:.0f}">{}</text>{})", y + 10.0,
                   html_escaped(name), content);
    y += 18.0;
  };
  row("clips differ", bars(report.at("differs_s"), scale, y, "differs"));
  for (const char* clip : {"pinch", "baseline"}) {
    row(fmt::format("{} stands still", clip == std::string("pinch") ? "pinch joints" : clip),
        bars(report.at(clip).at("still_s"), scale, y, "still"));
  }
  for (const char* clip : {"pinch", "baseline"}) {
    std::vector<std::string> told;
    for (const ordered_json& event : report.at(clip).at("events")) {
      const auto what = event.at("what").get<std::string>();
      if (std::ranges::find(told, what) != told.end()) continue;
      told.push_back(what);
      ordered_json times = ordered_json::array();
      for (const ordered_json& same : report.at(clip).at("events")) {
        if (same.at("what") == what) times.push_back({same.at("from_s"), same.at("to_s")});
      }
      row(fmt::format("{}: {}", clip == std::string("pinch") ? "pinch joints" : clip, what),
          bars(times, scale, y, clip));
    }
  }
  for (int second = 0; second <= duration; ++second) {
    fmt::format_to(std::back_inserter(ticks),
                   R"(<path d="M{0:.1f} 0V{1:.0f}"/><text x="{0:.1f}" y="{2:.0f}">{3} s</text>)",
                   second * scale, y, y + 14.0, second);
  }
  return fmt::format(
      R"(<svg viewBox="-2 0 1080 {:.0f}" role="img" aria-label="When the clips of {} differ, stand still, and what happens; the list below says the same"><g class="ticks">{}</g>{}</svg>)",
      y + 20.0, html_escaped(name_of(entry)), ticks, svg);
}

std::string event_list(const ordered_json& report, const char* clip) {
  std::string list;
  for (const ordered_json& event : report.at(clip).at("events")) {
    fmt::format_to(std::back_inserter(list), "<li>{:.2f} to {:.2f} s: {}</li>",
                   number(event, "from_s"), number(event, "to_s"),
                   html_escaped(event.at("what").get<std::string>()));
  }
  return fmt::format("<ul>{}</ul>", list.empty() ? "<li>nothing</li>" : list);
}

constexpr const char* head = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Pairs of clips: how they differ</title>
<style>
body{font:16px/1.5 sans-serif;max-width:70rem;margin:1rem auto;padding:0 1rem;color:#222;background:#fff}
table{border-collapse:collapse}th,td{border:1px solid #bbb;padding:.2rem .5rem;text-align:right}
th:first-child,td:first-child{text-align:left}img{max-width:100%}svg{width:100%;max-width:1080px}
svg text{font:12px sans-serif;fill:#222}.ticks path{stroke:#ccc}.differs{fill:#b3470a}.still{fill:#999}
.pinch{fill:#00528a}.baseline{fill:#00644a}.wide{overflow-x:auto}
</style></head><body><main>
<h1>Pairs of clips: how they differ</h1>
<p>Left of a stroke: the clip with pinch joints; right of it: its baseline. A frame <em>differs</em> to the eye
where blocks of 4 × 4 px differ by more than a fifth of the scale in at least a thousandth of the picture.
Nothing <em>moves</em> where in a quarter of a second no centre and no rim moves by 1 px.</p>
)";

}  // namespace

std::string report_table(const Manifest& manifest) {
  std::vector<std::vector<std::string>> rows = {headings};
  for (const ordered_json* entry : reports(manifest)) rows.push_back(cells(*entry));
  if (rows.size() == 1) return "";
  std::vector<std::size_t> widths(headings.size(), 0);
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string table;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += i == 0 ? fmt::format("{:<{}}", row[i], widths[i])
                     : fmt::format("  {:>{}}", row[i], widths[i]);
    }
    table += line + "\n";
  }
  return table;
}

void write_report_page(const std::filesystem::path& folder, const Manifest& manifest) {
  std::string page = head;
  page += R"(<div class="wide"><table><thead><tr>)";
  for (const std::string& heading : headings) page += "<th scope=\"col\">" + heading + "</th>";
  page += "</tr></thead><tbody>";
  for (const ordered_json* entry : reports(manifest)) {
    page += "<tr>";
    bool first = true;
    for (const std::string& cell : cells(*entry)) {
      page +=
          first ? fmt::format(R"(<th scope="row"><a href="#{0}">{0}</a></th>)", html_escaped(cell))
                : "<td>" + html_escaped(cell) + "</td>";
      first = false;
    }
    page += "</tr>\n";
  }
  page += "</tbody></table></div>\n";
  for (const ordered_json* entry : reports(manifest)) {
    const ordered_json& report = entry->at("report");
    fmt::format_to(
        std::back_inserter(page),
        "<section><h2 id=\"{0}\">{0}: {1}</h2>\n{2}\n"
        "<p><img src=\"{3}\" alt=\"Eight moments of both clips and their difference\"></p>\n"
        "<details><summary>Events</summary><h3>Pinch joints</h3>{4}<h3>Baseline</h3>{5}"
        "</details></section>\n",
        html_escaped(name_of(*entry)), html_escaped(entry->at("title").get<std::string>()),
        timeline(*entry), html_escaped(entry->at("file").get<std::string>()),
        event_list(report, "pinch"), event_list(report, "baseline"));
  }
  page += "</main></body></html>\n";
  OutputFile out(folder / "report.html");
  out.write(page);
  out.finish();
}

}  // namespace pinchlab
