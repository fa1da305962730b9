// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <string>

namespace pinchlab::study {

/// A token bucket for each address (RFC 2697's idea): `per_second` requests in the long run,
/// `burst` at once. Remembers at most `most_addresses`; beyond those, all others share one bucket.
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;

  RateLimit(double per_second, double burst, std::size_t most_addresses = 10000)
      : per_second_(per_second), burst_(burst), most_addresses_(most_addresses) {}

  bool allows(const std::string& address, Clock::time_point now) {
    const std::scoped_lock lock(mutex_);
    const bool is_known = buckets_.contains(address) || buckets_.size() < most_addresses_;
    Bucket& bucket =
        buckets_.try_emplace(is_known ? address : "", Bucket{burst_, now}).first->second;
    const double passed = std::chrono::duration<double>(now - bucket.last).count();  // s
    bucket.left = std::min(burst_, bucket.left + passed * per_second_);
    bucket.last = now;
    if (bucket.left < 1) {
      return false;
    }
    bucket.left -= 1;
    return true;
  }

 private:
  struct Bucket {
    double left;
    Clock::time_point last;
  };

  double per_second_, burst_;
  std::size_t most_addresses_;
  std::mutex mutex_;
  std::map<std::string, Bucket> buckets_;
};

}  // namespace pinchlab::study
