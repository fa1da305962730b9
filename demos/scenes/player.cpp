// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/player.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace pinchlab {
void check_error_is_heeded(const Timing& timing, std::span<const Configuration> methods) {
  if (timing.error.value_or(0.0) == 0.0 || std::ranges::any_of(methods, locates_events)) return;
  std::set<std::string> names;
  for (const Configuration& method : methods) names.insert(to_string(method));
  throw std::invalid_argument(
      fmt::format("--error: steps of the method {} are not divided; leave it out, or use pinch or "
                  "pinch_no_contact",
                  fmt::join(names, " and ")));
}

std::string words_to_keep(std::span<const ChosenNodes> nodes) {
  std::string text;
  for (const ChosenNodes& chosen : nodes) {
    text += fmt::format("{}{} to cable \"{}\"", text.empty() ? "give \"nodes\": " : ", ",
                        chosen.nodes, chosen.cable);
  }
  return text.empty() ? "" : text + ", since more steps give more nodes";
}

std::string failure_report(const std::filesystem::path& path, const Scene& scene,
                           const World& world, int frame, std::span<const ChosenNodes> nodes) {
  const Configuration& configuration = world.configuration;
  const std::string sweeps =
      configuration.solver == Solver::iterative &&
              configuration.iterations != thesis_configuration().iterations
          ? fmt::format(" (but with {} sweeps, which only a table of `sweep` can ask for)",
                        configuration.iterations)
          : "";
  return fmt::format(
      "{0}: method {1}: {2}; to see it again: pinchlab simulate {0} --method {1} --fps {3} "
      "--steps-per-frame {4}{5} --until {6} --out -{7}{8}",
      path.string(), to_string(world.configuration), world.failure, scene.frames_per_second,
      scene.steps_per_frame,
      locates_events(configuration) ? fmt::format(" --error {}", scene.error) : "",
      static_cast<double>(frame) / scene.frames_per_second, sweeps,
      nodes.empty() ? "" : "; before that, " + words_to_keep(nodes));
}

void tell_broken_promises(const std::string& file, const std::vector<std::string>& lines) {
  for (const std::string& line : lines) fmt::print(stderr, "{}: note: {}\n", file, line);
  if (lines.empty()) return;
  const bool steps_help = std::ranges::any_of(
      lines, [](const std::string& line) { return line.find(nodes_cure) == std::string::npos; });
  fmt::print(stderr, "{}: note: sim/README.md says what is promised and where the limits are{}\n",
             file, steps_help ? "; more steps a frame often help" : "");
}

const char* in_words(const Configuration& configuration) {
  if (to_string(configuration) == std::string_view("thesis")) return "the thesis' pinch joints";
  switch (configuration.method) {
    case Method::pinch:
      return "pinch joints";
    case Method::pinch_no_contact:
      return "pinch joints, no contact";
    case Method::cable:
      return "cable joints";
  }
  return "unknown";
}

Player::Player(const SceneFile& file, const Scene& scene, const Configuration& configuration)
    : file_(file),
      scene_(scene),
      world_(start_world(scene, file.path, configuration)),
      promises_(scene_, world_) {}

namespace {

using std::chrono::steady_clock;

/// Throws GivenUp if that is more than `limit` (s) after `start`.
void check_time(const World& world, steady_clock::time_point now, steady_clock::time_point start,
                double limit, const std::string& place, const std::string& cure) {
  if (std::chrono::duration<double>(now - start).count() <= limit) return;
  throw GivenUp(fmt::format(
      "{}method {}: given up at t = {:.6g} s, step {}, after the {} s of --time-limit; {}", place,
      to_string(world.configuration), world.time(), world.step, limit, cure));
}

}  // namespace

std::function<void(const World&)> time_limit(const SceneFile& file, std::optional<double> seconds,
                                             const std::string& meanwhile) {
  if (!seconds) return [](const World&) {};
  return [place = file.path.string() + ": " + meanwhile, limit = *seconds,
          start = steady_clock::now(), known = false](const World& world) mutable {
    const auto now = steady_clock::now();
    if (std::exchange(known, true) && world.step == 1) start = now;
    check_time(world, now, start, limit, place, "fewer steps a frame or fewer bodies are faster");
  };
}

std::function<void(const World&)> time_limit_of_all(const SceneFile& file,
                                                    std::optional<double> seconds,
                                                    const std::string& cure) {
  if (!seconds) return [](const World&) {};
  return [place = file.path.string() + ": ", limit = *seconds, start = steady_clock::now(),
          cure](const World& world) {
    check_time(world, steady_clock::now(), start, limit, place, cure);
  };
}

void Player::give_up_after(std::optional<double> seconds) {
  check_time_ = time_limit(file_, seconds);
}

void Player::advance_to(int frame) {
  advance_to_step(std::int64_t{frame} * scene_.steps_per_frame);
}

void Player::advance_to_step(std::int64_t wanted) {
  for (; step_ < wanted; ++step_) {
    if (step(scene_, world_, work_) != StepStatus::ok) {
      const bool finer = scene_.steps_per_frame != file_.scene.steps_per_frame;
      throw std::runtime_error(
          failure_report(file_.path, scene_, world_, frame() + 1,
                         finer ? std::span(file_.chosen_nodes) : std::span<const ChosenNodes>()));
    }
    promises_.note(scene_, world_);
    if (on_step_) on_step_();
    if (check_time_) check_time_(world_);
  }
}

std::vector<std::string> Player::broken_promises() const {
  std::vector<std::string> lines = promises_.broken(scene_, world_);
  for (std::string& line : lines) {
    line = fmt::format("method {}: {}", to_string(world_.configuration), line);
  }
  return lines;
}

}  // namespace pinchlab
