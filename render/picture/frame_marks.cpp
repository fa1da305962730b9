// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture/frame_marks.h"

#include <fmt/format.h>

#include <algorithm>

namespace pinchlab {

namespace {

/// What a frame shows: the view is fitted into it, with room at two sides.
View frame_of(const View& view, double aspect) {
  const Vec2 middle = 0.5 * (view.low + view.high), size = 0.5 * (view.high - view.low);
  const Vec2 half(std::max(size.x(), aspect * size.y()), std::max(size.y(), size.x() / aspect));
  return {middle - half, middle + half};
}

}  // namespace

Stroke divider(const Scenery& scenery, double width, double height) {
  const View frame = frame_of(scenery.view, width / height);
  const Colour colour = scenery.theme.support;
  const double pixel = (frame.high.x() - frame.low.x()) / width;
  const double half_width = std::max(2.0 * scenery.line(), pixel);  // half of it is seen
  return {frame.low, {frame.low.x(), frame.high.y()}, half_width, 0.0, colour, colour};
}

Label time_label(const Scenery& scenery, double time, double aspect) {
  const View frame = frame_of(scenery.view, aspect);
  const double text = scenery.text();
  const Vec2 corner(frame.low.x(), frame.high.y());
  return {corner + text * Vec2(2.6, -1.2), text, fmt::format("{:6.3f} s", time), scenery.theme.ink};
}

}  // namespace pinchlab
