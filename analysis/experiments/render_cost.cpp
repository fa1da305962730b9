// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/render_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "analysis/experiments/experiment.h"
#include "demos/batch.h"
#include "demos/command_line.h"
#include "demos/scenes/find_scenes.h"
#include "render/bench.h"

namespace pinchlab::experiments {

namespace {

/// The aims of the renderer.
constexpr double wanted_mean = 0.18, wanted_most = 0.25, wanted_psnr_db = 46.0;

struct Named {
  std::string name;
  RenderCost cost;
};

std::vector<double> figures(const RenderCost& cost) {
  return {cost.simulate_ms, cost.draw_ms,           cost.convert_ms,        cost.encode_ms,
          cost.ratio(),     cost.encode_stimuli_ms, cost.least_luma_psnr_db};
}

Csv table_of(const std::vector<Named>& all) {
  Csv csv({"scene", "width_px", "height_px", "frames", "simulate_ms", "draw_ms", "convert_ms",
           "encode_ms", "ratio", "encode_stimuli_ms", "least_luma_psnr_db"});
  for (const Named& one : all) {
    std::vector<Csv::Cell> row{one.name, std::int64_t{one.cost.width},
                               std::int64_t{one.cost.height}, std::int64_t{one.cost.frames}};
    for (const double figure : figures(one.cost)) row.emplace_back(figure);
    csv.row(row);
  }
  return csv;
}

std::string page_of(const std::vector<Named>& all) {
  const RenderCost& mean = all.back().cost;
  const double most = std::max_element(all.begin(), all.end(), [](const Named& a, const Named& b) {
                        return a.cost.ratio() < b.cost.ratio();
                      })->cost.ratio();
  std::string text = fmt::format(
      "# What a frame of a clip costs\n\n"
      "A frame of {} x {} pixels takes {:.3f} ms to simulate, {:.3f} ms to draw and {:.3f} ms to "
      "convert to YUV 4:2:0: together {:.2f} times what a fast encoder (x264 veryfast, crf 14, one "
      "thread) takes for it, {} the {} that was asked for; the most of one scene is {:.2f} ({} "
      "asked). "
      "The clips as they are written differ from the drawn frames by a luma PSNR of {:.1f} dB or "
      "more "
      "({} dB asked). Processor time, medians over the frames of one run.\n\n",
      mean.width, mean.height, mean.simulate_ms, mean.draw_ms, mean.convert_ms, mean.ratio(),
      mean.ratio() <= wanted_mean ? "below" : "above", wanted_mean, most, wanted_most,
      mean.least_luma_psnr_db, wanted_psnr_db);
  std::vector<std::vector<std::string>> rows;
  for (const Named& one : all) {
    rows.push_back({one.name});
    for (const double figure : figures(one.cost))
      rows.back().push_back(fmt::format("{:.3f}", figure));
  }
  return text + markdown_table({"scene", "simulate, ms", "draw, ms", "convert, ms", "encode, ms",
                                "ratio", "encode with the clips' settings, ms", "least PSNR, dB"},
                               rows);
}

}  // namespace

void run_render(const RenderRun& run) {
  std::vector<std::filesystem::path> scenes{run.scene};
  if (run.scene.empty()) scenes = find_scenes({demos_folder()});
  std::vector<Named> all;
  std::vector<RenderCost> costs;
  for (const std::filesystem::path& path : scenes) {
    const SceneFile file = read_scene_file(path);
    const Scene& scene = file.scene;
    costs.push_back(measure_render(scene, file.look, method_of(scene, run.method), run.width,
                                   run.height, run.frames));
    all.push_back({scene.name, costs.back()});
    fmt::print("{}\n", table(scene.name, costs.back()));
    std::fflush(stdout);
  }
  if (costs.size() > 1) {
    all.push_back({"mean of all", mean_cost(costs)});
    fmt::print("{}", table(all.back().name, all.back().cost));
  }
  if (run.out.empty()) return;
  Output output(run.out);
  output.csv("render", table_of(all), run.command);
  output.page("render", page_of(all), run.command);
}

}  // namespace pinchlab::experiments
