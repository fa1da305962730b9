// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/step_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace pinchlab::experiments {

namespace {

constexpr std::size_t fewest_samples = 5;
constexpr double batch_s = 1e-3;  // thousands of times what reading a clock takes

void must_be_finite(StepStatus status, const Scene& scene, const World& world) {
  if (status != StepStatus::ok) throw std::runtime_error(scene.name + ": " + world.failure);
}

double timed(const std::function<void()>& run, std::int64_t calls) {
  const double start = cpu_seconds();
  for (std::int64_t i = 0; i < calls; ++i) run();
  return (cpu_seconds() - start) / static_cast<double>(calls);
}

/// Calls that take about batch_s together. The first ones warm up caches and storage.
std::int64_t batch_size(const std::function<void()>& run) {
  std::int64_t calls = 1;
  for (;;) {
    const double each = timed(run, calls);
    const double all = each * static_cast<double>(calls);
    if (all >= 0.5 * batch_s) return std::max<std::int64_t>(1, std::llround(batch_s / each));
    calls *= 2;
  }
}

bool is_enough(const Effort& effort, std::size_t samples, double start_s) {
  return samples >= effort.samples ||
         (samples >= fewest_samples && cpu_seconds() - start_s >= effort.seconds);
}

/// What one lap of step's stopwatch takes, s.
double lap_seconds() {
  using Clock = std::chrono::steady_clock;
  constexpr int laps = 20000;
  double least = infinity;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const Clock::time_point start = Clock::now();
    Clock::time_point last = start;
    for (int i = 0; i < laps; ++i) last = Clock::now();
    least = std::min(least, std::chrono::duration<double>(last - start).count() / laps);
  }
  return least;
}

}  // namespace

Effort effort_of(const Options& options) {
  return options.quick ? Effort{0.15, 40} : Effort{};
}

void step_or_throw(const Scene& scene, World& world, Workspace& work) {
  must_be_finite(step(scene, world, work), scene, world);
}

CallCost measure_call(const std::function<void()>& run, const Effort& effort) {
  const std::int64_t batch = batch_size(run);
  std::vector<double> samples;
  for (const double start = cpu_seconds(); !is_enough(effort, samples.size(), start);) {
    samples.push_back(timed(run, batch));
  }
  return {spread(samples), batch * static_cast<std::int64_t>(samples.size())};
}

BothCosts measure_both(const std::function<void()>& first, const std::function<void()>& second,
                       const Effort& effort) {
  const std::int64_t batch_first = batch_size(first), batch_second = batch_size(second);
  BothCosts both;
  std::vector<double> a, b;
  for (const double start = cpu_seconds(); !is_enough(effort, a.size(), start);) {
    const bool swapped = a.size() % 2 == 1;
    if (swapped) b.push_back(timed(second, batch_second));
    a.push_back(timed(first, batch_first));
    if (!swapped) b.push_back(timed(second, batch_second));
    both.differences.push_back(a.back() - b.back());
  }
  const auto samples = static_cast<std::int64_t>(a.size());
  both.first = {spread(a), batch_first * samples};
  both.second = {spread(b), batch_second * samples};
  return both;
}

StepCost measure_steps(const Scene& scene, World& world, Workspace& work, const Effort& effort) {
  StepCost cost;
  const auto one_step = [&] { must_be_finite(step(scene, world, work), scene, world); };
  const std::int64_t batch = batch_size(one_step);
  const std::int64_t solves_before = world.diagnostics.total_solves, first_step = world.step;
  std::vector<double> whole;
  std::array<std::vector<double>, stage_count> stages;
  const double lap = lap_seconds();
  // By turns a batch without and a batch with the stopwatch.
  for (const double start = cpu_seconds(); !is_enough(effort, whole.size(), start);) {
    whole.push_back(timed(one_step, batch));
    StageTimes times;
    for (std::int64_t i = 0; i < batch; ++i)
      must_be_finite(step(scene, world, work, &times), scene, world);
    for (std::size_t s = 0; s < stage_count; ++s) {
      const double each = times.seconds[s] / static_cast<double>(batch);
      const int laps = s == static_cast<std::size_t>(Stage::diagnose) ? 2 : 1;
      stages[s].push_back(std::max(0.0, each - laps * lap));
    }
  }
  cost.step_s = spread(whole);
  for (std::size_t s = 0; s < stage_count; ++s) cost.stage_s[s] = spread(stages[s]);
  cost.steps = batch * static_cast<std::int64_t>(whole.size());
  cost.solves = static_cast<double>(world.diagnostics.total_solves - solves_before) /
                static_cast<double>(world.step - first_step);
  cost.fallbacks = world.diagnostics.fallbacks;
  return cost;
}

Tensions tensions_of(const World& world) {
  Tensions found{infinity, 0.0};
  for (const CableState& cable : world.cables) {
    for (std::size_t s = cable.closed ? 0 : 1; s < cable.segments.size(); ++s) {
      const std::size_t before = s > 0 ? s - 1 : cable.links.size() - 1;
      if (cable.links[s].pinch_middle || cable.links[before].pinch_middle) continue;
      found.least = std::min(found.least, cable.segments[s].tension);
      found.greatest = std::max(found.greatest, cable.segments[s].tension);
    }
  }
  return found;
}

const char* thesis_name(Stage stage) {
  switch (stage) {
    case Stage::init_segments:
      return "SegmentsInit";
    case Stage::init_contacts:
      return "ContactsInit";
    case Stage::solve:
      return "SlidingUpdate and Solver";
    case Stage::update_segments:
      return "UpdateSegments";
    case Stage::remove_links:
      return "RemoveJoints";
    case Stage::broad_phase:
      return "PinchBroadPhase";
    case Stage::intersect_segments:
      return "SegmentIntersections and AddJoints";
    case Stage::find_contacts:
      return "PinchNarrowPhase";
    case Stage::configure_pinches:
      return "PinchConfirm and ConfigurePinchJoints";
    default:
      return "–";
  }
}

std::string time_text(double seconds) {
  const struct {
    double size;
    const char* unit;
  } units[] = {{1.0, "s"}, {1e-3, "ms"}, {1e-6, "µs"}, {1e-9, "ns"}};
  for (const auto& [size, unit] : units) {
    if (seconds < 0.9995 * size) continue;
    const double number = seconds / size;
    return fmt::format("{:.{}f} {}", number, number < 9.995 ? 2 : number < 99.95 ? 1 : 0, unit);
  }
  return fmt::format("{:.2f} ns", 1e9 * seconds);
}

}  // namespace pinchlab::experiments
