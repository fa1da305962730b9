// SPDX-License-Identifier: GPL-3.0-or-later
// How the study's server stands up to many people, and to people who mean harm. Everything happens
// on this computer (127.0.0.1), with a server of its own.
//
//   build/release/tests/study_load             all of it, about two minutes
//   build/release/tests/study_load slow        one of fetches, slow, people, memory
//
// Prints what was measured and the goal; status 1 if a goal was missed. PINCHLAB_PROGRAM names
// another program to test than this build's.

#include <arpa/inet.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <barrier>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <mutex>
#include <thread>

#include "study/http_client.h"
#include "tests/study/server_process.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// A server with eight demonstrations of two clips, 1.5 MB each.
class Study {
 public:
  Study() : folder_(fs::temp_directory_path() / fmt::format("pinchlab-load-{}", ::getpid())) {
    const std::vector<std::string> names = {"01-a", "02-b", "03-c", "04-d",
                                            "05-e", "06-f", "07-g", "08-h"};
    write_clips(folder_ / "clips", names, 1500000);
    std::ofstream(folder_ / "study.json")
        << json{{"format", "pinchlab-study 1"}, {"demonstrations", names}};
    const char* other = std::getenv("PINCHLAB_PROGRAM");
    process_.emplace(other != nullptr ? other : PINCHLAB_PROGRAM, folder_);
    address_ = process_->address();
    if (address_.empty()) {
      throw std::runtime_error("the server does not start");
    }
  }
  ~Study() {
    process_.reset();
    fs::remove_all(folder_);
  }
  Study(const Study&) = delete;
  Study& operator=(const Study&) = delete;

  [[nodiscard]] const std::string& address() const { return address_; }

  // MB that the server has in memory.
  [[nodiscard]] double memory() const {
    std::ifstream status(fmt::format("/proc/{}/status", process_->id()));
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("VmHWM:")) {
        return std::stod(line.substr(6)) / 1024;
      }
    }
    return 0;
  }

 private:
  fs::path folder_;
  std::optional<ServerProcess> process_;
  std::string address_;
};

int connect_to(const std::string& address) {
  const int connection = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in to = {};
  to.sin_family = AF_INET;
  to.sin_port = htons(port_of(address));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(connection, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) {
    ::close(connection);
    return -1;
  }
  return connection;
}

// 400 new connections at the same moment, a whole clip each.
bool fetches() {
  constexpr int count = 400;
  const Study study;
  HttpClient client(study.address());
  const json session = json::parse(client.post("/api/start", {{"consent", true}}).value().body);
  std::atomic<int> whole = 0;
  std::atomic<double> slowest = 0;
  std::barrier begin(count);
  std::vector<std::jthread> people;
  for (int i = 0; i < count; ++i) {
    people.emplace_back([&, i] {
      HttpClient browser(study.address(), std::chrono::seconds(300));
      const std::string path = session["trials"][static_cast<std::size_t>(i) % 8]["mp4"];
      begin.arrive_and_wait();
      const auto start = Clock::now();
      const auto answer = browser.get(path);
      whole += answer && answer->status == 200 && answer->body.size() > 1500000 ? 1 : 0;
      const double taken = seconds_since(start);
      for (double before = slowest; before < taken;) {
        if (slowest.compare_exchange_weak(before, taken)) break;
      }
    });
  }
  people.clear();
  fmt::print("fetches: {} of {} clips came whole, the slowest after {:.1f} s (goal: all)\n",
             whole.load(), count, slowest.load());
  return whole == count;
}

// Connections that send a byte every 4 s, and open anew what is closed.
class SlowConnections {
 public:
  SlowConnections(std::string address, int count)
      : address_(std::move(address)), connections_(static_cast<std::size_t>(count), -1) {
    open_missing();
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        std::mutex mutex;
        std::unique_lock lock(mutex);
        std::condition_variable_any().wait_for(lock, stop, std::chrono::seconds(4),
                                               [] { return false; });
        for (int& connection : connections_) {
          if (connection >= 0 && ::send(connection, "x", 1, MSG_NOSIGNAL) <= 0) {
            ::close(connection);
            connection = -1;
          }
        }
        open_missing();
      }
    });
  }
  ~SlowConnections() {
    thread_ = {};
    for (const int connection : connections_) {
      if (connection >= 0) ::close(connection);
    }
  }
  SlowConnections(const SlowConnections&) = delete;
  SlowConnections& operator=(const SlowConnections&) = delete;

 private:
  void open_missing() {
    const std::string begin = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: ";
    for (int& connection : connections_) {
      if (connection < 0 && (connection = connect_to(address_)) >= 0) {
        ::send(connection, begin.data(), begin.size(), MSG_NOSIGNAL);
      }
    }
  }

  std::string address_;
  std::vector<int> connections_;
  std::jthread thread_;
};

