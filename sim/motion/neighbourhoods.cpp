// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/neighbourhoods.h"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/strung.h"
#include "sim/detect/contacts.h"
#include "sim/detect/span_hits.h"
#include "sim/lines.h"
#include "sim/motion/interval.h"
#include "sim/trees.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// Where a body may get to in a step from its start, at twice its speed.
Reach reach_of(const Scene& scene, const World& world, const Start& start, int body) {
  constexpr double room = 1.02;  // contacts are looked for somewhat further than bodies reach
  const double h = world.step_length;
  Reach reach{body, at(start.position, body), room * at(world.bodies, body).radius};
  if (is_static(at(world.bodies, body))) return reach;
  reach.radius += 2.0 * h * (at(start.velocity, body).norm() + scene.gravity.norm() * h);
  return reach;
}

/// The same of a link, with its cable: what comes upon that from outside is off by all of its
/// width.
Reach reach_of(const Scene& scene, const World& world, const Start& start, const CableState& cable,
               const Link& link) {
  if (link.body < 0) return {-1, link.offset, cable.half_width};
  Reach reach = reach_of(scene, world, start, link.body);
  reach.radius += 2.0 * cable.half_width + link.offset.norm();
  return reach;
}

/// Joins the parts of bodies that may reach the span with the part of its cable.
void join_at_span(const Parts& parts, Neighbourhoods& near, int part, const Reach& tail,
                  const Reach& head, double longest) {
  const double width = std::max(tail.radius, head.radius);
  const double low = std::min(tail.centre.x(), head.centre.x()) - width;
  const double high = std::max(tail.centre.x(), head.centre.x()) + width;
  auto it = std::lower_bound(near.reaches.begin(), near.reaches.end(), low - longest,
                             [](const Reach& r, double x) { return r.centre.x() - r.radius < x; });
  for (; it != near.reaches.end() && it->centre.x() - it->radius <= high; ++it) {
    const int other = at(parts.of_body, it->body);
    if (other == part || find_root(near.root, other) == find_root(near.root, part)) continue;
    if (distance_from_line(tail.centre, head.centre, it->centre) > width + it->radius) continue;
    join(near.root, part, other);
  }
}

/// Joins what spans and bodies may meet.
void join_at_spans(const Scene& scene, const World& world, const Workspace& work,
                   Neighbourhoods& near) {
  if (world.cables.empty()) return;
  near.reaches.clear();
  double longest = 0.0;
  for (int b = 0; index(b) < world.bodies.size(); ++b) {
    if (is_static(at(world.bodies, b)) || !meets_spans(at(world.bodies, b))) continue;
    near.reaches.push_back(reach_of(scene, world, work.start, b));
    longest = std::max(longest, 2.0 * near.reaches.back().radius);
  }
  std::sort(near.reaches.begin(), near.reaches.end(), [](const Reach& p, const Reach& q) {
    const double low_p = p.centre.x() - p.radius, low_q = q.centre.x() - q.radius;
    return low_p != low_q ? low_p < low_q : p.body < q.body;
  });
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    const CableState& cable = world.cables[c];
    if (is_passed(cable)) continue;
    for (std::size_t s = first_segment(cable); s < cable.segments.size(); ++s) {
      const Link& to = cable.links[s];
      const Link& from = cable.links[index(previous_link(cable, static_cast<int>(s)))];
      if (is_side(from, to)) continue;
      join_at_span(work.parts, near, work.parts.of_cable[c],
                   reach_of(scene, world, work.start, cable, from),
                   reach_of(scene, world, work.start, cable, to), longest);
    }
  }
}

/// Of two that touch, one static: notes the other in Neighbourhoods::over, joined with those that
/// touched it before.
void note_over(const Parts& parts, int a, int b, Neighbourhoods& near) {
  const int first = at(parts.of_body, a), second = at(parts.of_body, b);
  if ((first < 0) == (second < 0)) return;
  int& over = at(near.over, first < 0 ? a : b);
  const int part = std::max(first, second);
  if (over >= 0) join(near.root, over, part);
  over = part;
}

/// Joins what was so noted with the parts of all cables that run over the static body.
void join_cables_over(const World& world, const Parts& parts, Neighbourhoods& near) {
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    for (const Link& link : world.cables[c].links) {
      if (link.body < 0 || link.orientation == 0 || at(near.over, link.body) < 0) continue;
      join(near.root, at(near.over, link.body), parts.of_cable[c]);
    }
  }
}

void separate_all(const Parts& parts, std::vector<int>& root) {
  root.resize(parts.list.size());
  std::iota(root.begin(), root.end(), 0);
}

