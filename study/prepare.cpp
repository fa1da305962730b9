// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/prepare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>

#include "study/page_assets.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;

// The demonstrations of a configuration that names none.
std::vector<std::string> all_demonstrations(const Stimuli& stimuli, const fs::path& clips) {
  std::vector<std::string> names = stimuli.demonstrations();
  return names.empty() ? rendered_pairs(clips, PairKind::methods, Encoding::mp4) : names;
}

void render_missing(const Stimuli& stimuli, const fs::path& clips, bool no_webm,
                    const Config& config) {
  std::map<PairKind, std::set<std::string>> needed;
  // Clips of several methods, and graded ones, are the researcher's own.
  if (config.methods.empty() && config.graded.empty()) {
    needed[PairKind::methods] = {config.demonstrations.begin(), config.demonstrations.end()};
  }
  needed[PairKind::methods].insert(config.training.begin(), config.training.end());
  for (const AttentionCheck& check : config.attention_checks) {
    if (!check.demonstration.empty()) {
      needed[PairKind::check].insert(check.demonstration);
    }
  }
  std::vector<Encoding> encodings = {Encoding::mp4};
  if (!no_webm) {
    encodings.push_back(Encoding::webm);
  }
  const std::vector<std::string> known = stimuli.demonstrations();
  for (const Encoding encoding : encodings) {
    for (const auto& [kind, names] : needed) {
      const std::vector<std::string> present = rendered_pairs(clips, kind, encoding);
      std::vector<std::string> missing;
      // What cannot be made here is told by open_clips; WebM is only offered where it is.
      std::ranges::copy_if(names, std::back_inserter(missing), [&](const std::string& name) {
        return std::ranges::find(present, name) == present.end() &&
               std::ranges::find(known, name) != known.end();
      });
      if (!missing.empty()) {
        fmt::print(stderr, "Rendering the {} that are missing ({}): {}\n",
                   kind == PairKind::check ? "attention checks" : "side-by-side clips",
                   to_string(encoding), fmt::join(missing, ", "));
        stimuli.render(missing, kind, clips, encoding);
      }
    }
  }
}

}  // namespace

Config read_or_default(const fs::path& path) {
  return path.empty() ? default_config() : read_config(path);
}

Clips prepare(Config& config, const Stimuli& stimuli, const fs::path& clips, bool no_webm) {
  if (!has_page()) {
    throw std::runtime_error(
        "this program was built without the page, because npm had not installed jsPsych; run: npm "
        "ci --prefix study/page, then build again");
  }
  if (config.demonstrations.empty()) {
    config.demonstrations = all_demonstrations(stimuli, clips);
  }
  if (config.demonstrations.empty()) {
    throw std::runtime_error(fmt::format(
        "{}: has no side-by-side clips, and there is no folder demos here to render them from; go "
        "to the project's folder, or run pinchlab render --side-by-side",
        clips.string()));
  }
  render_missing(stimuli, clips, no_webm, config);
  Clips opened = open_clips(clips, config);
  for (const std::string& sentence : same_clips(opened)) {
    fmt::print(stderr, "Warning: {}: {}\n", clips.string(), sentence);
  }
  return opened;
}

}  // namespace pinchlab::study
