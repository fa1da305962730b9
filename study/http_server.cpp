// SPDX-License-Identifier: GPL-3.0-or-later
// The only file that knows the library: Boost.Beast. A connection is a coroutine, which holds no
// thread while it waits. A handler holds one, since it waits for the disk.
#include "study/http_server.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <map>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "study/connections.h"

namespace pinchlab::study {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::size_t part_bytes = 1U << 16U;          // of a reply that is read as it is sent
constexpr std::chrono::milliseconds accept_pause{50};  // where the system has no more sockets
constexpr std::chrono::seconds linger_time{2};         // for a refusal to arrive
constexpr std::size_t linger_bytes = 1U << 20U;
constexpr std::size_t other_files = 128;  // that the program needs beside connections

// A connection's coroutine goes on with its error in `error`, not with an exception.
auto into(error_code& error) {
  return asio::redirect_error(asio::use_awaitable, error);
}

// Who counts as one: an IPv6 network of 64 bits is one household's.
std::string address_of(const tcp::socket& socket) {
  error_code ignored;
  const asio::ip::address address = socket.remote_endpoint(ignored).address();
  if (address.is_v4()) {
    return address.to_string();
  }
  asio::ip::address_v6 v6 = address.to_v6();
  if (v6.is_v4_mapped()) {
    return asio::ip::make_address_v4(asio::ip::v4_mapped, v6).to_string();
  }
  auto bytes = v6.to_bytes();
  std::fill(bytes.begin() + 8, bytes.end(), 0);
  return asio::ip::address_v6(bytes).to_string();
}

// As many files as the system lets this process have. Returns how many that is.
std::size_t raise_file_limit() {
  rlimit limit = {};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) {
    return 1024;
  }
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, 65536);
  ::setrlimit(RLIMIT_NOFILE, &limit);
  ::getrlimit(RLIMIT_NOFILE, &limit);
  return limit.rlim_cur;
}

HttpReply refusal(int status, const std::string& reason) {
  HttpReply reply;
  reply.status = status;
  reply.type = "application/json";
  reply.body = fmt::format("{{\"error\":\"{}\"}}", reason);
  return reply;
}

HttpReply refusal(const error_code& error) {
  return error == http::error::header_limit ? refusal(431, "the header is too long")
         : error == http::error::body_limit ? refusal(413, "the body is too long")
                                            : refusal(400, "that is not HTTP");
}

// What a header alone shows to be wrong. A body comes with one plain length or not at all, so that
// nothing before us can take its end to be elsewhere (RFC 9112, 11.2).
std::optional<HttpReply> header_refusal(const http::request<http::string_body>& request) {
  if (request.version() != 10 && request.version() != 11) {
    return refusal(505, "HTTP/1.1 is spoken here");
  }
  if (request.count(http::field::host) != 1) {
    return refusal(400, "one Host header is needed");
  }
  if (request.count(http::field::transfer_encoding) > 0) {
    return refusal(411, "a body needs a Content-Length");
  }
  if (request.count(http::field::content_length) > 1 ||
      request[http::field::content_length].find(',') != beast::string_view::npos) {
    return refusal(400, "a body has one length");
  }
  if (request.count(http::field::expect) > 0) {
    return refusal(417, "nothing is promised");
  }
  return std::nullopt;
}

HttpRequest plain(http::request<http::string_body> message, const std::string& address) {
  HttpRequest request;
  request.method = std::string(message.method_string());
  const std::string target(message.target());
  request.path = target.substr(0, target.find('?'));
  request.address = address;
  for (const auto& field : message) {
    std::string name(field.name_string());
    std::ranges::transform(name, name.begin(),
                           [](char c) { return 'A' <= c && c <= 'Z' ? c - 'A' + 'a' : c; });
    std::string& value = request.headers[name];
    value += (value.empty() ? "" : ", ") + std::string(field.value());
  }
  request.body = std::move(message.body());
  return request;
}

// What helps where an address cannot be listened on.
const char* cure_of(const error_code& error) {
  if (error == asio::error::address_in_use) {
    return "is another server running? Use another --port or --host";
  }
  if (error == asio::error::access_denied) return "use a --port of 1024 or more";
  return "use another --host: an address or name of this computer, or 0.0.0.0 for all of them";
}

