// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/stability/border.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pinchlab::experiments::stability {

namespace {

/// One result a value of x, the worst of them, in order of x.
std::vector<Result> worst_of_each_x(std::vector<Result> results) {
  std::stable_sort(results.begin(), results.end(),
                   [](const Result& a, const Result& b) { return a.x < b.x; });
  std::vector<Result> worst;
  for (const Result& result : results) {
    if (worst.empty() || worst.back().x != result.x) {
      worst.push_back(result);
    } else if (result.verdict.severity > worst.back().verdict.severity) {
      worst.back() = result;
    }
  }
  return worst;
}

}  // namespace

std::string value_text(double x) {
  if (std::isinf(x)) return "infinite";
  if (x != 0.0 && (std::abs(x) >= 1e5 || std::abs(x) < 1e-3)) {
    const double power = std::floor(std::log10(std::abs(x)) + 1e-9);
    return fmt::format("{:.2g}e{:.0f}", x / std::pow(10.0, power), power);
  }
  return std::abs(x) >= 1000.0 ? fmt::format("{:.0f}", x) : fmt::format("{:.3g}", x);
}

std::string border_text(std::vector<Result> results) {
  const std::vector<Result> all = worst_of_each_x(std::move(results));
  const auto holds = [](const Result& r) { return !r.verdict.failed(); };
  const auto kind = [](const Result& r) { return to_string(r.verdict.worst); };
  const auto count = std::count_if(all.begin(), all.end(), holds);
  if (count == static_cast<std::ptrdiff_t>(all.size())) return "all";
  if (count == 0) return fmt::format("none ({})", kind(all.front()));
  const auto first = std::find_if(all.begin(), all.end(), holds);
  const auto beyond = std::find_if_not(first, all.end(), holds);
  if (beyond - first != count) {
    const auto failed = std::find_if_not(all.begin(), all.end(), holds);
    return fmt::format("{} of {} ({}: {})", count, all.size(), value_text(failed->x),
                       kind(*failed));
  }
  const std::string from = value_text(first->x);
  if (beyond == all.end()) {
    return fmt::format("from {} ({}: {})", from, value_text((first - 1)->x), kind(*(first - 1)));
  }
  const std::string to = value_text((beyond - 1)->x);
  if (first == all.begin()) {
    return fmt::format("up to {} ({}: {})", to, value_text(beyond->x), kind(*beyond));
  }
  return fmt::format("{} to {} ({})", from, to, kind(*beyond));
}

}  // namespace pinchlab::experiments::stability
