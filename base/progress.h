// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace pinchlab {

/// Tells on standard error how far long work is and how long it will still take: one line that is
/// written anew on a terminal, a line every ten seconds elsewhere, nothing in the first second.
class Progress {
 public:
  /// "rendering: 41 % of 9600 frames, 0:52 left": `what` is rendering, `unit` frames, `total` 9600.
  /// With an empty unit "rendering: 41 %, 0:52 left".
  Progress(std::string what, std::string unit, std::int64_t total);
  ~Progress();  ///< clears the terminal's line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void add(std::int64_t units);  ///< 0: says how long it has lasted, while nothing is done
  /// Clears the terminal's line, so that something else can be written; the next add() restores it.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_, unit_;
  std::int64_t total_ = 0, done_ = 0;
  bool on_terminal_ = false, shown_ = false;
  Clock::time_point start_, next_;
};

/// "0:09", "12:05", "1:02:03".
std::string minutes_and_seconds(double seconds);

}  // namespace pinchlab