void listen_at(const std::string& host, int port, std::size_t connections,
               asio::io_context& context, tcp::acceptor& acceptor) {
  try {
    const auto found = tcp::resolver(context).resolve(
        host, std::to_string(port), tcp::resolver::passive | tcp::resolver::numeric_service);
    const tcp::endpoint endpoint = found.begin()->endpoint();
    acceptor.open(endpoint.protocol());
    acceptor.set_option(tcp::acceptor::reuse_address(true));
    acceptor.bind(endpoint);
    acceptor.listen(static_cast<int>(connections));
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error(fmt::format("{}:{} cannot be listened on: {}; {}", host, port,
                                         error.code().message(), cure_of(error.code())));
  }
}

}  // namespace

struct HttpServer::Implementation {
  struct Connection {
    explicit Connection(tcp::socket socket)
        : address(address_of(socket)), stream(std::move(socket)) {}
    Connections::Id id = 0;
    std::string address;
    beast::tcp_stream stream;
  };
  using ConnectionPtr = std::shared_ptr<Connection>;

  Implementation(const std::string& host, int port, HttpLimits limits_, Handler handler_)
      : limits(limits_),
        handler(std::move(handler_)),
        connections(std::min(limits.connections,
                             std::max(raise_file_limit(), 2 * other_files) - other_files),
                    limits.connections_of_address) {
    listen_at(host, port, limits.connections, context, acceptor);
  }

  asio::awaitable<void> accept_all() {
    while (true) {
      error_code error;
      tcp::socket socket = co_await acceptor.async_accept(asio::make_strand(context), into(error));
      if (error == asio::error::operation_aborted) {
        co_return;
      }
      if (error) {
        asio::steady_timer pause(context, accept_pause);
        co_await pause.async_wait(into(error));
        continue;
      }
      auto connection = std::make_shared<Connection>(std::move(socket));
      if (admit(connection)) {
        asio::co_spawn(
            connection->stream.get_executor(), [this, connection] { return converse(connection); },
            asio::detached);
      }
    }
  }

  asio::awaitable<void> repeat(std::chrono::milliseconds interval, std::function<void()> task) {
    asio::steady_timer timer(context);
    for (error_code error; !error;) {
      timer.expires_after(interval);
      co_await timer.async_wait(into(error));
      if (!error) task();
    }
  }

  // False: there are too many, and none that could be closed for it.
  bool admit(const ConnectionPtr& connection) {
    const std::scoped_lock lock(mutex);
    connection->id = ++last_id;
    const auto [is_admitted, closed] = connections.add(connection->id, connection->address);
    if (closed) {
      if (const ConnectionPtr other = open[*closed].lock()) {
        asio::post(other->stream.get_executor(), [other] { other->stream.close(); });
      }
      open.erase(*closed);
    }
    if (is_admitted) {
      open[connection->id] = connection;
    }
    return is_admitted;
  }

