// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/fineness.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "base/progress.h"

namespace pinchlab {
namespace {

constexpr int most_fine = 8;  // a factor; with it 16 times the scene's steps are simulated

/// The furthest that a point of a body is from where it is in the other (m).
double largest_distance(const Player& one, const Player& other) {
  const World &a = one.world(), &b = other.world();
  double most = 0.0;
  for (std::size_t i = 0; i < one.scene().bodies.size(); ++i) {
    const double turned = std::min(std::abs(a.angle[i] - b.angle[i]), std::numbers::pi);
    const double rim = 2.0 * a.bodies[i].radius * std::sin(0.5 * turned);
    most = std::max(most, (a.position[i] - b.position[i]).norm() + rim);
  }
  return most;
}

}  // namespace

Scene made_finer(const Scene& scene, int factor) {
  Scene finer = scene;
  finer.steps_per_frame *= factor;
  finer.error /= std::pow(factor, 3);
  return finer;
}

Fineness find_fineness(const SceneFile& file, const Scene& scene,
                       const Configuration& configuration, int last,
                       std::optional<double> time_limit,
                       const std::function<void(int steps_per_frame, int frame)>& measured) {
  Fineness found{1, scene.steps_per_frame, scene.error, std::nullopt};
  if (!(scene.error > 0.0) || !locates_events(configuration)) return found;
  for (;; found.factor *= 2) {
    Player player(file, made_finer(scene, found.factor), configuration);
    Player finer(file, made_finer(scene, 2 * found.factor), configuration);
    found.steps_per_frame = player.scene().steps_per_frame;
    player.give_up_after(time_limit);
    finer.give_up_after(time_limit);
    double believed = 0.0;
    for (int frame = 1; frame <= last; ++frame) {
      player.advance_to(frame);
      finer.advance_to(frame);
      believed = std::max(believed, 2.0 * largest_distance(player, finer));
      if (believed > scene.error && found.factor < most_fine) break;
      if (measured) measured(found.steps_per_frame, frame);
    }
    if (believed <= scene.error || found.factor == most_fine) {
      found.believed = believed;
      return found;
    }
  }
}

Fineness find_fineness_aloud(const SceneFile& file, const Scene& scene,
                             const Configuration& configuration, int last,
                             std::optional<double> time_limit, const std::string& who) {
  std::optional<Progress> progress;
  return find_fineness(
      file, scene, configuration, last, time_limit, [&](int steps_per_frame, int frame) {
        if (frame == 1) {
          progress.emplace(
              fmt::format("measuring the error of {} with {} steps a frame", who, steps_per_frame),
              "frames", last);
        }
        progress->add(1);
      });
}

void tell_fineness(const std::string& file, const Fineness& fineness) {
  if (!fineness.believed) return;
  fmt::print(stderr,
             "{}: bodies are believed within {:.1e} m of their exact places ({:g} m asked), with "
             "{} steps a frame\n",
             file, *fineness.believed, fineness.asked, fineness.steps_per_frame);
}

void add_missed_error(const Fineness& fineness, const Configuration& configuration,
                      std::vector<std::string>& broken_promises) {
  if (fineness.believed.value_or(0.0) <= fineness.asked) return;
  broken_promises.push_back(fmt::format(
      "method {}: bodies may be {:.1e} m from their exact places, more than the error of {:g} m "
      "asked for, with {} steps a frame, the most that were tried",
      to_string(configuration), *fineness.believed, fineness.asked, fineness.steps_per_frame));
}

}  // namespace pinchlab
