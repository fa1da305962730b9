// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture/layer_seam.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/at.h"
#include "render/picture/cable_path.h"
#include "sim/cable/cable.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;

Vec2 unit_vector(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

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

std::vector<LayeredLink> links_in_layers(const Scene& scene, const World& world, std::size_t c) {
  const CableState& cable = world.cables[c];
  const Cable& whole = scene.cables[c];
  std::vector<LayeredLink> found, other;
  bool at_start = false, at_end = false;
  for (const Link& link : cable.links) {
    const int way = link.layers.way;
    if (way == 0 || link.orientation == 0) continue;
    const Wrap& as_wound = way > 0 ? whole.wraps.front() : whole.wraps.back();
    if (link.orientation == as_wound.orientation) {
      found.push_back({link, full_turn});
      (way > 0 ? at_start : at_end) = true;
    } else {
      other.push_back({link, std::min(link.wrap, full_turn)});
    }
  }
  if (whole.start.layers && !at_start) {
    const int orientation = whole.wraps.front().orientation;
    found.push_back({unwound(world, cable, cable.links.front(), orientation, 1), full_turn});
  }
  if (whole.end.layers && !at_end) {
    const int orientation = whole.wraps.back().orientation;
    found.push_back({unwound(world, cable, cable.links.back(), orientation, -1), full_turn});
  }
  found.insert(found.end(), other.begin(), other.end());
  return found;
}

void append_riser(const World& world, const LayeredLink& layered, double half_width, double rim,
                  const Paint& paint, Picture& picture) {
  const Link& link = layered.link;
  const Layers& layers = link.layers;
  const Vec2& centre = at(world.position, link.body);
  const double inside = at(world.bodies, link.body).radius - 0.75 * rim;
  const double start = from_x_axis(at(world.angle, link.body) + link.orientation * layers.begins);
  const double sense = layers.way * link.orientation;
  const auto place = [&](double turned, double radius) {
    return tangent_point(centre, link.orientation * radius, unit_vector(start + sense * turned));
  };
  constexpr double piece = full_turn / 52, overlap = 0.1;  // of a piece: where two meet, no line
                                                           // is to show
  const auto top = [&](double turned) {                    // the middle of the outline
    return place(turned, layers.radius(turned) - half_width - 0.5 * rim);
  };
  const int pieces = static_cast<int>(std::ceil(layered.riser / piece - 1e-9));
  for (int k = 0; k < pieces; ++k) {
    const double from = piece * k, to = std::min(piece * (k + 1.0 + overlap), layered.riser);
    for (const Vec2& corner : {place(from, inside), place(to, inside), top(to), top(from)}) {
      picture.corners.push_back(corner);
    }
    picture.add(Patch{picture.corners.size() - 4, 4, paint.fill});
  }
  Strip outline;
  outline.first = picture.points.size();
  outline.half_width = 0.5 * rim;
  outline.fill = paint.edge;
  for (int k = 0; k <= pieces; ++k) {
    const double turned = std::min(piece * k, layered.riser);
    picture.points.push_back({top(turned), layers.way * unit_vector(start + sense * turned), 0.0});
  }
  outline.count = picture.points.size() - outline.first;
  picture.add(outline);
  if (layered.riser < full_turn) return;
  const Vec2 end = picture.points.back().position;
  picture.add(Stroke{place(full_turn, inside), end, 0.5 * rim, 0.0, paint.edge, {0, 0, 0, 0}});
}

void append_seam(const World& world, const Link& link, double half_width, double sweep,
                 std::vector<StripPoint>& points) {
  const Layers& layers = link.layers;
  if (layers.way == 0 || link.orientation == 0) return;
  const double covered = sweep - full_turn;  // rad, all but the last turn
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
