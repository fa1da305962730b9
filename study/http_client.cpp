// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/http_client.h"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <cctype>
#include <limits>

namespace pinchlab::study {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;

struct HttpClient::Implementation {
  using Error = boost::system::error_code;

  std::uint16_t port;
  std::chrono::seconds patience;
  asio::io_context context;
  std::optional<beast::tcp_stream> stream;

  // Runs one asynchronous operation until it is done or the patience is at its end.
  template <class Begin>
  bool waited_for(const Begin& begin) {
    Error result;
    stream->expires_after(patience);
    begin([&result](const Error& error, auto&&...) { result = error; });
    context.restart();
    context.run();
    return !result;
  }

  std::optional<HttpAnswer> once(const http::request<http::string_body>& request) {
    const bool is_open = stream || connect();
    beast::flat_buffer buffer;
    http::response_parser<http::string_body> parser;
    parser.body_limit(std::numeric_limits<std::uint64_t>::max());
    const bool is_whole =
        is_open &&
        waited_for([&](auto done) { http::async_write(*stream, request, std::move(done)); }) &&
        waited_for([&](auto done) { http::async_read(*stream, buffer, parser, std::move(done)); });
    if (!is_whole || !parser.keep_alive()) {
      stream.reset();
    }
    if (!is_whole) {
      return std::nullopt;
    }
    const auto message = parser.release();
    HttpAnswer answer{static_cast<int>(message.result_int()), {}, message.body()};
    for (const auto& field : message) {
      std::string name(field.name_string());
      std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
      answer.headers[name] = std::string(field.value());
    }
    return answer;
  }

  bool connect() {
    stream.emplace(context);
    const asio::ip::tcp::endpoint server(asio::ip::address_v4::loopback(), port);
    return waited_for([&](auto done) { stream->async_connect(server, std::move(done)); });
  }

  std::optional<HttpAnswer> exchange(const http::request<http::string_body>& request) {
    const bool was_open = stream.has_value();
    auto answer = once(request);
    // The server may have closed a kept connection meanwhile.
    return !answer && was_open ? once(request) : answer;
  }
};

HttpClient::HttpClient(const std::string& address, std::chrono::seconds patience)
    : implementation_(std::make_unique<Implementation>()) {
  implementation_->port = port_of(address);
  implementation_->patience = patience;
}

HttpClient::~HttpClient() = default;

std::optional<HttpAnswer> HttpClient::get(const std::string& path, const Headers& headers) {
  http::request<http::string_body> request(http::verb::get, path, 11);
  request.set(http::field::host, "127.0.0.1");
  for (const auto& [name, value] : headers) {
    request.set(name, value);
  }
  return implementation_->exchange(request);
}

std::optional<HttpAnswer> HttpClient::post(const std::string& path, const nlohmann::json& body,
                                           const std::string& token) {
  http::request<http::string_body> request(http::verb::post, path, 11);
  request.set(http::field::host, "127.0.0.1");
  request.set(http::field::content_type, "application/json");
  if (!token.empty()) {
    request.set(http::field::authorization, "Bearer " + token);
  }
  request.body() = body.dump();
  request.prepare_payload();
  return implementation_->exchange(request);
}

Headers bearer(const std::string& token) {
  return {{"Authorization", "Bearer " + token}};
}

std::uint16_t port_of(const std::string& address) {
  return static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
}

}  // namespace pinchlab::study
