// SPDX-License-Identifier: GPL-3.0-or-later
// Two loads on a cable over a pulley: the heavier one falls.
#include <cstdio>

#include "sim/step.h"

int main() {
  using namespace pinchlab;
  Scene scene;
  scene.bodies.resize(3);
  Body &pulley = scene.bodies[0], &light = scene.bodies[1], &heavy = scene.bodies[2];
  pulley.kind = BodyKind::fixed_axle;
  light.position = {-0.55, -4.0};  // m: the cable hangs straight down from the rim
  heavy.position = {0.55, -2.0};
  light.radius = heavy.radius = 0.2;
  heavy.mass = 3.0;  // kg; the others have 1
  Cable cable;
  cable.start.body = 1;
  cable.wraps = {{.body = 0, .orientation = -1}};
  cable.end.body = 2;
  scene.cables = {cable};

  World world = make_world(scene, Method::pinch);
  Workspace work;
  for (int i = 0; i < 240; ++i) {  // one second
    if (step(scene, world, work) != StepStatus::ok) return 1;
  }
  std::printf("%.3f m after 1 s\n", heavy.position.y() - world.position[2].y());
}
