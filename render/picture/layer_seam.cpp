// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture/layer_seam.h"

#include <cmath>
#include <numbers>

#include "render/picture/cable_path.h"
#include "sim/cable/cable.h"
#include "sim/tangent.h"

namespace pinchlab {

void append_seam(const World& world, const Link& link, double half_width, double sweep,
                 std::vector<StripPoint>& points) {
  const Layers& layers = link.layers;
  if (layers.way == 0 || link.orientation == 0) return;
  const double covered = sweep - 2.0 * std::numbers::pi;  // rad, all but the last turn
  if (covered <= 0.0) return;
  const double start = from_x_axis(at(world.angle, link.body) + link.orientation * layers.begins);
  const int pieces = static_cast<int>(std::ceil(covered / most_turn));
  for (int k = 0; k <= pieces; ++k) {
    const double turned = covered * k / pieces, radius = layers.radius(turned) + half_width;
    const double angle = start + layers.way * link.orientation * turned;
    const Vec2 e(std::cos(angle), std::sin(angle));
    const Vec2 tangent = layers.way * e - link.orientation * layers.growth / radius * left(e);
    points.push_back({tangent_point(link_centre(world, link), link.orientation * radius, e),
                      tangent.normalized(), 0.0});
  }
}

}  // namespace pinchlab
