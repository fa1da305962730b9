// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Runs the built program as a user would.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/base/scratch_folder.h"

namespace pinchlab {

struct RunResult {
  int exit_code = -1;  // -1: ended by a signal
  int signal = 0;
  std::string out, err;  // err without how far the work is
};

/// What the program says on standard error without the lines of base/progress.h: a slow machine has
/// them, a fast one has none.
inline std::string without_progress(const std::string& text) {
  std::string kept;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool has_share = line.find(" %") != std::string::npos;
    const bool is_progress =
        has_share && (line.ends_with(" left") || line.find(", after ") != std::string::npos);
    if (!is_progress) kept += line + (lines.eof() ? "" : "\n");
  }
  return kept;
}

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Starts the program in `folder`; its output goes to stdout.txt and stderr.txt there. No file that
/// it writes may become larger than `file_limit` bytes.
inline pid_t start_program(const std::filesystem::path& folder,
                           const std::vector<std::string>& arguments,
                           rlim_t file_limit = RLIM_INFINITY) {
  const pid_t process = ::fork();
  if (process != 0) {
    return process;
  }
  std::vector<char*> argv = {const_cast<char*>("pinchlab")};
  for (const std::string& argument : arguments) {
    argv.push_back(const_cast<char*>(argument.c_str()));
  }
  argv.push_back(nullptr);
  const int out = ::open((folder / "stdout.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int err = ::open((folder / "stderr.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (::chdir(folder.c_str()) == 0 && ::dup2(out, STDOUT_FILENO) >= 0 &&
      ::dup2(err, STDERR_FILENO) >= 0) {
    if (file_limit != RLIM_INFINITY) {
      const struct rlimit limit = {file_limit, file_limit};
      ::setrlimit(RLIMIT_FSIZE, &limit);
      ::signal(SIGXFSZ, SIG_IGN);  // the write fails, as on a full disk
    }
    ::execv(PINCHLAB_PROGRAM, argv.data());
  }
  ::_exit(127);
}

inline RunResult wait_for_program(const std::filesystem::path& folder, pid_t process) {
  int status = 0;
  EXPECT_EQ(::waitpid(process, &status, 0), process);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, WIFSIGNALED(status) ? WTERMSIG(status) : 0,
          text_of(folder / "stdout.txt"), without_progress(text_of(folder / "stderr.txt"))};
}

/// Waits until `has_happened()`; false if the program has ended without.
template <class Happened>
bool wait_until(pid_t process, const Happened& has_happened) {
  for (;;) {
    siginfo_t ended = {};
    const bool has_ended =
        ::waitid(P_PID, static_cast<id_t>(process), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 ||
        ended.si_pid == process;
    if (has_happened()) return true;
    if (has_ended) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

inline RunResult run_program(const std::filesystem::path& folder,
                             const std::vector<std::string>& arguments,
                             rlim_t file_limit = RLIM_INFINITY) {
  return wait_for_program(folder, start_program(folder, arguments, file_limit));
}

/// What the program writes to a terminal that its standard error is.
inline std::string told_on_terminal(const std::filesystem::path& folder,
                                    const std::vector<std::string>& arguments) {
  const int user = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  EXPECT_TRUE(user >= 0 && ::grantpt(user) == 0 && ::unlockpt(user) == 0);
  std::filesystem::remove(folder / "stderr.txt");
  std::filesystem::create_symlink(::ptsname(user), folder / "stderr.txt");
  const int kept_open = ::open(::ptsname(user), O_RDWR | O_NOCTTY);  // so that nothing is lost
  const pid_t process = start_program(folder, arguments);
  EXPECT_EQ(::waitpid(process, nullptr, 0), process);
  std::string told(65536, '\0');
  told.resize(
      static_cast<std::size_t>(std::max<ssize_t>(0, ::read(user, told.data(), told.size()))));
  std::filesystem::remove(folder / "stderr.txt");
  ::close(kept_open);
  ::close(user);
  return told;
}

}  // namespace pinchlab
