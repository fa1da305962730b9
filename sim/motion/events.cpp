// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/events.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/held_spans.h"
#include "sim/cable/joins.h"
#include "sim/cable/links.h"
#include "sim/cable/strung.h"
#include "sim/cable/taking_in.h"
#include "sim/detect/detect.h"
#include "sim/detect/span_hits.h"
#include "sim/motion/clearance.h"
#include "sim/motion/jumps.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

auto key_of(const Happening& e) {
  return std::tie(e.kind, e.part, e.row, e.cable, e.item, e.body, e.corner);
}

/// The event of earlier trials that has that key, or null. In one trial every key is measured once.
Happening* find(Workspace& work, const Happening& key) {
  const std::vector<int>& known = work.known_events;
  const auto it = std::lower_bound(
      known.begin(), known.end(), key,
      [&work](int e, const Happening& k) { return key_of(at(work.events, e)) < key_of(k); });
  if (it == known.end() || key_of(at(work.events, *it)) != key_of(key)) return nullptr;
  return &at(work.events, *it);
}

/// Takes a node in, and the cable off a rim beside it where the node had bent it away from that.
/// Both happen at once, so that what lies within these bends is in the way of the span that closes
/// up. Returns the least number of a link that has changed; -1: any may have.
int take_in(World& world, Workspace& work, int number, int node) {
  CableState& cable = at(world.cables, number);
  const Vec2 over = link_centre(world, at(cable.links, node));
  const std::size_t links = cable.links.size();
  take_in_node(world, cable, node);
  if (cable.links.size() + 1 != links) return node - 1;  // the rims beside it are one
  const std::size_t closed_up = index(node) % cable.links.size();
  const int before = previous_link(cable, static_cast<int>(closed_up));
  int met = meet_in_closing(world, work, number, closed_up, over);
  const int after = static_cast<int>(closed_up) + (closed_up > 0 ? met : 0);
  const auto leave = [&](int rim) {
    if (!has_come_off(cable, index(rim))) return false;
    const Vec2 point = at(cable.segments, rim).head;
    const std::size_t now = cable.links.size();
    take_off(world, work, number, rim);
    if (cable.links.size() + 1 == now) {
      met += meet_in_closing(world, work, number, index(rim) % cable.links.size(), point);
    }
    return true;
  };
  // The later one first, whose going leaves the number of the other.
  const bool wraps_round = before > after;
  leave(wraps_round ? before : after);
  const bool left = leave(wraps_round ? after : before);
  if (met > 0 && take_in_enclosed_nodes(world, cable)) return -1;
  return left && !wraps_round ? before : node;
}

/// Moors, takes in or casts off a node beside a rim. Returns what take_in does.
int let_rim_have(World& world, Workspace& work, int number, int node) {
  CableState& cable = at(world.cables, number);
  if (!at(cable.links, node).moored) {
    if (!is_to_be_moored(cable, node)) return take_in(world, work, number, node);
    moor_node(world, cable, node);
    return node;
  }
  if (!is_to_be_cast_off(world, cable, node)) return take_in(world, work, number, node);
  work.neighbourhoods.follow(cast_off_node(world, cable, node), number);
  return node;
}

/// Frees a node before and after one that a rim is to have, so that the finest pieces are beside
/// the rim. Where that one is now.
int free_beside(World& world, Workspace& work, int number, int node) {
  CableState& cable = at(world.cables, number);
  const auto free = [&](int segment, int count) {
    split_span(world, cable, index(segment), count);
    work.neighbourhoods.follow(at(cable.links, segment).body, number);
    ++world.diagnostics.node_changes;
  };
  if (is_held(cable, index(node) + 1)) free(node + 1, 1);
  if (!is_held(cable, index(node))) return node;
  free(node, held_at(cable, index(node)).pieces - 1);
  return node + 1;
}

}  // namespace

int located_events(const World& world) {
  int events = 48;
  for (const int c : world.strung) events += 4 * at(world.cables, c).nodes;
  return events;
}

void begin_trial(Workspace& work) {
  std::vector<int>& known = work.known_events;
  known.resize(work.events.size());
  std::iota(known.begin(), known.end(), 0);
  std::sort(known.begin(), known.end(), [&work](int p, int q) {
    return key_of(at(work.events, p)) < key_of(at(work.events, q));
  });
  for (Happening& event : work.events) event.seen = false;
}

