// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The main job: every scene's pair of clips, its poster and the manifest, made by worker processes.

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "demos/clip.h"
#include "demos/scenes/player.h"

namespace pinchlab {

/// Names of two methods that are to be compared, as method_of has them.
using MethodPair = std::pair<std::string, std::string>;

/// "pinch,cable". Throws std::invalid_argument with the form that is expected.
MethodPair pair_from(const std::string& text);

struct BatchOptions {
  std::vector<std::filesystem::path> scenes;  ///< files, or folders of NN-name.json
  std::filesystem::path out = "clips";        ///< made if missing
  std::optional<std::string> method;  ///< only this one ("baseline": each scene's own), no poster
  std::vector<MethodPair> pairs;  ///< these instead of pinch and baseline, both orders side by side
  int width = 960, height = 960;  ///< px, of one panel
  Timing timing;
  Codec codec = Codec::h264;
  ThemeFile theme;
  Playback playback;                 ///< of the clips; not of posters and reports
  bool burn_time = false;            ///< the time in a corner of each picture
  std::optional<double> time_limit;  ///< s of work on one method of a clip, then it has failed
  int jobs = 0;                      ///< worker processes; 0: one a core
  bool singles = true;               ///< each method's clip by itself, and the poster
  bool side_by_side = false;         ///< both left/right orders of each pair in one file
  bool report = false;  ///< how each pair differs: figures, a strip of pictures, report.html
  bool checks = false;  ///< attention checks: the pinch clip beside itself upside down, both orders
};

/// What `name` stands for: a method, "baseline" (the scene's own) or "thesis". Throws
/// std::invalid_argument.
Configuration method_of(const Scene& scene, const std::string& name);

/// What a batch makes of one scene: the pair's clips and poster, or the one clip asked for. Throws
/// std::invalid_argument for options that the scene or the codec cannot have.
std::vector<ClipPlan> plan_clips(const SceneFile& scene, const BatchOptions& options);

/// Makes what is missing or out of date and keeps the rest; tells progress, and at the end what was
/// done, on standard error, and the reports on standard output. Files appear under their names when
/// complete, one by one, and manifest.json with them. The same scenes and options give the same
/// bytes, for any number of jobs.
///
/// A clip that fails does not stop the others. Returns the number of failed ones; throws
/// std::runtime_error (SceneFileError for a bad scene, before anything is made) if nothing could be
/// done, std::invalid_argument for options that cannot be. SIGINT, SIGTERM and SIGHUP end the batch
/// and then the program, as they would without it.
int render_batch(const BatchOptions& options);

}  // namespace pinchlab
