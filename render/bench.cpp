// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "render/canvas.h"
#include "render/picture/compose.h"
#include "render/processor_time.h"
#include "render/video.h"
#include "render/yuv.h"
#include "sim/step.h"

namespace pinchlab {

namespace {

/// A folder of its own among the system's temporary files, removed at the end.
struct ScratchFolder {
  std::filesystem::path path;
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "pinchlab-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw std::runtime_error("cannot make a folder like " + name);
    path = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
};

double median_ms(std::vector<double>& seconds) {
  const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
  std::nth_element(seconds.begin(), middle, seconds.end());
  return 1e3 * *middle;
}

/// The luma plane that a writer makes of a frame.
std::vector<std::uint8_t> luma_of(const std::uint8_t* rgba, int width, int height) {
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::vector<std::uint8_t> y(count), u(count / 4), v(count / 4);
  rgba_to_yuv420(rgba, width, {0, 0, width, height},
                 {y.data(), u.data(), v.data(), width, width / 2, width / 2});
  return y;
}

/// Peak signal-to-noise ratio of 8-bit samples, dB.
double psnr_db(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    sum += d * d;
  }
  return sum > 0.0 ? 10.0 * std::log10(255.0 * 255.0 * static_cast<double>(a.size()) / sum)
                   : infinity;
}

void advance_frame(const Scene& scene, World& world, Workspace& work) {
  for (int s = 0; s < scene.steps_per_frame; ++s) {
    if (step(scene, world, work) != StepStatus::ok)
      throw std::runtime_error(scene.name + ": " + world.failure);
  }
}

/// The stages as in making a clip, with the yardstick's encoder.
void time_stages(const Scene& scene, const Scenery& scenery, const Configuration& method,
                 Canvas& canvas, VideoWriter& writer, RenderCost& cost) {
  std::vector<double> simulate, draw, convert, encode;
  World world = make_world(scene, method);
  Workspace work;
  Picture picture;
  for (int frame = 0; frame < cost.frames; ++frame) {
    const double start = processor_seconds();
    compose(scene, scenery, world, picture);
    const std::uint8_t* pixels = canvas.draw(picture);
    draw.push_back(processor_seconds() - start);
    writer.add(pixels, canvas.changed());
    convert.push_back(writer.convert_seconds());
    encode.push_back(writer.encode_seconds());
    const double encoded = processor_seconds();
    advance_frame(scene, world, work);
    simulate.push_back(processor_seconds() - encoded);
  }
  writer.finish();
  cost.simulate_ms = median_ms(simulate);
  cost.draw_ms = median_ms(draw);
  cost.convert_ms = median_ms(convert);
  cost.encode_ms = median_ms(encode);
}

/// The clip as it is written, and how near its frames come to the drawn ones.
void measure_clip(const Scene& scene, const Scenery& scenery, const Configuration& method,
                  Canvas& canvas, const std::string& path, const VideoSettings& settings,
                  RenderCost& cost) {
  VideoWriter writer(path, settings);
  std::vector<double> encode;
  World world = make_world(scene, method);
  Workspace work;
  Picture picture;
  for (int frame = 0; frame < cost.frames; ++frame) {
    compose(scene, scenery, world, picture);
    const std::uint8_t* pixels = canvas.draw(picture);
    writer.add(pixels, canvas.changed());
    encode.push_back(writer.encode_seconds());
    advance_frame(scene, world, work);
  }
  writer.finish();
  cost.encode_stimuli_ms = median_ms(encode);

  VideoReader reader(path);
  world = make_world(scene, method);
  cost.least_luma_psnr_db = infinity;
  for (int frame = 0; frame < cost.frames; ++frame) {
    const std::optional<DecodedFrame> decoded = reader.next();
    if (!decoded) throw std::runtime_error(path + ": ends too early");
    compose(scene, scenery, world, picture);
    const std::vector<std::uint8_t> luma =
        luma_of(canvas.draw(picture), canvas.width(), canvas.height());
    cost.least_luma_psnr_db = std::min(cost.least_luma_psnr_db, psnr_db(luma, decoded->luma));
    advance_frame(scene, world, work);
  }
}

}  // namespace

RenderCost measure_render(const Scene& scene, const SceneLook& look, const Configuration& method,
                          int width, int height, int frames) {
  RenderCost cost;
  cost.width = width;
  cost.height = height;
  cost.frames = frames > 0 ? frames : scene.frame_count;
  const ScratchFolder scratch;
  const VideoSettings stimulus{Codec::h264, width, height, scene.frames_per_second, ""};
  VideoSettings yardstick = stimulus;
  yardstick.encoder_options = "preset=veryfast:crf=14";
  VideoWriter writer((scratch.path / "yardstick.mp4").string(), yardstick);
  Canvas canvas(width, height);
  const Scenery scenery = set_scenery(scene, look);
  time_stages(scene, scenery, method, canvas, writer, cost);
  measure_clip(scene, scenery, method, canvas, (scratch.path / "stimulus.mp4").string(), stimulus,
               cost);
  return cost;
}

RenderCost mean_cost(const std::vector<RenderCost>& costs) {
  RenderCost mean = costs.front();
  for (double* figure : {&mean.simulate_ms, &mean.draw_ms, &mean.convert_ms, &mean.encode_ms,
                         &mean.encode_stimuli_ms}) {
    *figure = 0.0;
  }
  mean.frames = 0;
  for (const RenderCost& cost : costs) mean.frames += cost.frames;
  for (const RenderCost& cost : costs) {
    const double share = static_cast<double>(cost.frames) / mean.frames;
    mean.simulate_ms += share * cost.simulate_ms;
    mean.draw_ms += share * cost.draw_ms;
    mean.convert_ms += share * cost.convert_ms;
    mean.encode_ms += share * cost.encode_ms;
    mean.encode_stimuli_ms += share * cost.encode_stimuli_ms;
    mean.least_luma_psnr_db = std::min(mean.least_luma_psnr_db, cost.least_luma_psnr_db);
  }
  return mean;
}

std::string table(const std::string& scene_name, const RenderCost& cost) {
  std::string text = fmt::format("{}: {} frames of {} x {} px, median processor time a frame\n",
                                 scene_name, cost.frames, cost.width, cost.height);
  const auto row = [&text](const char* stage, double ms) {
    text += fmt::format("  {:<44}{:8.3f} ms\n", stage, ms);
  };
  row("simulate", cost.simulate_ms);
  row("draw", cost.draw_ms);
  row("convert to YUV 4:2:0", cost.convert_ms);
  row("encode (x264 veryfast, crf 14, one thread)", cost.encode_ms);
  text += fmt::format("  {:<44}{:8.3f}    (aim: 0.25, mean 0.18)\n",
                      "(simulate + draw + convert) / encode", cost.ratio());
  row("encode with the clips' own settings", cost.encode_stimuli_ms);
  text += fmt::format("  {:<44}{:8.2f} dB (at least 46)\n",
                      "least luma PSNR of any frame of the clip", cost.least_luma_psnr_db);
  return text;
}

}  // namespace pinchlab
