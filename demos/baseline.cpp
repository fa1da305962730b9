// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/baseline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <tuple>
#include <utility>

#include "base/at.h"
#include "base/progress.h"
#include "demos/scenes/fineness.h"

namespace pinchlab {
namespace {

/// A method's motion, frame by frame.
struct Motion {
  std::vector<std::vector<Vec2>> position;
  std::vector<std::vector<double>> angle;
  std::vector<std::vector<char>> at_wall;  // whether a body touches a wall
};

/// What clips show. A simulation that fails is told by the one that follows.
Scene as_fine_as_asked(const SceneFile& file, const Scene& scene, Method method,
                       std::optional<double> time_limit, const std::string& who) {
  try {
    const int last = scene.frame_count - 1;
    const Fineness fineness = find_fineness_aloud(file, scene, method, last, time_limit, who);
    return made_finer(scene, fineness.factor);
  } catch (const GivenUp&) {
    throw;
  } catch (const std::runtime_error&) {
    return scene;
  }
}

Motion play(const SceneFile& file, const Scene& scene, std::optional<double> time_limit,
            MethodFigures& figures) {
  const std::string who = fmt::format("{}, {}", scene.name, to_string(figures.method));
  Motion motion;
  Player player(file, as_fine_as_asked(file, scene, figures.method, time_limit, who),
                figures.method);
  player.give_up_after(time_limit);
  Progress progress("simulating " + who, "steps",
                    std::int64_t{scene.frame_count - 1} * player.scene().steps_per_frame);
  player.on_step([&progress] { progress.add(1); });
  try {
    for (int frame = 0; frame < scene.frame_count; ++frame) {
      player.advance_to(frame);
      const World& world = player.world();
      motion.position.push_back(world.position);
      motion.angle.push_back(world.angle);
      motion.at_wall.emplace_back(world.position.size(), 0);
      for (const Contact& contact : world.contacts) {
        if (contact.wall < 0 || !contact.touching) continue;
        at(motion.at_wall.back(), contact.a) = 1;
      }
    }
  } catch (const GivenUp&) {
    throw;
  } catch (const std::runtime_error& error) {
    figures.problems.emplace_back(error.what());
  }
  const std::string prefix = fmt::format("method {}: ", to_string(figures.method));
  for (const std::string& broken : player.broken_promises()) {
    figures.problems.push_back(broken.starts_with(prefix) ? broken.substr(prefix.size()) : broken);
  }
  return motion;
}

double roughness(const Motion& motion) {
  double sum = 0.0;
  for (std::size_t i = 3; i < motion.position.size(); ++i) {
    double largest = 0.0;
    for (std::size_t b = 0; b < motion.position[i].size(); ++b) {
      bool knocked = false;
      for (std::size_t k = i - 3; k <= i; ++k) knocked = knocked || motion.at_wall[k][b] != 0;
      if (knocked) continue;
      const auto at = [&](std::size_t k) { return motion.position[k][b]; };
      const Vec2 third = at(i) - 3.0 * at(i - 1) + 3.0 * at(i - 2) - at(i - 3);
      largest = std::max(largest, third.norm());
    }
    sum += largest;
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, motion.position.size()));
}

// How far any body's centre is ever apart in the two, m, and how far it is turned, rad.
std::pair<double, double> apart(const Motion& one, const Motion& other) {
  double distance = 0.0, turn = 0.0;
  const std::size_t frames = std::min(one.position.size(), other.position.size());
  for (std::size_t i = 0; i < frames; ++i) {
    for (std::size_t b = 0; b < one.position[i].size(); ++b) {
      distance = std::max(distance, (one.position[i][b] - other.position[i][b]).norm());
      turn = std::max(turn, std::abs(one.angle[i][b] - other.angle[i][b]));
    }
  }
  return {distance, turn};
}

// Steps of plain cable joints are not divided for a scene's error_m. What half a step changes, m,
// tells whether they keep it all the same.
double changed_by_half_steps(const SceneFile& file, const Motion& motion,
                             std::optional<double> time_limit) {
  Timing finer;
  finer.steps_per_frame = 2 * file.scene.steps_per_frame;
  MethodFigures figures;
  figures.method = Method::cable;
  return apart(motion, play(file, with_timing(file.scene, finer), time_limit, figures)).first;
}

void decide(const Scene& scene, BaselineAdvice& advice) {
  const double ratio = advice.cable.roughness / advice.no_contact.roughness;
  if (advice.cable.problems.size() > advice.no_contact.problems.size()) {
    advice.recommended = Method::pinch_no_contact;
    advice.reason = "Plain cable joints break here: " + advice.cable.problems.front() + ".";
  } else if (ratio > fair_roughness) {
    advice.recommended = Method::pinch_no_contact;
    advice.reason = fmt::format(
        "Plain cable joints jitter here: {:.1f} times as rough as pinch joints without contact, "
        "under which bodies come equally close.",
        ratio);
  } else if (advice.changed_by_half_steps > scene.error) {
    advice.recommended = Method::pinch_no_contact;
    advice.reason = fmt::format(
        "Plain cable joints do not keep the scene's error_m here: steps half as long move bodies "
        "by {:.2g} m, so that the pair would differ by its steps, too.",
        advice.changed_by_half_steps);
  } else {
    advice.recommended = Method::cable;
    advice.reason =
        "Plain cable joints work here: they break nothing and move as smoothly as pinch joints "
        "without contact.";
  }
}

}  // namespace

BaselineAdvice advise_baseline(const SceneFile& file, std::optional<double> time_limit) {
  BaselineAdvice advice;
  advice.no_contact.method = Method::pinch_no_contact;
  advice.cable.method = Method::cable;
  const Motion pinch = play(file, file.scene, time_limit, advice.pinch);
  for (MethodFigures* figures : {&advice.pinch, &advice.no_contact, &advice.cable}) {
    const Motion motion =
        figures == &advice.pinch ? pinch : play(file, file.scene, time_limit, *figures);
    figures->roughness = roughness(motion);
    std::tie(figures->largest_distance, figures->largest_turn) = apart(pinch, motion);
    if (figures == &advice.cable && file.scene.error > 0.0) {
      advice.changed_by_half_steps = changed_by_half_steps(file, motion, time_limit);
    }
  }
  decide(file.scene, advice);
  return advice;
}

std::string text(const SceneFile& file, const BaselineAdvice& advice) {
  std::string out = fmt::format("{:<18}{:>20}{:>24}{:>20}\n", "method", "roughness (mm)",
                                "from pinch joints (mm)", "turned (degrees)");
  for (const MethodFigures* figures : {&advice.pinch, &advice.no_contact, &advice.cable}) {
    out += fmt::format("{:<18}{:>20.3g}{:>24.3g}{:>20.3g}\n", to_string(figures->method),
                       1e3 * figures->roughness, 1e3 * figures->largest_distance,
                       figures->largest_turn * 180.0 / std::numbers::pi);
  }
  for (const MethodFigures* figures : {&advice.pinch, &advice.no_contact, &advice.cable}) {
    for (const std::string& problem : figures->problems) {
      out += fmt::format("{}: {}\n", to_string(figures->method), problem);
    }
  }
  const nlohmann::ordered_json baseline = {{"method", to_string(advice.recommended)},
                                           {"reason", advice.reason}};
  out += fmt::format("\nRecommended: {}. {}\n", to_string(advice.recommended), advice.reason);
  out += file.scene.baseline == advice.recommended
             ? "The scene has it already.\n"
             : fmt::format("In the scene: \"baseline\": {}\n", baseline.dump());
  return out;
}

}  // namespace pinchlab
