// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/legibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "render/mesh.h"
#include "render/text.h"

namespace pinchlab {

namespace {

/// Empty, or that no body is in pictures of this size (px), by `scale` (px/m), at the start.
std::string nothing_in_view(const Scene& scene, const View& view, double scale, int width,
                            int height) {
  const Vec2 middle = 0.5 * (view.low + view.high), half = 0.5 / scale * Vec2(width, height);
  const auto is_in_view = [&](const Body& body) {
    const Vec2 off = (body.position - middle).cwiseAbs() - half;
    return off.maxCoeff() < body.radius;
  };
  if (scene.bodies.empty() || std::ranges::any_of(scene.bodies, is_in_view)) return "";
  return fmt::format(
      "no body is in the picture at the start, which shows x from {:.3g} to {:.3g} m and y from "
      "{:.3g} to {:.3g} m; give another \"view\", or \"fit\"",
      middle.x() - half.x(), middle.x() + half.x(), middle.y() - half.y(), middle.y() + half.y());
}

}  // namespace

std::vector<std::string> hard_to_see(const Scene& scene, const Scenery& scenery, int width,
                                     int height) {
  std::vector<std::string> lines;
  const double scale = Fit(scenery.view, 0, width, height).scale;  // px/m
  if (const std::string line = nothing_in_view(scene, scenery.view, scale, width, height);
      !line.empty()) {
    lines.push_back(line);
  }
  for (const Cable& cable : scene.cables) {
    const double wide = 2.0 * scale * cable.half_width;
    if (cable.joint != Joint::none || wide >= 0.5) continue;
    lines.push_back(
        fmt::format("cable \"{}\" is {:.2g} px wide and can hardly be seen; take a larger --size, "
                    "a smaller view or a greater half_width_m",
                    cable.name, wide));
  }
  const Font font;
  for (const SceneryLabel& label : scenery.labels) {
    const std::string lacking = font.lacking(label.text);
    if (lacking.empty()) continue;
    lines.push_back(
        fmt::format("label \"{}\": the font lacks {}, and shows a box; write something else, or "
                    "let PINCHLAB_FONT name a font that has it",
                    label.text, lacking));
  }
  return lines;
}

void tell_hard_to_see(const std::string& file, const std::vector<std::string>& lines) {
  for (const std::string& line : lines) fmt::print(stderr, "{}: note: {}\n", file, line);
}

}  // namespace pinchlab
