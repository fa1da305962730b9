// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture/layer_seam.h"

#include <cmath>
#include <numbers>

#include "base/at.h"
#include "render/picture/cable_path.h"
#include "sim/cable/cable.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// The link that an end's drum would have, of which all has run off.
Link unwound(const World& world, const CableState& cable, const Link& end, int orientation,
             int way) {
  Link link = end;
  const double inner = at(world.bodies, end.body).radius + cable.half_width;
  const Vec2 out = link_centre(world, end) - at(world.position, end.body);
  const double alpha = heading(orientation * left(out.normalized()));
  link.orientation = orientation;
  link.layers = {way, inner, cable.half_width / std::numbers::pi,
                 orientation * (alpha - at(world.angle, end.body))};
  return link;
}

}  // namespace

std::vector<Link> links_in_layers(const Scene& scene, const World& world, std::size_t c) {
  const CableState& cable = world.cables[c];
  std::vector<Link> found;
  bool at_start = false, at_end = false;
  for (const Link& link : cable.links) {
    if (link.layers.way == 0 || link.orientation == 0) continue;
    found.push_back(link);
    (link.layers.way > 0 ? at_start : at_end) = true;
  }
  const Cable& whole = scene.cables[c];
  if (whole.start.layers && !at_start) {
    const int orientation = whole.wraps.front().orientation;
    found.push_back(unwound(world, cable, cable.links.front(), orientation, 1));
  }
  if (whole.end.layers && !at_end) {
    const int orientation = whole.wraps.back().orientation;
    found.push_back(unwound(world, cable, cable.links.back(), orientation, -1));
  }
  return found;
}

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
