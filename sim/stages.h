// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The stages of a step, and how long each of them takes.

#include <array>
#include <chrono>
#include <cstddef>

namespace pinchlab {

/// The stages of a step, in order. Those of the thesis' Algorithm 1 keep their names; its cycle
/// starts at update_segments, ours ends with it, so that a world between steps shows cables that
/// fit its bodies.
enum class Stage {
  apply_forces,
  init_segments,
  init_contacts,
  solve,
  move_bodies,
  update_segments,
  remove_links,
  broad_phase,
  intersect_segments,
  find_contacts,
  configure_pinches,
  diagnose,
  count
};

const char* to_string(Stage stage);

/// Seconds spent in each stage, added up over the steps that were given this.
struct StageTimes {
  std::array<double, static_cast<std::size_t>(Stage::count)> seconds{};
};

/// Adds the time since the last lap to a stage; without `times` it does nothing.
class Stopwatch {
 public:
  explicit Stopwatch(StageTimes* times) : times_(times) {
    if (times_) last_ = Clock::now();
  }
  void lap(Stage stage) {
    if (!times_) return;
    const auto now = Clock::now();
    times_->seconds[static_cast<std::size_t>(stage)] +=
        std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  StageTimes* times_;
  Clock::time_point last_;
};

}  // namespace pinchlab