bool slow() {
  const Study study;
  const SlowConnections slow_ones(study.address(), 500);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  double slowest = 0;  // s
  int answered = 0, asked = 0;
  const auto begin = Clock::now();
  while (seconds_since(begin) < 20) {
    HttpClient browser(study.address(), std::chrono::seconds(10));  // a new connection each
    for (const char* path : {"/", "/api/study"}) {
      const auto start = Clock::now();
      const auto answer = browser.get(path);
      ++asked;
      answered += answer && answer->status == 200 ? 1 : 0;
      slowest = std::max(slowest, seconds_since(start));
    }
    std::this_thread::sleep_for(milliseconds(300));
  }
  fmt::print(
      "slow: beside 500 connections of a byte every 4 s, {} of {} requests were answered, "
      "the slowest after {:.3f} s (goal: all, within 1 s)\n",
      answered, asked, slowest);
  return answered == asked && slowest < 1;
}

// 200 people from start to save, with 0.3 s between their requests.
bool people() {
  constexpr int count = 200;
  const Study study;
  std::mutex mutex;
  std::vector<double> times;  // s
  int failed = 0;
  std::vector<std::jthread> all;
  for (int i = 0; i < count; ++i) {
    all.emplace_back([&, i] {
      std::this_thread::sleep_for(milliseconds(300 * i / count));
      HttpClient browser(study.address());
      const auto ask = [&](const std::string& path, const json& body, const std::string& token) {
        const auto start = Clock::now();
        const auto answer = browser.post(path, body, token);
        const double taken = seconds_since(start);
        {
          const std::scoped_lock lock(mutex);
          times.push_back(taken);
          failed += answer && answer->status == 200 ? 0 : 1;
        }
        std::this_thread::sleep_for(milliseconds(300));
        return answer ? json::parse(answer->body, nullptr, false) : json();
      };
      const json session = ask("/api/start", {{"consent", true}}, "");
      const std::string token = session.value("token", "");
      for (std::size_t index = 0; index < 8; ++index) {
        ask("/api/show", {{"index", index}}, token);
        ask("/api/answer", answer_body(index), token);
      }
      ask("/api/save", {{"free_text", json::object()}}, token);
    });
  }
  all.clear();
  std::ranges::sort(times);
  const auto quantile = [&](double q) {
    return 1000 * times[static_cast<std::size_t>(q * static_cast<double>(times.size() - 1))];  // ms
  };
  fmt::print(
      "people: {} at once, {} requests, {} failed; median {:.1f} ms, p99 {:.1f} ms, slowest "
      "{:.1f} ms (goal: none, p99 under 200 ms)\n",
      count, times.size(), failed, quantile(0.5), quantile(0.99), quantile(1));
  return failed == 0 && quantile(0.99) < 200;
}

// A body of 400 MB in chunks, sent before anybody has asked who sends it.
bool memory() {
  const Study study;
  const double before = study.memory();
  const int connection = connect_to(study.address());
  const std::string head =
      "POST /api/start HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\n"
      "Transfer-Encoding: chunked\r\n\r\n";
  const std::string chunk = "100000\r\n" + std::string(1U << 20U, 'x') + "\r\n";
  bool goes_on = ::send(connection, head.data(), head.size(), MSG_NOSIGNAL) > 0;
  int taken = 0;  // MB
  for (; goes_on && taken < 400; ++taken) {
    for (std::size_t sent = 0; goes_on && sent < chunk.size();) {
      const ssize_t part =
          ::send(connection, chunk.data() + sent, chunk.size() - sent, MSG_NOSIGNAL);
      goes_on = part > 0;
      sent += part > 0 ? static_cast<std::size_t>(part) : 0;
    }
  }
  ::close(connection);
  const double after = study.memory();
  fmt::print(
      "memory: a body of 400 MB in chunks: {} MB were taken, and the server grew from {:.0f} "
      "to {:.0f} MB (goal: less than 8 MB more)\n",
      taken, before, after);
  return after - before < 8;
}

int run(const std::vector<std::string>& wanted) {
  rlimit files = {};
  ::getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &files);
  const std::vector<std::pair<std::string, std::function<bool()>>> all = {
      {"fetches", fetches}, {"slow", slow}, {"people", people}, {"memory", memory}};
  bool is_good = true;
  for (const std::string& name : wanted) {
    if (std::ranges::find(all, name, &std::pair<std::string, std::function<bool()>>::first) ==
        all.end()) {
      fmt::print(stderr, "{}: not one of fetches, slow, people, memory\n", name);
      return 2;
    }
  }
  for (const auto& [name, measure] : all) {
    if (wanted.empty() || std::ranges::find(wanted, name) != wanted.end()) {
      is_good = measure() && is_good;
      std::fflush(stdout);
    }
  }
  return is_good ? 0 : 1;
}

}  // namespace
}  // namespace pinchlab::study

int main(int argc, char** argv) {
  try {
    return pinchlab::study::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    fmt::print(stderr, "study_load: {}\n", error.what());
    return 1;
  }
}
