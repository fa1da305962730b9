// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/stability/stability.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "sim/step.h"

namespace pinchlab::experiments {

void run_stability(const Options& options) {
  using namespace stability;
  Output output(options.out);
  const std::vector<Item> items = stability_items(options.quick);
  double total = 0.0;
  for (const Item& item : items) {
    for (const Case& test : item.cases) {
      total += static_cast<double>(item.methods.size()) * cost(test);
    }
  }
  Progress progress("stability", total);
  std::vector<ItemResults> done;
  for (const Item& item : items) {
    done.push_back(run_item(item, progress));
    const std::string name = "stability-" + item.id;
    output.csv(name, results_table(done.back()), options.command);
    if (!item.y_name.empty()) output.csv(name + "-map", map_table(done.back()), options.command);
    if (item.shows_speeds) output.csv(name + "-speeds", speeds_table(item), options.command);
    const Drawing drawing = draw(done.back());
    output.figure(name, drawing.width_px, drawing.height_px, drawing.commands);
  }
  output.page("stability", page_text(done), options.command);
}

namespace stability {

double cost(const Case& test) {
  std::size_t size = test.scene.bodies.size();
  for (const Cable& cable : test.scene.cables) size += cable.wraps.size() + 2;
  return static_cast<double>(step_count(test)) * static_cast<double>(size);
}

namespace {

Configuration configuration_of(const std::string& method) {
  const std::optional<Configuration> configuration = configuration_from_string(method);
  if (!configuration) throw std::logic_error(method + ": there is no such method");
  return *configuration;
}

}  // namespace

ItemResults run_item(const Item& item, Progress& progress) {
  ItemResults done{item, {}};
  for (const std::string& method : item.methods) {
    for (const Case& test : item.cases) {
      done.results.push_back(watch(test, method, configuration_of(method)));
      progress.done(cost(test));
    }
  }
  return done;
}

Csv results_table(const ItemResults& item) {
  Csv table({"series",      "method",         "x",      "y",       "severity",     "worst",
             "finite",      "passed_through", "strain", "squeeze", "length_error", "energy_gained",
             "energy_lost", "end_speed_m_s",  "error",  "steps",   "most_solves",  "total_solves",
             "fallbacks",   "link_changes"});
  for (const Result& r : item.results) {
    const Measures& m = r.measures;
    table.row({r.series,
               r.method,
               r.x,
               r.y,
               r.verdict.severity,
               std::string(to_string(r.verdict.worst)),
               std::int64_t{m.finite},
               std::int64_t{m.passed_through},
               m.strain,
               m.squeeze,
               m.length,
               m.energy_gained,
               m.energy_lost,
               m.end_speed_m_s,
               m.error,
               r.steps,
               std::int64_t{r.most_solves},
               r.total_solves,
               r.fallbacks,
               r.link_changes});
  }
  return table;
}

Csv map_table(const ItemResults& item) {
  Csv table({"method", "x", "y", "severity", "series", "worst"});
  for (const std::string& method : item.item.methods) {
    std::map<std::pair<double, double>, Result> worst;
    for (const Result& r : item.results) {
      if (r.method != method) continue;
      const auto [place, fresh] = worst.try_emplace({r.x, r.y}, r);
      if (!fresh && r.verdict.severity > place->second.verdict.severity) place->second = r;
    }
    for (const auto& [xy, r] : worst) {
      table.row({method, xy.first, xy.second, r.verdict.severity, r.series,
                 std::string(to_string(r.verdict.worst))});
    }
  }
  return table;
}

Csv speeds_table(const Item& item) {
  Csv table({"method", "time_s", "speed_m_s"});
  const auto middle = std::find_if(item.cases.begin(), item.cases.end(),
                                   [](const Case& test) { return test.x == 4.0; });
  if (middle == item.cases.end()) throw std::logic_error("speeds_table: there is no stack of four");
  for (const std::string& method : item.methods) {
    World world = make_world(middle->scene, configuration_of(method));
    Workspace work;
    for (std::int64_t i = 0; i < step_count(*middle); ++i) {
      if (step(middle->scene, world, work) != StepStatus::ok) break;
      double fastest = 0.0;
      for (std::size_t b = 1; b + 1 < middle->scene.bodies.size(); ++b) {
        fastest = std::max(fastest, std::abs(world.velocity[b].y()));
      }
      if (i % middle->scene.steps_per_frame == 0) table.row({method, world.time(), fastest});
    }
  }
  return table;
}

}  // namespace stability
}  // namespace pinchlab::experiments