void measure(Workspace& work, const Happening& key, double clearance, double late) {
  Happening* event = find(work, key);
  if (!event && clearance >= -late) return;
  if (!event) event = &work.events.emplace_back(key);
  event->clearance = clearance;
  event->seen = true;
}

namespace {

/// A part's event of that kind.
Happening event_of(EventKind kind, int part, const PartSystem& s) {
  Happening event{kind};
  event.part = part;
  event.reach = s.reach;
  return event;
}

/// The catch of a row that idles, or of one that stretches and lets go.
void find_catch(World& world, Workspace& work, int number, const PartSystem& s, int r,
                bool releases) {
  const CapstanScratch& capstan = work.solve.capstan;
  const Row& row = at(s.rows, r);
  if (row.kind == RowKind::tangent || row.kind == RowKind::pinch_middle) return;
  const bool in_group =
      row.kind == RowKind::segment && !capstan.runs.empty() && at(capstan.group_of_row, r) >= 0;
  if (in_group) return;
  double clearance = releases ? -clearance_of(world, row) : clearance_of(world, row);
  const double late = !releases && row.clearance > s.reach ? -s.reach : 0.5 * s.reach;
  if (row.kind == RowKind::normal && clearance >= -late) {
    clearance = clearance_on_way(world, work.start, at(world.contacts, row.index), row.clearance,
                                 clearance, s.reach);
  }
  // As most: no search for these.
  if (work.known_events.empty() && clearance >= -late) return;
  Happening key = event_of(EventKind::catches, number, s);
  key.row = r;
  key.before = releases ? -row.clearance : row.clearance;
  measure(work, key, clearance, late);
}

/// Catches of segments that share their material, of which none need be tight.
void find_catches_of_groups(const World& world, Workspace& work, int number, const PartSystem& s) {
  const CapstanScratch& capstan = work.solve.capstan;
  Happening key = event_of(EventKind::catches, number, s);
  for (const Group& group : capstan.groups) {
    key.item = group.end - group.begin;  // others that begin with the same row are none of it
    double before = 0.0, now = 0.0;
    if (group.slack < 0) {
      if (s.elastic_ends.empty()) continue;
      for (int m = group.begin; m < group.end; ++m) {
        const Row& row = at(s.rows, at(capstan.members, m));
        before += row.clearance;
        now += clearance_of(world, row);
      }
      key.row = at(capstan.members, group.begin);
      key.before = -before;
      if (before < -s.reach) measure(work, key, -now, 0.5 * s.reach);
      continue;
    }
    for (int k = group.slack_begin; k < group.slack_end; ++k) {
      const Term& term = at(capstan.slack_terms, k);
      const Row& row = at(s.rows, term.index);
      before += term.coefficient * row.clearance;
      now += term.coefficient * clearance_of(world, row);
    }
    key.row = at(capstan.members, group.slack);
    key.before = before;
    if (before > s.reach) measure(work, key, now, -s.reach);
  }
}

/// Links of a cable that have come off.
void find_gone_links(const World& world, Workspace& work, const Happening& of_cable) {
  Happening key = of_cable;
  const CableState& cable = at(world.cables, key.cable);
  for (int i = 0; index(i) < cable.links.size(); ++i) {
    const Link& link = at(cable.links, i);
    key.item = i;
    if (is_strung(cable, link) || link.moored) {
      measure(work, key, left_until_taken_in(world, cable, i), 0.5 * key.reach);
      continue;
    }
    if (link.orientation == 0 || link.pinch_middle) continue;
    if (needed(cable, index(i))) continue;
    measure(work, key, link.wrap * link.radius, 0.5 * key.reach);
  }
}

}  // namespace

void find_catches(World& world, Workspace& work, int number) {
  const PartSystem& s = at(work.systems, at(work.parts.list, number).system);
  for (const int r : s.loose) {
    const Row& row = at(s.rows, r);
    const bool releases = row.compliance > 0.0 && row.on && !row.clamped;
    if (!row.idle && !(releases && row.clearance < -s.reach)) continue;
    find_catch(world, work, number, s, r, releases);
  }
  if (!work.solve.capstan.runs.empty()) find_catches_of_groups(world, work, number, s);
}

