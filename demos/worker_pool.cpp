// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/worker_pool.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace pinchlab {
namespace {

// What a worker writes to its pipe: a tick for every bit of progress, then one of the other two and
// a text to the end of the pipe.
constexpr char tick_mark = '.', done_mark = '+', failed_mark = '-';

volatile std::sig_atomic_t caught_signal = 0;
extern "C" void catch_signal(int number) {
  caught_signal = number;
}

// While it lives, the signals that ask to stop are only noted. Those that the program was started
// to ignore (by nohup, or in the background of a shell without job control) stay ignored.
class CaughtSignals {
 public:
  CaughtSignals() {
    caught_signal = 0;
    struct sigaction action = {};
    action.sa_handler = catch_signal;
    sigemptyset(&action.sa_mask);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      sigaction(numbers[i], nullptr, &before_[i]);
      if (before_[i].sa_handler != SIG_IGN) sigaction(numbers[i], &action, nullptr);
    }
  }
  ~CaughtSignals() { restore(); }
  CaughtSignals(const CaughtSignals&) = delete;
  CaughtSignals& operator=(const CaughtSignals&) = delete;
  void restore() const {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      sigaction(numbers[i], &before_[i], nullptr);
    }
  }

 private:
  static constexpr std::array<int, 3> numbers = {SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, 3> before_ = {};
};

struct Worker {
  std::size_t work = 0;
  pid_t process = 0;
  int pipe = -1;      // read end
  std::string reply;  // what came after the ticks
};

// A worker whose parent is gone gets SIGPIPE or EPIPE here; either way nobody is left to tell.
void send(int pipe, const std::string& text) {
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t count = ::write(pipe, text.data() + sent, text.size() - sent);
    if (count < 0 && errno != EINTR) {
      ::_exit(1);
    }
    sent += static_cast<std::size_t>(std::max<ssize_t>(count, 0));
  }
}

[[noreturn]] void be_worker(const Work& work, int pipe) {
  std::string reply;
  try {
    reply = done_mark + work([pipe] { send(pipe, std::string(1, tick_mark)); });
  } catch (const std::exception& error) {
    reply = failed_mark + std::string(error.what());
  }
  send(pipe, reply);
  ::_exit(0);  // the parent's buffers and temporaries are the parent's
}

Worker start_worker(std::span<const Work> work, std::size_t index, const CaughtSignals& signals) {
  std::array<int, 2> ends = {};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  }
  std::fflush(nullptr);  // or the worker would write the buffers' text once more
  const pid_t parent = ::getpid();
  const pid_t process = ::fork();
  if (process < 0) {
    const int why = errno;
    for (const int end : ends) ::close(end);
    throw std::runtime_error(fmt::format("cannot start a worker process: {}", std::strerror(why)));
  }
  if (process == 0) {
    signals.restore();
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) {
      ::_exit(1);  // it died before the line above
    }
    ::close(ends[0]);
    be_worker(work[index], ends[1]);
  }
  ::close(ends[1]);
  return {index, process, ends[0], ""};
}

// Reads what has come; false at the end of the pipe.
bool receive(Worker& worker, const WorkerPoolEvents& events) {
  std::array<char, 4096> buffer;
  const ssize_t count = ::read(worker.pipe, buffer.data(), buffer.size());
  if (count < 0) {
    return errno == EINTR || errno == EAGAIN;
  }
  for (const char c : std::string_view(buffer.data(), static_cast<std::size_t>(count))) {
    if (worker.reply.empty() && c == tick_mark) {
      events.tick(worker.work);
    } else {
      worker.reply += c;
    }
  }
  return count > 0;
}

void report_end(const Worker& worker, const WorkerPoolEvents& events) {
  ::close(worker.pipe);
  int status = 0;
  while (::waitpid(worker.process, &status, 0) < 0 && errno == EINTR) {
  }
  const bool is_whole = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  if (is_whole && worker.reply.starts_with(done_mark)) {
    events.done(worker.work, worker.reply.substr(1));
  } else if (is_whole && worker.reply.starts_with(failed_mark)) {
    events.failed(worker.work, worker.reply.substr(1));
  } else if (WIFSIGNALED(status)) {
    events.failed(worker.work,
                  fmt::format("its process was ended by signal {} ({}){}", WTERMSIG(status),
                              ::strsignal(WTERMSIG(status)),
                              WTERMSIG(status) == SIGKILL ? "; was memory short?" : ""));
  } else {
    events.failed(worker.work, "its process ended without a result");
  }
}

void end_workers(const std::vector<Worker>& workers) {
  for (const Worker& worker : workers) {
    ::kill(worker.process, SIGKILL);
    while (::waitpid(worker.process, nullptr, 0) < 0 && errno == EINTR) {
    }
    ::close(worker.pipe);
  }
}

}  // namespace

void end_by(int signal) {
  ::raise(signal);
  throw std::runtime_error(fmt::format("stopped by signal {} ({})", signal, ::strsignal(signal)));
}

int run_in_processes(std::span<const Work> work, int jobs, const WorkerPoolEvents& events) {
  const CaughtSignals signals;
  std::vector<Worker> workers;
  std::size_t next = 0;
  try {
    while (next < work.size() || !workers.empty()) {
      while (next < work.size() && workers.size() < static_cast<std::size_t>(jobs)) {
        workers.push_back(start_worker(work, next++, signals));
      }
      std::vector<pollfd> pipes(workers.size());
      std::ranges::transform(workers, pipes.begin(), [](const Worker& w) {
        return pollfd{w.pipe, POLLIN, 0};
      });
      ::poll(pipes.data(), pipes.size(), 200);  // ms: a signal just before it waits no longer
      if (caught_signal != 0) {
        end_workers(workers);
        return caught_signal;
      }
      events.idle();
      for (std::size_t i = pipes.size(); i-- > 0;) {
        if (pipes[i].revents != 0 && !receive(workers[i], events)) {
          const Worker ended = std::move(workers[i]);
          workers.erase(workers.begin() + static_cast<std::ptrdiff_t>(i));
          report_end(ended, events);
        }
      }
    }
  } catch (...) {
    end_workers(workers);
    throw;
  }
  return 0;
}

}  // namespace pinchlab
