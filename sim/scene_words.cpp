// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene_words.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/at.h"

namespace pinchlab {

double overlap_allowed(const Scene& scene) {
  // Places that are worked out, and written with ten digits, touch to within this.
  constexpr double share = 1e-9;
  double size = 0.0;
  const auto include = [&size](const Vec2& x) { size = std::max(size, x.cwiseAbs().maxCoeff()); };
  for (const Body& body : scene.bodies) {
    include(body.position);
    size = std::max(size, body.radius);
  }
  for (const Cable& cable : scene.cables) {
    if (cable.closed) continue;
    include(cable.start.point);
    include(cable.end.point);
  }
  for (const Wall& wall : scene.walls) {
    include(wall.a);
    include(wall.b);
  }
  return share * size;
}

std::string in_mm(double metres) {
  return fmt::format("{:.3g} mm", 1000.0 * metres);
}

std::string pointer(const char* list, std::size_t i) {
  return fmt::format("/{}/{}", list, i);
}

std::string name_of_body(const Scene& scene, int body) {
  return body < 0 ? "the world" : "body '" + at(scene.bodies, body).name + "'";
}

}  // namespace pinchlab
