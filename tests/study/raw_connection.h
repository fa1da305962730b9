// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Bytes to a server that no client of HTTP would send.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <string>

#include "study/http_client.h"

namespace pinchlab::study {

// Sends bytes as they are.
class RawConnection {
 public:
  explicit RawConnection(const std::string& address)
      : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in to = {};
    to.sin_family = AF_INET;
    to.sin_port = htons(port_of(address));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  }
  ~RawConnection() { ::close(socket_); }
  RawConnection(const RawConnection&) = delete;
  RawConnection& operator=(const RawConnection&) = delete;

  void send(const std::string& bytes) const {
    ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }
  // The status of the answer, 0 if there is none.
  [[nodiscard]] int status() const {
    const timeval patience = {60, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    std::array<char, 4096> buffer{};
    std::string reply;
    ssize_t got = 0;
    while (reply.size() <= 12 && (got = ::recv(socket_, buffer.data(), buffer.size(), 0)) > 0) {
      reply.append(buffer.data(), static_cast<std::size_t>(got));
    }
    return reply.size() > 12 ? std::atoi(reply.c_str() + 9) : 0;
  }
  // The server has closed it. What it said before is read and forgotten.
  static bool has_ended(const std::unique_ptr<RawConnection>& connection) {
    std::array<char, 4096> buffer{};
    ssize_t got = 0;
    while ((got = ::recv(connection->socket_, buffer.data(), buffer.size(), MSG_DONTWAIT)) > 0) {
    }
    return got == 0 || errno != EAGAIN;
  }

 private:
  int socket_;
};

// The status of the answer to `bytes`, 0 if there is none.
inline int raw_status(const std::string& address, const std::string& bytes) {
  const RawConnection connection(address);
  connection.send(bytes);
  return connection.status();
}

}  // namespace pinchlab::study