  asio::awaitable<void> converse(ConnectionPtr connection) {
    const std::shared_ptr<void> at_the_end(nullptr, [this, id = connection->id](void*) {
      const std::scoped_lock lock(mutex);
      connections.remove(id);
      open.erase(id);
    });
    error_code ignored;
    connection->stream.socket().set_option(tcp::no_delay(true), ignored);
    beast::flat_buffer buffer;
    for (bool goes_on = true; goes_on;) {
      goes_on = co_await serve_one(*connection, buffer);
    }
    connection->stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  // One request and its reply. False: the connection ends.
  asio::awaitable<bool> serve_one(Connection& connection, beast::flat_buffer& buffer) {
    http::request_parser<http::string_body> parser;
    parser.header_limit(static_cast<std::uint32_t>(limits.header_bytes));
    parser.body_limit(limits.body_bytes);
    mark(connection, &Connections::waits);
    error_code error;
    connection.stream.expires_after(limits.header_time);
    co_await http::async_read_header(connection.stream, buffer, parser, into(error));
    std::optional<HttpReply> refused;
    if (!error) {
      refused = header_refusal(parser.get());
    }
    if (!error && !refused) {
      connection.stream.expires_after(limits.body_time);
      co_await http::async_read(connection.stream, buffer, parser, into(error));
    }
    mark(connection, &Connections::works);
    if (error && error.category() != make_error_code(http::error::body_limit).category()) {
      co_return false;  // gone, or too slow
    }
    if (error == http::error::end_of_stream || error == http::error::partial_message) {
      co_return false;
    }
    if (error) {
      refused = refusal(error);
    }
    if (refused) {
      // The rest of the request is not read, so that nothing can follow on this connection.
      const bool was_sent =
          co_await write(connection, std::move(*refused), parser.get().method(), 11, false);
      if (was_sent) {
        co_await linger(connection);
      }
      co_return false;
    }
    const unsigned version = parser.get().version();
    const http::verb method = parser.get().method();
    const bool is_kept = parser.keep_alive();
    HttpReply reply = answer(plain(parser.release(), connection.address));
    const bool was_sent = co_await write(connection, std::move(reply), method, version, is_kept);
    co_return (was_sent && is_kept);
  }

  HttpReply answer(const HttpRequest& request) const {
    try {
      return handler(request);
    } catch (const std::exception&) {
      return refusal(500, "the server has a problem");
    }
  }

  // True: the whole reply was sent.
  asio::awaitable<bool> write(Connection& connection, HttpReply reply, http::verb method,
                              unsigned version, bool is_kept) {
    http::response<http::empty_body> head(static_cast<http::status>(reply.status), version);
    for (const auto& [name, value] : reply.headers) {
      head.set(name, value);
    }
    if (!reply.type.empty()) {
      head.set(http::field::content_type, reply.type);
    }
    const std::uint64_t length = reply.read ? reply.length : reply.body.size();
    head.content_length(length);
    head.keep_alive(is_kept);
    http::response_serializer<http::empty_body> serializer(head);
    error_code error;
    connection.stream.expires_after(limits.part_time);
    co_await http::async_write_header(connection.stream, serializer, into(error));
    for (std::uint64_t sent = 0; !error && method != http::verb::head && sent < length;) {
      if (reply.read && !read_part(reply, sent)) {
        co_return false;
      }
      connection.stream.expires_after(limits.part_time);
      sent += co_await asio::async_write(connection.stream, asio::buffer(reply.body), into(error));
    }
    co_return !error;
  }

  // The next part of a reply that is read as it is sent. False: it cannot be read any more.
  static bool read_part(HttpReply& reply, std::uint64_t offset) {
    try {
      reply.body = reply.read(offset, static_cast<std::size_t>(std::min<std::uint64_t>(
                                          part_bytes, reply.length - offset)));
      return !reply.body.empty();
    } catch (const std::exception&) {
      return false;
    }
  }

  // Closed at once, a connection with bytes that nobody has read is reset, and the refusal on its
  // way is lost with it (RFC 9112, 9.6).
  static asio::awaitable<void> linger(Connection& connection) {
    error_code error;
    connection.stream.socket().shutdown(tcp::socket::shutdown_send, error);
    connection.stream.expires_after(linger_time);
    std::array<char, 4096> unread{};
    for (std::size_t got = 0; !error && got < linger_bytes;) {
      got += co_await connection.stream.async_read_some(asio::buffer(unread), into(error));
    }
  }

  void mark(const Connection& connection, void (Connections::*what)(Connections::Id)) {
    const std::scoped_lock lock(mutex);
    (connections.*what)(connection.id);
  }

  HttpLimits limits;
  Handler handler;
  std::mutex mutex;  // of the three below
  Connections connections;
  Connections::Id last_id = 0;
  std::map<Connections::Id, std::weak_ptr<Connection>> open;
  asio::io_context context;  // its coroutines use all of the above
  tcp::acceptor acceptor{asio::make_strand(context)};
};

void check_address(const std::string& host, int port) {
  asio::io_context context;
  tcp::acceptor acceptor{context};
  listen_at(host, port, 1, context, acceptor);
}

HttpServer::HttpServer(const std::string& host, int port, HttpLimits limits, Handler handler)
    : implementation_(std::make_unique<Implementation>(host, port, limits, std::move(handler))) {}

HttpServer::~HttpServer() = default;

int HttpServer::port() const {
  return implementation_->acceptor.local_endpoint().port();
}

void HttpServer::every(std::chrono::milliseconds interval, std::function<void()> task) {
  Implementation& server = *implementation_;
  asio::co_spawn(server.context, server.repeat(interval, std::move(task)), asio::detached);
}

void HttpServer::run() {
  Implementation& server = *implementation_;
  asio::co_spawn(
      server.acceptor.get_executor(), [&server] { return server.accept_all(); }, asio::detached);
  std::vector<std::jthread> threads;
  for (int i = 0; i < server.limits.threads; ++i) {
    threads.emplace_back([&server] { server.context.run(); });
  }
}

void HttpServer::stop() {
  implementation_->context.stop();
}

}  // namespace pinchlab::study