/// Lists the items 0 .. items - 1 by their number(item), below `count`, in their order; those of -1
/// in none.
template <class NumberOf>
void list_by_number(std::size_t count, std::size_t items, NumberOf number, Lists<int>& lists) {
  lists.begin.assign(count + 1, 0);
  const int end = static_cast<int>(items);
  for (int i = 0; i < end; ++i) {
    if (const int n = number(i); n >= 0) ++at(lists.begin, n);
  }
  std::partial_sum(lists.begin.begin(), lists.begin.end(), lists.begin.begin());
  lists.items.resize(index(lists.begin.back()));
  for (int i = end - 1; i >= 0; --i) {
    if (const int n = number(i); n >= 0) at(lists.items, --at(lists.begin, n)) = i;
  }
}

/// Numbers the neighbourhoods, in `over` by their roots; how many there are.
int number_trees(const Parts& parts, Neighbourhoods& near) {
  near.over.assign(parts.list.size(), -1);
  int count = 0;
  for (int p = 0; index(p) < parts.list.size(); ++p) {
    int& number = at(near.over, find_root(near.root, p));
    if (number < 0) number = count++;
  }
  return count;
}

/// Joins the parts, each within its neighbourhood, that may come to be one by the pairs that there
/// are.
void join_by_pairs(const Scene& scene, const World& world, const Workspace& work,
                   Neighbourhoods& near) {
  const Parts& parts = work.parts;
  const BroadPhase& broad = work.broad_phase;
  separate_all(parts, near.root);
  const auto join_parts = [&](int p, int q) {
    if (p < 0 || q < 0 || p == q) return;
    const Part &one = at(parts.list, p), &other = at(parts.list, q);
    if (number_of(near, parts, one) == number_of(near, parts, other)) join(near.root, p, q);
  };
  near.over.assign(world.bodies.size(), -1);
  const double width = widest_cable(world);
  for (const BodyPair& pair : broad.body_pairs) {
    if (!may_touch(scene, world, width, pair)) continue;
    join_parts(at(parts.of_body, pair.a), at(parts.of_body, pair.b));
    note_over(parts, pair.a, pair.b, near);
  }
  for (const PiecePair& pair : broad.piece_pairs) {
    if (pair.body < 0 || !may_touch(scene, world, pair)) continue;
    join_parts(at(parts.of_cable, pair.cable), at(parts.of_body, pair.body));
  }
  for (const SpanPair& pair : broad.span_pairs) {
    if (!may_meet(world, pair)) continue;
    join_parts(at(parts.of_cable, pair.cable), at(parts.of_body, pair.body));
  }
  join_cables_over(world, parts, near);
}

}  // namespace

double Neighbourhoods::left_of(int body) const {
  return at(list, at(of_body, body)).left;
}

bool Neighbourhoods::separate_bodies(int body, int other) const {
  if (!divided) return false;
  const int a = at(of_body, body), b = at(of_body, other);
  return a >= 0 && b >= 0 && a != b;
}

bool Neighbourhoods::separate_from_cable(int body, int cable) const {
  if (!divided) return false;
  const int a = at(of_body, body), b = at(of_cable, cable);
  return a >= 0 && b >= 0 && a != b;
}

void Neighbourhoods::follow(int body, int cable) {
  if (!of_body.empty()) at(of_body, body) = at(of_cable, cable);
}

void keep_start(const World& world, Workspace& work) {
  StepStart& kept = work.step_start;
  kept.start = work.start;
  kept.first_link = work.first_link;
  kept.cables = world.cables;
  kept.changes = world.changes;
  kept.contacts = world.contacts;
  kept.still_steps = world.still_steps;
  kept.pace = world.pace;
  kept.diagnostics = world.diagnostics;
}

void take_back(World& world, Workspace& work) {
  StepStart& kept = work.step_start;
  world.position = kept.start.position;  // of what has been woken, too
  world.velocity = kept.start.velocity;
  world.angle = kept.start.angle;
  world.angular_velocity = kept.start.angular_velocity;
  world.cables = kept.cables;
  world.changes = kept.changes;
  world.contacts = kept.contacts;
  world.still_steps = kept.still_steps;
  world.pace = kept.pace;
  world.diagnostics = kept.diagnostics;
  for (const int c : world.strung) sort_nodes(world, at(world.cables, c));
  Workspace fresh;
  fresh.start = kept.start;
  fresh.first_link = kept.first_link;
  fresh.before = std::move(work.before);
  work = std::move(fresh);
  find_parts(world, work);
  put_together(world, work.parts, work.neighbourhoods);
  go_back(world, work, work.neighbourhoods.parts.items);
}

int number_of(const Neighbourhoods& near, const Parts& parts, const Part& part) {
  if (!near.divided) return 0;
  if (part.bodies_begin < part.bodies_end) {
    return at(near.of_body, at(parts.bodies, part.bodies_begin));
  }
  return at(near.of_cable, at(parts.cables, part.cables_begin));
}

