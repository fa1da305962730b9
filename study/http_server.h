// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// HTTP/1.1 for people who may mean harm: nothing is read that is too long, nobody is waited for
// longer than the limits say, and no connection holds up another.

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "study/http.h"

namespace pinchlab::study {

struct HttpLimits {
  std::size_t header_bytes = 8192;            ///< of request line and headers
  std::size_t body_bytes = 1U << 18U;         ///< of a request
  std::chrono::seconds header_time{15};       ///< for a whole header, from the reply before on
  std::chrono::seconds body_time{20};         ///< for a whole body
  std::chrono::seconds part_time{30};         ///< for the reader to take 64 KiB of a reply
  std::size_t connections = 4096;             ///< fewer where the system allows fewer open files
  std::size_t connections_of_address = 1024;  ///< an IPv6 address stands for its /64
  int threads = 32;                           ///< that wait for the disk at most
};

/// Whether the address can be listened on now, before work that would be for nothing else. Throws
/// std::runtime_error with the cure.
void check_address(const std::string& host, int port);

class HttpServer {
 public:
  /// Answers a request; called by many threads at once. What it throws becomes status 500.
  using Handler = std::function<HttpReply(const HttpRequest&)>;

  /// Binds, so that the port can be told before run(). Port 0: any that is free. Throws
  /// std::runtime_error with the cure.
  HttpServer(const std::string& host, int port, HttpLimits limits, Handler handler);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] int port() const;

  /// Calls `task` while run() serves, `interval` after the call before. To be said before run();
  /// `task` throws nothing.
  void every(std::chrono::milliseconds interval, std::function<void()> task);

  /// Serves until stop() is called, from any thread.
  void run();
  void stop();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace pinchlab::study
