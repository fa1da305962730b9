// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/growth.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "analysis/experiments/counted_scenes.h"
#include "analysis/experiments/experiment.h"
#include "base/at.h"
#include "demos/scenes/library.h"

namespace pinchlab::experiments {

namespace {

Configuration awake() {
  Configuration configuration = Method::pinch;
  configuration.sleep = false;
  return configuration;
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
  const World& world() const { return world_; }

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

/// Leaves nothing of what was read before in any cache that one core fills.
class EmptyCaches {
 public:
  void operator()() {
    constexpr std::size_t line = 64;
    for (std::size_t i = 0; i < bytes_.size(); i += line) ++bytes_[i];
  }

 private:
  /// B: three times the 32 MB that eight cores of a server share. What the system tells is no
  /// measure: a virtual machine tells too little, or what all cores of its host have together.
  static constexpr std::size_t size = std::size_t{96} << 20;
  std::vector<unsigned char> bytes_ = std::vector<unsigned char>(size);
};

/// Of a call on a scene that finds its memory in no cache: a step, the mean of the first
/// `growing.steps`, or make_world. The program's code is there, and the processor has seen its
/// branches: the least scene has just done the same. With --quick one in five is timed.
double cold_seconds(const GrowingScene& growing, int size, EmptyCaches& empty_caches,
                    const Effort& effort) {
  const Scene scene = growing.scene(size), least = growing.scene(growing.sizes.front());
  const auto timed = [&](const auto& before, const auto& call) {
    empty_caches();
    before();
    const double start = cpu_seconds();
    call();
    return cpu_seconds() - start;
  };
  std::vector<double> samples;
  const std::size_t apart = effort.samples < Effort().samples ? 5 : 1, count = 15 / apart;
  if (growing.steps == 0) {
    while (samples.size() < count) {
      samples.push_back(timed([&least] { make_world(least, awake()); },
                              [&scene] { make_world(scene, awake()); }));
    }
    return spread(samples).median;
  }
  Steps steps(scene), before(least);
  steps.step();  // its storage is not there yet
  const bool differ = growing.steps > 1;
  const std::size_t first = differ ? index(growing.steps - 1) : count;
  for (std::size_t k = 0; k < first; ++k) {
    if (differ && k % apart > 0) {
      before.step();
      steps.step();
    } else {
      samples.push_back(timed([&before] { before.step(); }, [&steps] { steps.step(); }));
    }
  }
  if (!differ) return spread(samples).median;
  return std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
}

double make_seconds(const Scene& scene, const Effort& effort) {
  return measure_call([&scene] { make_world(scene, awake()); }, effort).seconds.median;
}

double copy_seconds(const Scene& scene, bool over_old, const Effort& effort) {
  Steps steps(scene);
  steps.step();
  World copy = steps.world();
  const auto copy_over = [&] { copy = steps.world(); };
  std::optional<World> made;
  const auto copy_anew = [&] { made.emplace(steps.world()); };
  return (over_old ? measure_call(copy_over, effort) : measure_call(copy_anew, effort))
      .seconds.median;
}

}  // namespace

double GrowthResult::exponent_of(const std::vector<double>& of) const {
  return growth_exponent({sizes.begin(), sizes.end()}, of);
}

double GrowthResult::left_by(double most) const {
  const double times = static_cast<double>(sizes.back()) / sizes.front();
  return seconds.front() / sizes.front() * (std::pow(times, most - 1.0) - 1.0);
}

double GrowthResult::taken_by_copy() const {
  return copy_seconds.back() / sizes.back() - copy_seconds.front() / sizes.front();
}

std::vector<GrowthResult> measure_growth(const Effort& effort) {
  // Rough processor time of a size: where steps differ many are taken.
  const auto expected_work = [](const GrowingScene& growing) {
    return growing.steps > 1 ? 4.0 : 1.0;
  };
  double work = 0.0;
  for (const GrowingScene& growing : growing_scenes()) {
    work += expected_work(growing) * static_cast<double>(growing.sizes.size());
  }
  Progress progress("stress, many things that share nothing", work);
  EmptyCaches empty_caches;
  std::vector<GrowthResult> results;
  for (const GrowingScene& growing : growing_scenes()) {
    GrowthResult result{growing.what, growing.sizes, {}, {}, {}};
    for (const int size : growing.sizes) {
      const Scene scene = growing.scene(size);
      result.seconds.push_back(growing.steps == 0 ? make_seconds(scene, effort)
                               : growing.steps == 1
                                   ? step_seconds(scene, effort)
                                   : first_steps_seconds(scene, growing.steps, effort));
      result.cold_seconds.push_back(cold_seconds(growing, size, empty_caches, effort));
      result.copy_seconds.push_back(copy_seconds(scene, growing.steps > 0, effort));
      progress.done(expected_work(growing));
    }
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
