// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/did_you_mean.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace pinchlab {
namespace {

// Optimal string alignment distance: insertions, deletions, substitutions and swaps of neighbours.
std::size_t typing_errors(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    row[j] = j;
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = row[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      next[j] = std::min({row[j] + 1, next[j - 1] + 1, substituted});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        next[j] = std::min(next[j], before[j - 2] + 1);
      }
    }
    before = row;
    row = next;
  }
  return row.back();
}

}  // namespace

std::string nearest_word(std::string_view word, std::span<const std::string> known) {
  constexpr std::size_t longest = 64;  // bytes; a longer word was not meant to be one of ours
  if (word.empty() || word.size() > longest) {
    return "";
  }
  for (const std::string& candidate : known) {
    if (candidate.starts_with(std::string(word) + "_")) {
      return candidate;
    }
  }
  std::string best;
  std::size_t fewest = word.size() <= 3 ? 2 : std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : known) {
    if (candidate.size() > longest) {
      continue;
    }
    const std::size_t errors = typing_errors(word, candidate);
    if (errors < fewest && errors < std::min(word.size(), candidate.size())) {
      fewest = errors;
      best = candidate;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string> known) {
  const std::string nearest = nearest_word(word, known);
  return nearest.empty() ? "" : fmt::format(" (did you mean `{}`?)", nearest);
}

}  // namespace pinchlab
