// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/still.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numeric>
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

constexpr std::size_t most_frames = 10'000;
// px; of a sheet there are two copies of 4 bytes a pixel in memory: the pictures, and all together
constexpr std::size_t most_sheet_pixels = 100'000'000;

int frame_at(const Scene& scene, const std::string& text) {
  const double duration = static_cast<double>(scene.frame_count) / scene.frames_per_second;
  char* end = nullptr;
  const double time = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(0.0 <= time && time <= duration)) {
    throw std::invalid_argument(fmt::format("{}: --time must be 0 to {} s, or FROM:TO, not {}",
                                            scene.name, duration, text.empty() ? "nothing" : text));
  }
  return static_cast<int>(std::lround(time * scene.frames_per_second));
}

using Show = std::function<void(std::size_t index, const Player& player, const Picture& picture)>;

/// Composes the frames, in the order of time (the simulation only runs forward); `index` counts
/// them in the order asked for.
void play(const SceneFile& file, const StillOptions& options, const Configuration& method,
          const std::vector<int>& frames, const Scenery& scenery, const Show& show) {
  std::vector<std::size_t> by_time(frames.size());
  std::iota(by_time.begin(), by_time.end(), 0U);
  std::ranges::stable_sort(by_time, {}, [&](std::size_t i) { return frames[i]; });
  const int last = *std::ranges::max_element(frames);
  const std::string who = fmt::format("{}, {}", file.scene.name, to_string(method));
  // Of the whole clip, whose frames these are.
  const int all = file.scene.frame_count - 1;
  const Fineness fineness =
      find_fineness_aloud(file, file.scene, method, all, options.time_limit, who);
  Player player(file, made_finer(file.scene, fineness.factor), method);
  player.give_up_after(options.time_limit);
  Progress progress("simulating " + who, "steps",
                    std::int64_t{last} * player.scene().steps_per_frame);
  player.on_step([&progress] { progress.add(1); });
  Picture picture;
  for (const std::size_t i : by_time) {
    player.advance_to(frames[i]);
    compose(player.scene(), scenery, player.world(), picture);
    if (options.burn_time)
      picture.add(time_label(scenery, player.time(), 1.0 * options.width / options.height));
    show(i, player, picture);
  }
  progress.clear();
  tell_fineness(fmt::format("{}: {}", file.path.string(), to_string(method)), fineness);
  std::vector<std::string> broken = player.broken_promises();
  add_missed_error(fineness, method, broken);
  tell_broken_promises(file.path.string(), broken);
}

std::string label_of(const StillOptions& options, std::size_t row, double time) {
  return options.neutral
             ? fmt::format("{:c}, {:.2f} s", static_cast<char>('A' + static_cast<int>(row)), time)
             : fmt::format("{}, {:.2f} s", in_words(options.methods[row]), time);
}

int sheet_columns(const StillOptions& options, const std::vector<int>& frames) {
  return options.methods.size() > 1 ? static_cast<int>(frames.size()) : 0;
}

void write_png_still(const SceneFile& file, const StillOptions& options,
                     const std::vector<int>& frames, const Scenery& scenery) {
  Canvas canvas(options.width, options.height);
  const std::size_t bytes =
      4 * static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
  std::vector<SheetFrame> sheet(frames.size() * options.methods.size());
  for (std::size_t row = 0; row < options.methods.size(); ++row) {
    play(file, options, options.methods[row], frames, scenery,
         [&](std::size_t i, const Player& player, const Picture& picture) {
           const std::uint8_t* rgba = canvas.draw(picture);
           sheet[row * frames.size() + i] = {{rgba, rgba + bytes},
                                             label_of(options, row, player.time())};
         });
  }
  if (sheet.size() == 1) {
    write_png(options.out.string(), options.width, options.height, sheet.front().rgba.data());
    return;
  }
  contact_sheet(options.out.string(), options.width, options.height, sheet,
                sheet_columns(options, frames), options.theme.theme);
}

void write_vector_still(const SceneFile& file, const StillOptions& options, VectorFormat format,
                        const std::vector<int>& frames, const Scenery& scenery) {
  std::vector<VectorFrame> sheet(frames.size() * options.methods.size());
  for (std::size_t row = 0; row < options.methods.size(); ++row) {
    play(file, options, options.methods[row], frames, scenery,
         [&](std::size_t i, const Player& player, const Picture& picture) {
           sheet[row * frames.size() + i] = {picture, label_of(options, row, player.time())};
         });
  }
  write_vector(options.out.string(), format, options.width, options.height, sheet,
               sheet_columns(options, frames), options.theme.theme);
}

