// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <string>

namespace pinchlab {

/// A piece of work done in a process of its own. What it returns, or what() of the exception it
/// throws, comes back to the parent; it calls its argument after every bit of progress.
using Work = std::function<std::string(const std::function<void()>& tick)>;

struct WorkerPoolEvents {
  std::function<void(std::size_t work)> tick;
  std::function<void(std::size_t work, const std::string& result)> done;
  std::function<void(std::size_t work, const std::string& error)> failed;
  std::function<void()> idle = [] {};  ///< several times a second, whatever else happens
};

/// Does all of `work`, in this order, up to `jobs` pieces at a time, each in a freshly forked
/// process: a clip that fails takes no other with it, and OSMesa, where it is asked for, draws one
/// frame at a time a process. Workers die with the process that called. The caller must have made
/// no OpenGL context before.
///
/// Returns 0, or the number of the signal (SIGINT, SIGTERM, SIGHUP) that stopped it: then the
/// workers have been ended and the signals' former handlers are back in place. A signal that the
/// program ignores does not stop it.
int run_in_processes(std::span<const Work> work, int jobs, const WorkerPoolEvents& events);

/// Ends the program by the signal, as if it had not been caught. Throws std::runtime_error where
/// that does not end it.
[[noreturn]] void end_by(int signal);

}  // namespace pinchlab