void find_gone_links(const World& world, Workspace& work, int number) {
  const Part& part = at(work.parts.list, number);
  for (const int c : cables_of(work.parts, part)) {
    const CableState& cable = at(world.cables, c);
    if (!cable.unwound && cable.nodes == 0 && work.events.empty()) continue;
    Happening key = event_of(EventKind::link_gone, number, at(work.systems, part.system));
    key.cable = c;
    find_gone_links(world, work, key);
  }
}

void find_overrun_nodes(const World& world, Workspace& work, int number) {
  const auto has_nodes = [&world](int c) { return at(world.cables, c).nodes > 0; };
  if (world.strung.empty()) return;
  const std::span<const int> cables = cables_of(work.parts, at(work.parts.list, number));
  if (std::ranges::any_of(cables, has_nodes)) find_gone_links(world, work, number);
}

void find_span_hits(const Scene& scene, const World& world, Workspace& work) {
  for (Happening& event : work.events) {
    if (event.kind != EventKind::hit) continue;
    event.clearance = span_clearance(world, event);
    event.seen = true;
  }
  const std::size_t known = work.events.size();
  find_hits(world, work, find_pairs_of_interval(scene, world, work));
  std::size_t kept = known;
  for (std::size_t i = known; i < work.events.size(); ++i) {
    Happening event = work.events[i];
    event.reach =
        std::max(reach_at(world, event.body), within_reach * at(world.cables, event.cable).length);
    event.clearance = span_clearance(world, event);
    event.seen = true;
    const bool met = event.clearance < -0.5 * event.reach;
    if (met && !find(work, event)) work.events[kept++] = event;
  }
  work.events.resize(kept);
}

namespace {

/// Where an event is aimed at, over its reach.
double aim_of(const Happening& event) {
  return event.kind == EventKind::catches ? aim : -aim;
}

/// Of its reaches, until where it is aimed at.
double left_until(const Happening& event) {
  return event.clearance / event.reach - aim_of(event);
}

}  // namespace

double least_clearance(const std::vector<Happening>& events) {
  double least = infinity;
  for (const Happening& event : events) least = std::min(least, left_until(event));
  return least;
}

bool is_jump_first(const std::vector<Happening>& events) {
  const auto first = std::ranges::min_element(events, {}, left_until);
  return first != events.end() && first->kind >= EventKind::halts;
}

double least_before(const std::vector<Happening>& events) {
  double least = infinity;
  for (const Happening& event : events) {
    if (event.before == infinity) return infinity;
    least = std::min(least, event.before / event.reach - aim_of(event));
  }
  return least;
}

void change_courses(World& world, Workspace& work) {
  // From the last link on, so that the indices of others stay.
  std::sort(work.events.begin(), work.events.end(), [](const Happening& p, const Happening& q) {
    return std::tie(p.cable, p.item) > std::tie(q.cable, q.item);
  });
  int cable_changed = -1, item_changed = -1;
  for (const Happening& event : work.events) {
    if (event.kind >= EventKind::halts && event.clearance <= event.reach) end_jump(world, event);
    if (event.kind >= EventKind::halts || event.cable < 0 || event.clearance > event.reach)
      continue;
    CableState& cable = at(world.cables, event.cable);
    if (event.cable == cable_changed && item_changed - event.item < 2) continue;
    cable_changed = event.cable;
    item_changed = event.item;
    const Link& link = at(cable.links, event.item);
    if (event.kind == EventKind::link_gone && (is_strung(cable, link) || link.moored)) {
      int node = event.item;
      if (!cable.finest.empty()) node = free_beside(world, work, event.cable, node);
      item_changed = std::min(let_rim_have(world, work, event.cable, node), event.item);
      ++world.diagnostics.node_changes;
      work.broad_phase.boxes.clear();  // for bodies with other outlines
    } else if (event.kind == EventKind::link_gone) {
      take_off(world, work, event.cable, event.item);
    } else {
      meet_body(world, cable, index(event.item), event.body, event.corner, event.orientation);
      if (cable.nodes > 0 && take_in_enclosed_nodes(world, cable)) work.broad_phase.boxes.clear();
    }
  }
}

}  // namespace pinchlab
