// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/theme.h"

#include <utility>

#include "base/read_file.h"
#include "base/sha256.h"
#include "base/strict_json.h"
#include "demos/scenes/format_check.h"
#include "demos/scenes/scene_format.h"
#include "demos/scenes/scene_json.h"

namespace pinchlab {

ThemeFile read_theme_file(const std::filesystem::path& path) {
  ThemeFile file;
  file.name = path.stem().string();
  std::vector<SceneProblem> problems;
  nlohmann::json value;
  const std::string text = read_whole(path, max_scene_bytes);
  file.sha256 = sha256(text);
  try {
    value = parse_strict_json(text);
    check_format(value, theme_format(), "", problems);
  } catch (const JsonError& error) {
    problems.push_back({error.place, error.what()});
  }
  if (!problems.empty()) throw SceneFileError(path.string(), std::move(problems));

  Theme& theme = file.theme;
  const std::pair<const char*, Colour*> colours[] = {{"background", &theme.background},
                                                     {"ink", &theme.ink},
                                                     {"rail", &theme.rail},
                                                     {"support", &theme.support},
                                                     {"cable", &theme.cable.fill},
                                                     {"cable_edge", &theme.cable.edge},
                                                     {"cable_mark", &theme.cable_mark},
                                                     {"body", &theme.body.fill},
                                                     {"body_edge", &theme.body.edge},
                                                     {"driven", &theme.driven.fill},
                                                     {"driven_edge", &theme.driven.edge},
                                                     {"fixed", &theme.fixed.fill},
                                                     {"fixed_edge", &theme.fixed.edge},
                                                     {"shadow", &theme.shadow}};
  for (const auto& [key, colour] : colours) {
    if (value.contains(key)) *colour = *colour_from(value[key].get<std::string>());
  }
  theme.line_width = value.value("line_width", theme.line_width);
  theme.text_height = value.value("text_height", theme.text_height);
  return file;
}

}  // namespace pinchlab
