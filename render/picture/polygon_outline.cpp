// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture/polygon_outline.h"

namespace pinchlab {

Vec2 PolygonOutline::corner(std::size_t k, double inset) const {
  const std::size_t count = body_.corners.size();
  const Vec2& here = body_.corners[k % count];
  const Vec2 before = (here - body_.corners[(k + count - 1) % count]).normalized();
  const Vec2 after = (body_.corners[(k + 1) % count] - here).normalized();
  const Vec2 inwards = (left(before) + left(after)) / (1.0 + before.dot(after));
  return position_ + turned(here + inset * inwards, angle_);
}

}  // namespace pinchlab
