// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A client as patient as a browser, of a server on this computer: for simulated participants and
// tests.

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace pinchlab::study {

using Headers = std::map<std::string, std::string>;

struct HttpAnswer {
  int status = 0;
  Headers headers;  ///< by name in lower case
  std::string body;
  [[nodiscard]] bool has(const std::string& name) const { return headers.contains(name); }
  [[nodiscard]] std::string header(const std::string& name) const {
    return has(name) ? headers.at(name) : "";
  }
};

/// The header of who has a token.
Headers bearer(const std::string& token);

/// The port of "http://127.0.0.1:8080".
std::uint16_t port_of(const std::string& address);

/// One connection, which is kept and opened anew as needed. Not for several threads.
class HttpClient {
 public:
  explicit HttpClient(const std::string& address,
                      std::chrono::seconds patience = std::chrono::seconds(60));
  ~HttpClient();
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  /// What the server answers; none if the connection was refused, cut or timed out.
  std::optional<HttpAnswer> get(const std::string& path, const Headers& headers = {});
  std::optional<HttpAnswer> post(const std::string& path, const nlohmann::json& body,
                                 const std::string& token = "");

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace pinchlab::study
