// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/events.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/at.h"
#include "sim/cable/cable.h"

namespace pinchlab {

void EventWatch::hold(const std::string& what, double time) {
  std::vector<Event>& times = seen_[what];
  if (times.empty() || time - times.back().to > shortest_break) times.push_back({what, time, time});
  times.back().to = time;
}

void EventWatch::hold_pinch(const std::string& cable, int body, int other, double time) {
  const std::string &a = at(scene_.bodies, body).name, &b = at(scene_.bodies, other).name;
  hold(fmt::format("{} pinched between {} and {}", cable, std::min(a, b), std::max(a, b)), time);
}

void EventWatch::look_at_cable(const World& world, std::size_t c, double time) {
  const CableState& cable = world.cables[c];
  if (cable.joint == Joint::stop && cable.segments[1].tension > 0.0) {
    hold(fmt::format("{} at its stop", at(scene_.bodies, cable.links[1].body).name), time);
  }
  if (cable.joint != Joint::none) return;
  const std::string& name = scene_.cables[c].name;
  const auto body = [&](std::size_t link) -> const std::string& {
    return at(scene_.bodies, cable.links[link].body).name;
  };
  const std::size_t count = cable.links.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Link& link = cable.links[i];
    if (link.orientation != 0 && !link.pinch_middle) {
      hold(fmt::format("{} runs round {}", name, body(i)), time);
    }
    if (i < first_segment(cable)) continue;
    const std::size_t before = i == 0 ? count - 1 : i - 1;
    const Segment& segment = cable.segments[i];
    // (A winch's rope ends on the body that it is wound on: no pinch.)
    const int from = cable.links[before].body;
    if (segment.pinched && link.body >= 0 && from >= 0 && from != link.body) {
      hold_pinch(name, from, link.body, time);
    }
    // Slack that shows: by half a cable's width.
    if (!segment.pinched && segment.rest_length - segment.length > cable.half_width) {
      hold(fmt::format("{} slack", name), time);
    }
  }
}

std::string EventWatch::name_of_other(const World& world, const Contact& contact) const {
  if (contact.b >= 0) return at(scene_.bodies, contact.b).name;
  const int cable = at(world.obstacles, contact.wall).cable;
  if (cable < 0) return "a wall";
  return fmt::format("the end of {}", at(scene_.cables, cable).name);
}

void EventWatch::look(const World& world, double time) {
  for (std::size_t c = 0; c < world.cables.size(); ++c) look_at_cable(world, c, time);
  for (const Contact& contact : world.contacts) {
    const bool struck = contact.struck >= 0 && contact.struck == world.step - 1;
    if (struck && contact.cable_between >= 0 && contact.b >= 0) {
      hold_pinch(at(scene_.cables, contact.cable_between).name, contact.a, contact.b, time);
      continue;
    }
    if (!struck && (!contact.touching || contact.pinch_points > 0)) continue;
    const std::string& a = at(scene_.bodies, contact.a).name;
    hold(fmt::format("{} touches {}", a, name_of_other(world, contact)), time);
  }
}

std::vector<Event> EventWatch::events() const {
  std::vector<Event> all;
  for (const auto& [what, times] : seen_) all.insert(all.end(), times.begin(), times.end());
  std::ranges::stable_sort(all, {}, &Event::from);
  return all;
}

}  // namespace pinchlab
