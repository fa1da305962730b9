// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The scenes whose instructions are counted, and those whose cost is followed as they grow; what
// runs them under valgrind (count_main.cpp) needs nothing but these and the simulator.

#include <span>
#include <vector>

#include "sim/scene.h"

namespace pinchlab::experiments {

struct CountedScene {
  const char* name;
  const char* configuration;
  int segments;
  Scene (*scene)();
};
std::span<const CountedScene> counted_scenes();

/// One kind of scene at several sizes, two decades apart: what a step costs, or making the world.
struct GrowingScene {
  const char* what;
  std::vector<int> sizes;
  Scene (*scene)(int size);
  int steps = 1;  // timed at once from the start, where what happens differs from step to step;
                  // 0: its make_world
};

/// Swinging cables, balls that bounce, discs that land on spans, discs on walls, pulleys without
/// friction under one cable, hanging cables whose nodes adapt, and make_world of swinging cables,
/// of those, and of the pinched stress scene.
const std::vector<GrowingScene>& growing_scenes();

/// `steps` steps of a scene of counted_scenes. False where there is none of that number.
bool step_scene(int number, int steps);

/// Likewise of growing_scenes, at a size: `calls` steps, or as many times make_world.
bool step_growing_scene(int number, int size, int calls);

}  // namespace pinchlab::experiments
