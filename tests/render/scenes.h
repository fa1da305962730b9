// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Scenes and helpers that the rendering tests share.

#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "demos/scenes/build.h"
#include "sim/make_world.h"
#include "tests/base/temporary_folder.h"

namespace pinchlab::testing {

using build::body;

/// Two loads on a cable over a pulley with a fixed axle.
inline Scene atwood() {
  Scene scene;
  scene.name = "atwood";
  scene.bodies = {body("pulley", BodyKind::fixed_axle, {0.0, 0.0}, 0.5),
                  body("left", BodyKind::free, {-0.55, -1.5}, 0.2),
                  body("right", BodyKind::free, {0.55, -1.0}, 0.2)};
  scene.bodies[2].mass = 1.05;
  Cable cable;
  cable.name = "rope";
  cable.start.body = 1;
  cable.wraps = {{0, -1, 0}};
  cable.end.body = 2;
  scene.cables = {cable};
  scene.view = {{-2.0, -3.0}, {2.0, 1.0}};
  return scene;
}

/// A cable between two anchors over a pulley, `slack` m longer than its taut path.
inline Scene hung(double slack) {
  Scene scene;
  scene.name = "hung";
  scene.bodies = {body("pulley", BodyKind::fixed_axle, {0.0, 0.0}, 0.4)};
  Cable cable;
  cable.name = "rope";
  cable.start.point = {-2.0, 0.1};
  cable.wraps = {{0, -1, 0}};
  cable.end.point = {2.0, -0.2};
  cable.slack = slack;
  scene.cables = {cable};
  scene.view = {{-2.5, -2.5}, {2.5, 2.5}};
  return scene;
}

inline std::vector<std::uint8_t> bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace pinchlab::testing