void put_together(const World& world, Parts& parts, Neighbourhoods& near) {
  near.of_body.clear();
  near.of_cable.clear();
  const bool stands = near.list.size() == 1 && !near.divided && !parts.changed;
  near.divided = near.crossed = false;
  near.list.assign(1, {world.step_length, world.time()});
  if (!stands) list_parts(parts, near);
  near.moving = near.parts.items;
}

bool divide(const Scene& scene, const World& world, Workspace& work) {
  Neighbourhoods& near = work.neighbourhoods;
  Parts& parts = work.parts;
  if (near.parts.items.size() < 2) return false;
  separate_all(parts, near.root);
  near.over.assign(world.bodies.size(), -1);
  for (const Contact& contact : world.contacts) {
    if (contact.b >= 0) note_over(parts, contact.a, contact.b, near);
  }
  join_cables_over(world, parts, near);
  join_at_spans(scene, world, work, near);
  const int count = number_trees(parts, near);
  if (count < 2) return false;
  near.list.assign(index(count), near.list.front());
  near.divided = true;
  const auto of_part = [&near](int part) {
    return part < 0 ? -1 : at(near.over, find_root(near.root, part));
  };
  near.of_body.resize(world.bodies.size());
  near.of_cable.resize(world.cables.size());
  std::transform(parts.of_body.begin(), parts.of_body.end(), near.of_body.begin(), of_part);
  std::transform(parts.of_cable.begin(), parts.of_cable.end(), near.of_cable.begin(), of_part);
  list_parts(parts, near);
  for (int n = 0; n < count; ++n) {
    if (parts_of(near, n).empty()) at(near.list, n).left = 0.0;  // asleep
  }
  return true;
}

void find_unlike(const Scene& scene, const World& world, Workspace& work, int number) {
  Neighbourhoods& near = work.neighbourhoods;
  near.unlike.clear();
  const std::span<const int> own = parts_of(near, number);
  const auto lag_of = [&](int p) { return pace_of(world, work.parts, at(work.parts.list, p)).lag; };
  const double lag = lag_of(own.front());
  if (std::ranges::all_of(own.subspan(1), [&](int p) { return lag_of(p) == lag; })) return;
  join_by_pairs(scene, world, work, near);
  // Of each tree its first part, or that its parts differ.
  constexpr int differ = -2;
  near.over.assign(work.parts.list.size(), -1);
  for (const int p : own) {
    int& first = at(near.over, find_root(near.root, p));
    if (first == -1) first = p;
    if (first != differ && lag_of(p) != lag_of(first)) first = differ;
  }
  std::copy_if(own.begin(), own.end(), std::back_inserter(near.unlike),
               [&](int p) { return at(near.over, find_root(near.root, p)) == differ; });
}

void list_events(const Workspace& work, Neighbourhoods& near) {
  const auto number = [&](int e) {
    const Happening& event = at(work.events, e);
    const int part = event.part >= 0 ? event.part : at(work.parts.of_cable, event.cable);
    return number_of(near, work.parts, at(work.parts.list, part));
  };
  list_by_number(near.list.size(), work.events.size(), number, near.events);
}

void list_parts(Parts& parts, Neighbourhoods& near) {
  parts.changed = false;
  if (near.list.size() == 1) {
    near.parts.items.clear();
    for (int p = 0; index(p) < parts.list.size(); ++p) {
      Part& part = at(parts.list, p);
      part.waits = near.divided && !near.list.front().moved;
      if (!part.asleep) near.parts.items.push_back(p);
    }
    near.parts.begin.assign({0, static_cast<int>(near.parts.items.size())});
    near.moving = near.parts.items;
    return;
  }
  std::vector<int>& number = near.over;
  number.clear();
  for (Part& part : parts.list) {
    const int n = number_of(near, parts, part);
    part.waits = near.divided && !at(near.list, n).moved;
    number.push_back(part.asleep ? -1 : n);
  }
  list_by_number(
      near.list.size(), number.size(), [&](int p) { return at(number, p); }, near.parts);
  near.moving = near.parts.items;
}

Neighbourhood course_of(const Neighbourhoods& near, const Parts& parts, const Part& part) {
  Neighbourhood all;
  const auto add = [&all, &near](int number) {
    const Neighbourhood& one = at(near.list, number);
    all.time = std::max(all.time, one.time);
    all.events = std::max(all.events, one.events);
    all.happened = all.happened || one.happened;
    all.violated = all.violated || one.violated;
  };
  for (const int b : bodies_of(parts, part)) add(at(near.of_body, b));
  for (const int c : cables_of(parts, part)) add(at(near.of_cable, c));
  return all;
}

}  // namespace pinchlab
