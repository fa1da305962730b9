// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/growth.h"

#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

#include "demos/scenes/build.h"
#include "demos/scenes/library.h"

namespace pinchlab::experiments {

namespace {

Configuration awake() {
  Configuration configuration = Method::pinch;
  configuration.sleep = false;
  return configuration;
}

constexpr double disc_spacing = 4.0, disc_radius = 0.2;  // m

/// Discs in a row, each at a height (m) of its own above the line y = 0.
template <class Height>
Scene discs_in_a_row(const char* name, int count, Height height) {
  Scene scene = disconnected_scene(0, 0);
  scene.name = name;
  for (int i = 0; i < count; ++i) {
    Body disc;
    disc.name = "disc " + std::to_string(i);
    disc.radius = disc_radius;
    disc.position = {disc_spacing * i, disc_radius + height(i)};
    scene.bodies.push_back(disc);
  }
  return scene;
}

/// Discs that lie on slabs of their own.
Scene discs_on_walls(int count) {
  Scene scene = discs_in_a_row("discs-on-walls", count, [](int) { return 0.0; });
  constexpr double half_slab = 1.0;
  for (const Body& disc : scene.bodies) {
    Wall slab;
    slab.a = {disc.position.x() - half_slab, 0.0};
    slab.b = {disc.position.x() + half_slab, 0.0};
    scene.walls.push_back(slab);
  }
  return scene;
}

/// Balls that bounce for ever on one floor, from heights that are all different, so that of many
/// some land in every step.
Scene bouncing_balls(int count) {
  constexpr double golden = 0.6180339887498949;
  Scene scene = discs_in_a_row("bouncing-balls", count,
                               [](int i) { return 0.1 + std::fmod(golden * i, 1.0); });
  for (Body& ball : scene.bodies) ball.restitution = 1.0;
  Wall floor;
  floor.a = {-disc_spacing, 0.0};
  floor.b = {disc_spacing * count, 0.0};
  scene.walls.push_back(floor);
  return scene;
}

/// Discs that fall, each on a taut span of its own, from heights that are all different: for a
/// second some land in every step.
Scene discs_on_spans(int count) {
  constexpr double golden = 0.6180339887498949, half_span = 0.5, half_width = 0.02;  // m
  Scene scene = discs_in_a_row("discs-on-spans", count,
                               [](int i) { return 0.1 + 5.0 * std::fmod(golden * i, 1.0); });
  for (int i = 0; i < count; ++i) {
    const double x = disc_spacing * i;
    scene.cables.push_back(
        build::cable(build::at(x - half_span, 0.0), {}, build::at(x + half_span, 0.0), half_width));
    scene.cables.back().name = "span " + std::to_string(i);
  }
  return scene;
}

Scene frictionless_chain(int pulleys) {
  Scene scene = chain_scene(pulleys);
  for (Body& body : scene.bodies) body.cable_friction = 0.0;
  return scene;
}

/// Times one step of a scene that is stepped on.
class Steps {
 public:
  explicit Steps(const Scene& scene) : scene_(scene), world_(make_world(scene, awake())) {}
  void step() {
    if (pinchlab::step(scene_, world_, work_) != StepStatus::ok) {
      throw std::runtime_error(scene_.name + ": " + world_.failure);
    }
  }
  void velocities() { velocities_now(scene_, world_, work_); }

 private:
  Scene scene_;
  World world_;
  Workspace work_;
};

double step_seconds(const Scene& scene, const Effort& effort) {
  Steps steps(scene);
  return measure_call([&steps] { steps.step(); }, effort).seconds.median;
}

/// Of a step, the mean of the same `count` steps from the scene's start at every size: where small
/// scenes were stepped on for longer, what happens in them would be over.
double first_steps_seconds(const Scene& scene, int count, const Effort& effort) {
  constexpr std::size_t fewest = 3;
  std::vector<double> samples;
  for (double sum = 0.0;
       samples.size() < fewest || (sum < effort.seconds && samples.size() < effort.samples);) {
    Steps steps(scene);
    steps.step();  // its storage is not there yet
    const double start = cpu_seconds();
    for (int k = 1; k < count; ++k) steps.step();
    const double used = cpu_seconds() - start;
    samples.push_back(used / (count - 1));
    sum += used;
  }
  return spread(samples).median;
}

double make_seconds(const Scene& scene, const Effort& effort) {
  return measure_call([&scene] { make_world(scene, awake()); }, effort).seconds.median;
}

}  // namespace

const std::vector<GrowingScene>& growing_scenes() {
  static const std::vector<GrowingScene> scenes{
      {"swinging cables, a step",
       {100, 1000, 10000},
       [](int n) { return disconnected_scene(n, n); }},
      {"balls that bounce, each by itself, a step", {100, 1000, 10000}, bouncing_balls, 120},
      {"discs that land on spans of their own, a step", {100, 1000, 10000}, discs_on_spans, 120},
      {"discs on walls of their own, a step", {100, 1000, 10000}, discs_on_walls},
      {"pulleys without friction under one cable, a step",
       {11, 33, 101, 331, 1001},
       frictionless_chain},
      {"swinging cables, `make_world`",
       {100, 1000, 10000},
       [](int n) { return disconnected_scene(n, n); },
       0},
      {"pinched stress scene, `make_world`",
       {20, 200, 2000},
       [](int n) { return stress_scene(n, pinched_spacing); },
       0},
  };
  return scenes;
}

std::vector<GrowthResult> measure_growth(const Effort& effort) {
  std::vector<GrowthResult> results;
  for (const GrowingScene& growing : growing_scenes()) {
    GrowthResult result{growing.what, growing.sizes, {}, 0.0};
    for (const int size : growing.sizes) {
      const Scene scene = growing.scene(size);
      result.seconds.push_back(growing.steps == 0 ? make_seconds(scene, effort)
                               : growing.steps == 1
                                   ? step_seconds(scene, effort)
                                   : first_steps_seconds(scene, growing.steps, effort));
    }
    result.exponent = growth_exponent({result.sizes.begin(), result.sizes.end()}, result.seconds);
    results.push_back(std::move(result));
  }
  return results;
}

IndependenceResult measure_independence(const Effort& effort) {
  const Scene one = swinging_scene(21);
  Scene resting = one;
  for (Body& body : resting.bodies) body.velocity = Vec2::Zero();
  Scene two = resting;
  const int bodies = static_cast<int>(resting.bodies.size());
  for (Body body : resting.bodies) {
    body.name += " of the other";
    body.position.y() -= 100.0;
    two.bodies.push_back(body);
  }
  Cable other = resting.cables.front();
  other.name += " of the other";
  other.start.point.y() -= 100.0;
  other.end.body += bodies;
  for (Wrap& wrap : other.wraps) wrap.body += bodies;
  two.cables.push_back(other);
  Scene beside = resting;
  Body disc;
  disc.name = "disc";
  disc.position = {-1000.0, 0.0};
  beside.bodies.push_back(disc);
  const auto ratio = [&effort](const std::function<void()>& a, const std::function<void()>& b) {
    const BothCosts both = measure_both(a, b, effort);
    return both.first.seconds.median / both.second.seconds.median;
  };
  Steps alone(resting), pair(two), with_disc(beside), moving(one);
  IndependenceResult result;
  result.two_cables = ratio([&] { pair.step(); }, [&] { alone.step(); });
  result.with_a_disc = ratio([&] { with_disc.step(); }, [&] { alone.step(); });
  result.velocities = ratio([&] { moving.velocities(); }, [&] { moving.step(); });
  return result;
}

}  // namespace pinchlab::experiments
