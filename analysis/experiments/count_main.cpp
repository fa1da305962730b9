// SPDX-License-Identifier: GPL-3.0-or-later
// What `pinchlab bench instructions` runs under valgrind: steps, with nothing around them. It links
// no library but the simulator's, since valgrind does not know the instructions of every other.
//   pinchlab_steps scene NUMBER STEPS
//   pinchlab_steps growing NUMBER SIZE CALLS

#include <fmt/format.h>

#include <charconv>
#include <exception>
#include <span>
#include <string_view>
#include <vector>

#include "analysis/experiments/counted_scenes.h"

namespace {

/// Whole numbers, all of them; else nothing.
std::vector<int> numbers(std::span<char*> words) {
  std::vector<int> found;
  for (const std::string_view word : words) {
    int number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size()) return {};
    found.push_back(number);
  }
  return found;
}

bool run(std::string_view what, const std::vector<int>& of) {
  using namespace pinchlab::experiments;
  if (what == "scene" && of.size() == 2) return step_scene(of[0], of[1]);
  if (what == "growing" && of.size() == 3) return step_growing_scene(of[0], of[1], of[2]);
  return false;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::span words(argv, static_cast<std::size_t>(argc));
  if (argc >= 2 && run(words[1], numbers(words.subspan(2)))) return 0;
  fmt::print(stderr,
             "usage: pinchlab_steps scene NUMBER STEPS\n"
             "       pinchlab_steps growing NUMBER SIZE CALLS\n"
             "Scenes are those of pinchlab bench instructions, from 0 on.\n");
  return 2;
} catch (const std::exception& failure) {
  fmt::print(stderr, "{}\n", failure.what());
  return 1;
}
