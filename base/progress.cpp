// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace pinchlab {

using namespace std::chrono_literals;

Progress::Progress(std::string what, std::string unit, std::int64_t total)
    : what_(std::move(what)), unit_(std::move(unit)), total_(total) {
  on_terminal_ = ::isatty(STDERR_FILENO) == 1;
  start_ = Clock::now();
  next_ = start_ + (on_terminal_ ? 1s : 10s);
}

Progress::~Progress() {
  clear();
}

void Progress::add(std::int64_t units) {
  done_ += units;
  const Clock::time_point now = Clock::now();
  if (now < next_) {
    return;
  }
  next_ = now + (on_terminal_ ? 250ms : 10s);
  const double elapsed = std::chrono::duration<double>(now - start_).count();  // s
  const double share = static_cast<double>(done_) / static_cast<double>(total_);
  const std::string of = unit_.empty() ? "" : fmt::format(" of {} {}", total_, unit_);
  const std::string time = done_ > 0 ? minutes_and_seconds(elapsed * (1.0 / share - 1.0)) + " left"
                                     : "after " + minutes_and_seconds(elapsed);
  const std::string line =
      fmt::format("{}: {:.0f} %{}, {}", what_, std::floor(100.0 * share), of, time);
  fmt::print(stderr, "{}{}{}", on_terminal_ ? "\r" : "", line, on_terminal_ ? "\x1b[K" : "\n");
  std::fflush(stderr);
  shown_ = on_terminal_;
}

void Progress::clear() {
  if (shown_) {
    fmt::print(stderr, "\r\x1b[K");
    std::fflush(stderr);
    shown_ = false;
  }
}

std::string minutes_and_seconds(double seconds) {
  const auto whole = std::llround(std::max(seconds, 0.0));
  const auto hours = whole / 3600, minutes = whole / 60 % 60;
  return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60)
                   : fmt::format("{}:{:02}", minutes, whole % 60);
}

}  // namespace pinchlab
