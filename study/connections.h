// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace pinchlab::study {

/// Which connections there may be: so many in all and so many of one address. One more than that
/// takes the place of the one that has waited longest for a whole request, so that connections that
/// are only held open shut nobody out. Not for several threads.
class Connections {
 public:
  using Id = std::uint64_t;
  struct Admission {
    bool is_admitted = false;
    std::optional<Id> closed;  ///< the connection that has to go for it
  };

  Connections(std::size_t most, std::size_t most_of_address)
      : most_(most), most_of_address_(most_of_address) {}

  /// A new connection, which waits for its first request.
  Admission add(Id id, const std::string& address) {
    Admission admission;
    if (of_address(address) >= most_of_address_) {
      admission.closed = longest_waiting(address);
    } else if (connections_.size() >= most_) {
      admission.closed = longest_waiting(busiest_address());
    }
    const bool is_full = of_address(address) >= most_of_address_ || connections_.size() >= most_;
    if (is_full && !admission.closed) {
      return admission;
    }
    if (admission.closed) {
      remove(*admission.closed);
    }
    admission.is_admitted = true;
    connections_[id].address = address;
    waits(id);
    ++addresses_[address].count;
    return admission;
  }

  /// Waits for a request, and its time begins. One that has been removed is not known any more.
  void waits(Id id) {
    const auto found = connections_.find(id);
    if (found != connections_.end()) {
      works(id);
      found->second.since = ++now_;
      addresses_[found->second.address].waiting[now_] = id;
    }
  }

  /// Has a whole request, and will not be closed for another.
  void works(Id id) {
    const auto found = connections_.find(id);
    if (found != connections_.end()) {
      addresses_[found->second.address].waiting.erase(found->second.since);
    }
  }

  void remove(Id id) {
    const auto found = connections_.find(id);
    if (found == connections_.end()) {
      return;
    }
    works(id);
    const auto address = addresses_.find(found->second.address);
    if (--address->second.count == 0) {
      addresses_.erase(address);
    }
    connections_.erase(found);
  }

  [[nodiscard]] std::size_t size() const { return connections_.size(); }

 private:
  struct Connection {
    std::string address;
    std::uint64_t since = 0;
  };
  struct Address {
    std::size_t count = 0;
    std::map<std::uint64_t, Id> waiting;  // by the time that it waits since
  };

  [[nodiscard]] std::size_t of_address(const std::string& address) const {
    const auto found = addresses_.find(address);
    return found == addresses_.end() ? 0 : found->second.count;
  }
  [[nodiscard]] std::optional<Id> longest_waiting(const std::string& address) const {
    const auto found = addresses_.find(address);
    return found == addresses_.end() || found->second.waiting.empty()
               ? std::nullopt
               : std::optional(found->second.waiting.begin()->second);
  }
  [[nodiscard]] std::string busiest_address() const {
    const auto busiest = std::ranges::max_element(
        addresses_, {}, [](const auto& entry) { return entry.second.waiting.size(); });
    return busiest == addresses_.end() ? "" : busiest->first;
  }

  std::size_t most_, most_of_address_;
  std::uint64_t now_ = 0;
  std::map<Id, Connection> connections_;
  std::map<std::string, Address> addresses_;
};

}  // namespace pinchlab::study
