// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/series_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "base/output_file.h"
#include "base/progress.h"
#include "demos/legibility.h"
#include "demos/scenes/fineness.h"
#include "render/canvas.h"
#include "render/picture/compose.h"
#include "render/picture/frame_marks.h"
#include "render/png.h"
#include "render/vector_canvas.h"

namespace pinchlab {
namespace {

constexpr std::size_t most_pictures = 400;

/// What a row has that not all rows have: "squeeze 0.5, mass 2".
std::string label_of(const ParameterTable& table, std::size_t row) {
  std::string label;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const bool varies =
        std::ranges::any_of(table.rows, [&](const auto& r) { return r[c] != table.rows[0][c]; });
    if (!varies && table.rows.size() > 1) continue;
    label +=
        fmt::format("{}{} {}", label.empty() ? "" : ", ", table.columns[c], table.rows[row][c]);
  }
  return label;
}

/// The series' pictures, row by row of the sheet.
std::vector<VectorFrame> pictures_of(const Sweep& sweep, const std::string& method,
                                     const StillOptions& options) {
  BatchOptions render;
  render.method = method;
  const std::size_t columns = sweep.table.rows.size();
  std::vector<VectorFrame> sheet;
  for (std::size_t column = 0; column < columns; ++column) {
    // One at a time: rows that are alike are pictures of their own here.
    const Shard only{static_cast<int>(column) + 1, static_cast<int>(columns)};
    const Stimuli stimuli = stimuli_of(sweep, render, only);
    const Stimulus& stimulus = stimuli.list.front();
    const Scene& scene = stimulus.source.scene;
    const std::vector<int> frames = frames_at(scene, options.times);
    if (frames.size() * columns > most_pictures) {
      throw std::invalid_argument(fmt::format("a sheet of {} pictures is too large; at most {}",
                                              frames.size() * columns, most_pictures));
    }
    if (options.out.extension() == ".png") {
      check_sheet_size(frames.size() * columns, options, "take fewer times or a smaller --size");
    }
    if (!std::ranges::is_sorted(frames)) {
      throw std::invalid_argument("--time must go forward on the sheet of a series");
    }
    sheet.resize(frames.size() * columns);
    const Scenery scenery = set_scenery_aloud(stimulus.source, scene, options);
    tell_hard_to_see(sweep.table.place(column),
                     hard_to_see(scene, scenery, options.width, options.height));
    const Configuration& configuration = stimulus.plan.methods[0];
    const std::string who = fmt::format("{}, {}", scene.name, to_string(configuration));
    const Fineness fineness = find_fineness_aloud(stimulus.source, scene, configuration,
                                                  scene.frame_count - 1, options.time_limit, who);
    Player player(stimulus.source, made_finer(scene, fineness.factor), configuration);
    player.give_up_after(options.time_limit);
    Progress progress("simulating " + who, "steps",
                      std::int64_t{frames.back()} * player.scene().steps_per_frame);
    player.on_step([&progress] { progress.add(1); });
    for (std::size_t i = 0; i < frames.size(); ++i) {
      player.advance_to(frames[i]);
      VectorFrame& frame = sheet[i * columns + column];
      compose(player.scene(), scenery, player.world(), frame.picture);
      if (options.burn_time)
        frame.picture.add(time_label(scenery, player.time(), 1.0 * options.width / options.height));
      frame.label = fmt::format("{}, {:.2f} s", label_of(sweep.table, column), player.time());
    }
    progress.clear();
    std::vector<std::string> broken = player.broken_promises();
    add_missed_error(fineness, configuration, broken);
    tell_broken_promises(sweep.table.place(column), broken);
  }
  return sheet;
}

}  // namespace

void write_series(const Sweep& sweep, const std::string& method, const StillOptions& options) {
  const std::string ending = options.out.extension().string();
  if (ending != ".png" && ending != ".svg" && ending != ".pdf") {
    throw std::invalid_argument(options.out.string() + ": --out must end in .png, .svg or .pdf");
  }
  check_can_be_written(options.out);
  const std::vector<VectorFrame> sheet = pictures_of(sweep, method, options);
  const int columns = static_cast<int>(sweep.table.rows.size());
  if (ending != ".png") {
    write_vector(options.out.string(), ending == ".svg" ? VectorFormat::svg : VectorFormat::pdf,
                 options.width, options.height, sheet, columns, options.theme.theme);
    return;
  }
  Canvas canvas(options.width, options.height);
  const std::size_t bytes =
      4 * static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
  std::vector<SheetFrame> frames;
  for (const VectorFrame& frame : sheet) {
    const std::uint8_t* rgba = canvas.draw(frame.picture);
    frames.push_back({{rgba, rgba + bytes}, frame.label});
  }
  contact_sheet(options.out.string(), options.width, options.height, frames, columns,
                options.theme.theme);
}

}  // namespace pinchlab
