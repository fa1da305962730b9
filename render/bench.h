// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a frame costs, stage by stage.

#include <string>
#include <vector>

#include "render/picture/look.h"
#include "sim/configuration.h"

namespace pinchlab {

/// Processor time a frame, medians over the frames of one run, ms.
struct RenderCost {
  int width = 0, height = 0;  // px
  int frames = 0;
  double simulate_ms = 0.0;         // all steps of a frame
  double draw_ms = 0.0;             // compose and draw
  double convert_ms = 0.0;          // RGBA to YUV 4:2:0
  double encode_ms = 0.0;           // the yardstick: x264 veryfast, crf 14, one thread
  double encode_stimuli_ms = 0.0;   // with the settings the clips are written with
  double least_luma_psnr_db = 0.0;  // of the clip as written, over all frames

  /// (simulate + draw + convert) / encode: at most 0.25 is the aim, and 0.18 in the mean.
  double ratio() const { return (simulate_ms + draw_ms + convert_ms) / encode_ms; }
};

/// Simulates, draws as `look` says, converts and encodes `frames` frames of the scene (0: all of
/// them) in one run, into scratch files that are removed. Throws std::runtime_error where the
/// simulation or a file fails.
RenderCost measure_render(const Scene& scene, const SceneLook& look, const Configuration& method,
                          int width, int height, int frames = 0);

/// Several scenes together: each figure the mean over all their frames of the scenes' medians, the
/// PSNR the least of all. `costs` is not empty.
RenderCost mean_cost(const std::vector<RenderCost>& costs);

/// The figures as a table for people.
std::string table(const std::string& scene_name, const RenderCost& cost);

}  // namespace pinchlab
