// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/http.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <memory>
#include <regex>

namespace pinchlab::study {
namespace {

std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_whole = problem == std::errc() && end == text.data() + text.size();
  return is_whole ? std::optional(number) : std::nullopt;
}

bool is_port(const std::string& text) {
  const auto port = whole_number(text);
  return port && *port <= 65535;
}

bool is_ip_address(const std::string& text, int family) {
  std::array<unsigned char, 16> bytes{};
  return ::inet_pton(family, text.c_str(), bytes.data()) == 1;
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string own_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? lower(name.data()) : "";
}

}  // namespace

std::optional<ByteRange> byte_range(const std::string& header, std::uint64_t size) {
  constexpr std::string_view unit = "bytes=";
  const std::size_t dash = header.find('-');
  if (!header.starts_with(unit) || dash == std::string::npos || size == 0) {
    return std::nullopt;
  }
  const std::string begin = header.substr(unit.size(), dash - unit.size());
  const std::string end = header.substr(dash + 1);
  const auto first = whole_number(begin), last = whole_number(end);
  if (begin.empty()) {  // the last bytes, so many
    return last && *last > 0 ? std::optional(ByteRange(size - std::min(*last, size), size - 1))
                             : std::nullopt;
  }
  if (!first || (!last && !end.empty()) || *first >= size || (last && *last < *first)) {
    return std::nullopt;
  }
  return ByteRange(*first, std::min(last.value_or(size - 1), size - 1));
}

bool is_host_name(const std::string& text) {
  static const std::regex labels(R"([a-z0-9]([a-z0-9-]{0,61}[a-z0-9])?)", std::regex::icase);
  if (text.size() > 253) return false;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('.', begin), text.size());
    if (!std::regex_match(text.substr(begin, end - begin), labels)) return false;
    begin = end + 1;
  }
  return true;
}

bool is_our_host(const std::string& header, const std::vector<std::string>& names) {
  std::string host = lower(header);
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    const bool is_whole =
        end != std::string::npos &&
        (end + 1 == host.size() || (host[end + 1] == ':' && is_port(host.substr(end + 2))));
    return is_whole && is_ip_address(host.substr(1, end - 1), AF_INET6);
  }
  if (const std::size_t colon = host.find(':'); colon != std::string::npos) {
    if (!is_port(host.substr(colon + 1))) {
      return false;
    }
    host.resize(colon);
  }
  if (host.empty()) {
    return false;
  }
  const std::string own = own_name();
  return is_ip_address(host, AF_INET) || host == "localhost" || host == own ||
         host == own + ".local" ||
         std::ranges::any_of(names, [&](const std::string& name) { return lower(name) == host; });
}

std::string openable_host(const std::string& host) {
  if (host != "0.0.0.0" && host != "::") {
    return host;
  }
  ifaddrs* list = nullptr;
  const int failed = ::getifaddrs(&list);
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> all(failed == 0 ? list : nullptr,
                                                         &::freeifaddrs);
  for (const ifaddrs* entry = all.get(); entry != nullptr; entry = entry->ifa_next) {
    const bool is_up = (entry->ifa_flags & IFF_UP) != 0 && (entry->ifa_flags & IFF_LOOPBACK) == 0;
    if (is_up && entry->ifa_addr != nullptr && entry->ifa_addr->sa_family == AF_INET) {
      const auto* address = reinterpret_cast<const sockaddr_in*>(entry->ifa_addr);
      std::array<char, INET_ADDRSTRLEN> text{};
      ::inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size());
      return text.data();
    }
  }
  return "127.0.0.1";
}

}  // namespace pinchlab::study
