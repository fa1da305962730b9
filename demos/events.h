// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What happens in a simulation, in words: which cables are pinched, slack or wrapped, and what
// touches, from when to when.

#include <map>
#include <string>
#include <vector>

#include "sim/world.h"

namespace pinchlab {

/// Something that holds for a while.
struct Event {
  std::string what;           ///< e.g. "rope pinched between drum and left"
  double from = 0.0, to = 0;  ///< s, ends of the first and the last step in which it holds
};

/// Watches a world step by step.
class EventWatch {
 public:
  explicit EventWatch(const Scene& scene) : scene_(scene) {}

  /// To be called at the start and after every step, in order.
  void look(const World& world, double time);

  /// What was seen so far, in order of its beginning. What ceases for less than `shortest_break` is
  /// one event: a body that bounces on a cable does not begin to pinch it again and again.
  std::vector<Event> events() const;

  static constexpr double shortest_break = 0.25;  ///< s

 private:
  void hold(const std::string& what, double time);
  void hold_pinch(const std::string& cable, int body, int other, double time);
  std::string name_of_other(const World& world, const Contact& contact) const;
  void look_at_cable(const World& world, std::size_t cable, double time);

  const Scene& scene_;
  std::map<std::string, std::vector<Event>> seen_;  // by what
};

}  // namespace pinchlab
