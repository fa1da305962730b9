// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// HTTP only: the page, its media, and a small JSON interface to the desk (README.md lists it).

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "study/desk.h"
#include "study/http_server.h"

namespace pinchlab::study {

struct ServerOptions {
  std::string host = "127.0.0.1";
  int port = 0;  ///< 0: any that is free
  /// Names that participants open besides addresses and this computer's own (behind a proxy).
  std::vector<std::string> names;
  HttpLimits limits;
  std::chrono::milliseconds idle_check{60000};  ///< from one Desk::drop_idle() to the next
};

/// A server that is bound, so that its address can be told before it runs.
class Server {
 public:
  /// Throws std::runtime_error if the port cannot be had. `desk` must outlive the server.
  Server(Desk& desk, const ServerOptions& options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// "http://127.0.0.1:8080": an address that can be opened, also where all are listened on.
  [[nodiscard]] std::string address() const;
  /// What the researcher's view asks for; random, new for every server.
  [[nodiscard]] const std::string& researcher_token() const;

  /// Serves until stop() is called, from any thread.
  void run();
  void stop();

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace pinchlab::study
