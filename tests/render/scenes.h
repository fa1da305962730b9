// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Scenes and helpers that the rendering tests share.

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "sim/scene.h"

namespace pinchlab::testing {

inline Body body(const std::string& name, BodyKind kind, Vec2 position, double radius) {
  Body b;
  b.name = name;
  b.kind = kind;
  b.position = position;
  b.radius = radius;
  return b;
}

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

/// An empty folder that is removed at the end of the test.
struct Folder {
  std::filesystem::path path;
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "pinchlab-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make " + name);
    path = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string file(const std::string& name) const { return (path / name).string(); }
  bool empty() const { return std::filesystem::is_empty(path); }
};

inline std::vector<std::uint8_t> bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// The message of the exception of type Error that `act` throws; empty if it throws none.
template <typename Error, typename Act>
std::string message_of(Act act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace pinchlab::testing
