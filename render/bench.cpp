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
#include "render/compose.h"
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
  rgba_to_yuv420(rgba, width, height, {y.data(), u.data(), v.data(), width, width / 2, width / 2});
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

/// Compares a clip with its frames, drawn again: the least luma PSNR of any.
double least_psnr_db(const std::string& clip, const Scene& scene, Method method, Canvas& canvas,
                     int frames) {
  VideoReader reader(clip);
  World world = make_world(scene, method);
  Picture picture;
  double least = infinity;
  for (int frame = 0; frame < frames; ++frame) {
    const std::optional<DecodedFrame> decoded = reader.next();
    if (!decoded) throw std::runtime_error(clip + ": ends too early");
    compose(scene, world, picture);
    const std::vector<std::uint8_t> drawn =
        luma_of(canvas.draw(picture), canvas.width(), canvas.height());
    least = std::min(least, psnr_db(drawn, decoded->luma));
    for (int s = 0; s < scene.steps_per_frame; ++s) step(scene, world);
  }
  return least;
}

}  // namespace

RenderCost measure_render(const Scene& scene, Method method, int width, int height, int frames) {
  RenderCost cost;
  cost.width = width;
  cost.height = height;
  cost.frames = frames > 0 ? frames : scene.frame_count;

  const ScratchFolder scratch;
  const std::string yardstick_clip = (scratch.path / "yardstick.mp4").string();
  const std::string stimulus_clip = (scratch.path / "stimulus.mp4").string();
  const VideoSettings stimulus{Codec::h264, width, height, scene.frames_per_second, ""};
  VideoSettings yardstick = stimulus;
  yardstick.encoder_options = "preset=veryfast:crf=14";
  VideoWriter yardstick_writer(yardstick_clip, yardstick), stimulus_writer(stimulus_clip, stimulus);

  Canvas canvas(width, height);
  World world = make_world(scene, method);
  Picture picture;
  std::vector<double> simulate, draw, convert, encode, encode_stimulus;
  for (int frame = 0; frame < cost.frames; ++frame) {
    const double start = processor_seconds();
    compose(scene, world, picture);
    const std::uint8_t* pixels = canvas.draw(picture);
    draw.push_back(processor_seconds() - start);
    yardstick_writer.add(pixels);
    convert.push_back(yardstick_writer.convert_seconds());
    encode.push_back(yardstick_writer.encode_seconds());
    stimulus_writer.add(pixels);
    encode_stimulus.push_back(stimulus_writer.encode_seconds());
    const double drawn = processor_seconds();
    for (int s = 0; s < scene.steps_per_frame; ++s) {
      if (step(scene, world) != StepStatus::ok)
        throw std::runtime_error(scene.name + ": " + world.failure);
    }
    simulate.push_back(processor_seconds() - drawn);
  }
  yardstick_writer.finish();
  stimulus_writer.finish();

  cost.simulate_ms = median_ms(simulate);
  cost.draw_ms = median_ms(draw);
  cost.convert_ms = median_ms(convert);
  cost.encode_ms = median_ms(encode);
  cost.encode_stimuli_ms = median_ms(encode_stimulus);
  cost.least_luma_psnr_db = least_psnr_db(stimulus_clip, scene, method, canvas, cost.frames);
  return cost;
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
  text += fmt::format("  {:<44}{:8.3f}    (at most 0.4)\n", "(simulate + draw + convert) / encode",
                      cost.ratio());
  row("encode with the clips' own settings", cost.encode_stimuli_ms);
  text += fmt::format("  {:<44}{:8.2f} dB (at least 46)\n",
                      "least luma PSNR of any frame of the clip", cost.least_luma_psnr_db);
  return text;
}

}  // namespace pinchlab
