// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What goes over HTTP, without the library that brings it there.

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pinchlab::study {

struct HttpRequest {
  std::string method;                          ///< "GET"
  std::string path;                            ///< as sent, without the query
  std::string address;                         ///< who asks: an IP address
  std::map<std::string, std::string> headers;  ///< by name in lower case
  std::string body;

  [[nodiscard]] std::string header(const std::string& name) const {
    const auto found = headers.find(name);
    return found == headers.end() ? "" : found->second;
  }
};

struct HttpReply {
  int status = 200;
  std::string type;  ///< of the body, as in Content-Type
  std::vector<std::pair<std::string, std::string>> headers;
  std::string body;

  /// Instead of a body in memory: `length` bytes that are read as they are sent.
  std::uint64_t length = 0;
  std::function<std::string(std::uint64_t offset, std::size_t length)> read;
};

/// First and last byte of a part.
using ByteRange = std::pair<std::uint64_t, std::uint64_t>;

/// The part that a Range header asks for of `size` bytes (RFC 9110, 14.1.2); none where there is no
/// such part, or more than one is asked for.
std::optional<ByteRange> byte_range(const std::string& header, std::uint64_t size);

/// Can this be the name of a computer: labels of letters, digits and - with dots between (RFC 1123,
/// 2.1)?
bool is_host_name(const std::string& text);

/// Is this the Host header of somebody who means this computer: an IP address, localhost, its own
/// name, or one of `names`? Any other is that of a page elsewhere whose name was made to point here
/// (DNS rebinding).
bool is_our_host(const std::string& header, const std::vector<std::string>& names);

/// Where a server that listens on `host` can be opened: for 0.0.0.0 and :: this computer's address
/// in its network, or its own loopback where it has none; others as they are.
std::string openable_host(const std::string& host);

}  // namespace pinchlab::study