/// Every frame a file of its own, its number in the place of the #, in a folder that is made.
void write_sequence(const SceneFile& file, const StillOptions& options,
                    const std::vector<int>& frames, const Scenery& scenery) {
  const std::string name = options.out.filename().string();
  const std::size_t place = name.find('#');
  Canvas canvas(options.width, options.height);
  play(file, options, options.methods.front(), frames, scenery,
       [&](std::size_t, const Player& player, const Picture& picture) {
         const std::string numbered = fmt::format("{}{:05}{}", name.substr(0, place),
                                                  player.frame(), name.substr(place + 1));
         write_png((options.out.parent_path() / numbered).string(), options.width, options.height,
                   canvas.draw(picture));
       });
}

}  // namespace

namespace {

std::vector<std::string> split_at_commas(const std::vector<std::string>& lists) {
  std::vector<std::string> parts;
  for (const std::string& list : lists) {
    for (std::size_t begin = 0; begin <= list.size();) {
      const std::size_t end = std::min(list.find(',', begin), list.size());
      parts.push_back(list.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  return parts;
}

}  // namespace

std::vector<int> frames_at(const Scene& scene, const std::vector<std::string>& times) {
  std::vector<int> frames;
  for (const std::string& time : split_at_commas(times)) {
    const std::size_t colon = time.find(':');
    const int from = frame_at(scene, time.substr(0, colon));
    const int to = colon == std::string::npos ? from : frame_at(scene, time.substr(colon + 1));
    if (to < from) {
      throw std::invalid_argument(
          fmt::format("{}: --time {} ends before it begins", scene.name, time));
    }
    for (int frame = from; frame <= to; ++frame) frames.push_back(frame);
  }
  if (frames.size() > most_frames) {
    throw std::invalid_argument(fmt::format("{}: --time names {} frames; {} at most", scene.name,
                                            frames.size(), most_frames));
  }
  return frames;
}

Scenery set_scenery_aloud(const SceneFile& file, const Scene& scene, const StillOptions& options) {
  constexpr std::int64_t methods = 2;  // the pair's
  Progress progress(fmt::format("placing labels and fitting the view of {}", scene.name), "steps",
                    methods * scene.frame_count * scene.steps_per_frame);
  const auto check_time = rehearsal_limit(file, options.time_limit);
  return for_file(file.path, [&] {
    return set_scenery(scene, file.look, options.theme.theme, [&](const World& world) {
      progress.add(1);
      check_time(world);
    });
  });
}

void check_sheet_size(std::size_t pictures, const StillOptions& options, const std::string& cure) {
  const std::size_t pixels =
      pictures * static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
  if (pictures > 1 && pixels > most_sheet_pixels) {
    throw std::invalid_argument(
        fmt::format("a sheet of {} pictures of {}x{} pixels is too large: {} million pixels, {} at "
                    "most; {}",
                    pictures, options.width, options.height, pixels / 1'000'000,
                    most_sheet_pixels / 1'000'000, cure));
  }
}

void write_still(const SceneFile& file, const StillOptions& options) {
  const std::vector<int> frames = frames_at(file.scene, options.times);
  const std::string ending = options.out.extension().string();
  const bool sequence = options.out.filename().string().find('#') != std::string::npos;
  if (ending != ".png" && (sequence || (ending != ".svg" && ending != ".pdf"))) {
    throw std::invalid_argument(fmt::format(
        "{}: --out must end in {}", options.out.string(),
        sequence ? ".png where a # stands for the frame's number" : ".png, .svg or .pdf"));
  }
  if (sequence && options.methods.size() > 1) {
    throw std::invalid_argument(
        "a # in --out writes one picture a file; name one --method instead of --both");
  }
  if (ending == ".png" && !sequence) {
    check_sheet_size(frames.size() * options.methods.size(), options,
                     options.methods.size() > 1
                         ? "take fewer times or a smaller --size"
                         : "a # in --out's name gives each frame a file of its own; or take fewer "
                           "times or a smaller --size");
  }
  if (sequence && options.out.has_parent_path()) make_folders(options.out.parent_path());
  check_can_be_written(options.out);
  const Scenery scenery = set_scenery_aloud(file, file.scene, options);
  tell_hard_to_see(file.path.string(),
                   hard_to_see(file.scene, scenery, options.width, options.height));
  if (sequence) {
    write_sequence(file, options, frames, scenery);
  } else if (ending == ".png") {
    write_png_still(file, options, frames, scenery);
  } else {
    write_vector_still(file, options, ending == ".svg" ? VectorFormat::svg : VectorFormat::pdf,
                       frames, scenery);
  }
}

}  // namespace pinchlab
