// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A scene under one method, frame by frame: frame i is step i * steps_per_frame, frame 0 the start.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "demos/scenes/scene_json.h"
#include "sim/promises.h"
#include "sim/step.h"

namespace pinchlab {

/// Throws std::invalid_argument where `timing` has an error above 0 and none of the methods divides
/// its steps for one.
void check_error_is_heeded(const Timing& timing, std::span<const Configuration> methods);

/// What is told of a world that became not finite on the way to `frame` of the scene from `path`:
/// where and when, and the command that shows it again, once cables have these nodes.
std::string failure_report(const std::filesystem::path& path, const Scene& scene,
                           const World& world, int frame, std::span<const ChosenNodes> nodes = {});
/// How to keep nodes that were chosen while steps change; "" where there are none.
std::string words_to_keep(std::span<const ChosenNodes> nodes);

/// Writes what Player::broken_promises says of a file to standard error, and a line on what helps;
/// nothing where there is nothing.
void tell_broken_promises(const std::string& file, const std::vector<std::string>& lines);
/// What people call a way of simulating: "pinch joints", "cable joints".
const char* in_words(const Configuration& configuration);

/// What --time-limit ends with. It is no fault of the simulation, so that who reports those of
/// several methods lets it pass.
struct GivenUp : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What, called after each step of a simulation of `file`, throws GivenUp once its steps have taken
/// more than `seconds`, from now on or from another simulation's first step; without `seconds`
/// nothing. The message says that it was `meanwhile`.
std::function<void(const World&)> time_limit(const SceneFile& file, std::optional<double> seconds,
                                             const std::string& meanwhile = "");

/// The same over all simulations of a command together, from now on, in any order. `cure` is what
/// makes them faster.
std::function<void(const World&)> time_limit_of_all(const SceneFile& file,
                                                    std::optional<double> seconds,
                                                    const std::string& cure);

/// The same for the rehearsal of set_scenery.
inline std::function<void(const World&)> rehearsal_limit(const SceneFile& file,
                                                         std::optional<double> seconds) {
  return time_limit(file, seconds, "while placing labels and fitting the view: ");
}

class Player {
 public:
  /// `file` must outlive the player. Throws SceneFileError where the geometry cannot exist.
  Player(const SceneFile& file, const Scene& scene, const Configuration& configuration);

  /// Called after every step.
  void on_step(std::function<void()> call) { on_step_ = std::move(call); }
  /// Lets advance_to throw GivenUp at the first step that ends after `seconds` from now.
  void give_up_after(std::optional<double> seconds);

  /// Steps on to `frame`, which must not lie before the present one. Throws std::runtime_error with
  /// a failure_report if a value is not finite.
  void advance_to(int frame);
  /// The same for a step, which may lie between two frames.
  void advance_to_step(std::int64_t step);

  /// What the simulation has not kept so far of what sim/README.md promises, one line each with the
  /// method; none is good.
  std::vector<std::string> broken_promises() const;

  /// The frame that shows the present step, or the last one before it.
  int frame() const { return static_cast<int>(step_ / scene_.steps_per_frame); }
  /// s; free of the round-off of summing steps.
  double time() const {
    return static_cast<double>(step_) /
           static_cast<double>(std::int64_t{scene_.frames_per_second} * scene_.steps_per_frame);
  }
  const Scene& scene() const { return scene_; }
  const World& world() const { return world_; }
  /// At the time of the frame.
  Velocities velocities() const { return velocities_now(scene_, world_, work_); }

 private:
  const SceneFile& file_;
  Scene scene_;
  World world_;
  mutable Workspace work_;  // changes no result
  Promises promises_;
  std::int64_t step_ = 0;
  std::function<void()> on_step_;
  std::function<void(const World&)> check_time_;
};

}  // namespace pinchlab
