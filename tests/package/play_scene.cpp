// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a scene file and tells where its bodies are after a second.
#include <cstdio>
#include <exception>

#include "demos/scenes/player.h"

int main(int argc, char** argv) {
  using namespace pinchlab;
  if (argc != 2) return 2;
  try {
    const SceneFile file = read_scene_file(argv[1]);
    Player player(file, file.scene, Method::pinch);
    player.advance_to(file.scene.frames_per_second);
    for (std::size_t i = 0; i < file.scene.bodies.size(); ++i) {
      const Vec2& place = player.world().position[i];
      std::printf("%s %.3f %.3f\n", file.scene.bodies[i].name.c_str(), place.x(), place.y());
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
