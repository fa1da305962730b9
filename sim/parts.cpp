// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/mass.h"
#include "sim/cable/sleeve.h"
#include "sim/compound.h"
#include "sim/touch.h"
#include "sim/trees.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// After this long (s) at rest a part stays at rest: all its forces are constant. What is thrown up
/// or swings is as slow as what rests for a moment only, where it turns round.
constexpr double rest_time = 0.5;

/// The pairs in contact, the cables that may slip where these press them, and the changes of all
/// cables; false if they are those of the last time, as contacts are that were kept.
bool structure_changed(const World& world, bool contacts_kept, Parts& parts) {
  const int changes = world.changes;
  bool same = changes == parts.changes && parts.structure.size() == world.contacts.size();
  for (std::size_t i = 0; same && !contacts_kept && i < world.contacts.size(); ++i) {
    same = parts.structure[i] == Joined(world.contacts[i]);
  }
  if (same) return false;
  parts.changes = changes;
  parts.structure.clear();
  for (const Contact& contact : world.contacts) parts.structure.emplace_back(contact);
  return true;
}

int body_of_contact(const World& world, const Contact& contact) {
  return is_static(at(world.bodies, contact.a)) ? contact.b : contact.a;
}

/// The first body of a cable that is not static, or -1.
int body_of_cable(const World& world, const CableState& cable) {
  for (const Link& link : cable.links) {
    if (link.body >= 0 && !is_static(at(world.bodies, link.body))) return link.body;
  }
  return -1;
}

void join_bodies(const World& world, std::vector<int>& root) {
  root.resize(world.bodies.size());
  std::iota(root.begin(), root.end(), 0);
  for (const int shape : world.carried) {
    if (!is_static(at(world.bodies, shape))) join(root, shape, at(world.bodies, shape).carrier);
  }
  for (const CableState& cable : world.cables) {
    int first = -1;
    for (const Link& link : cable.links) {
      if (link.body < 0 || is_static(at(world.bodies, link.body))) continue;
      if (first < 0) first = link.body;
      join(root, first, link.body);
    }
  }
  for (const Contact& contact : world.contacts) {
    for (const int pressed : {contact.slipping_cable, contact.layers_cable}) {
      if (pressed < 0) continue;
      const int moved = body_of_cable(world, at(world.cables, pressed));
      const int presser = body_of_contact(world, contact);
      if (moved >= 0 && !is_static(at(world.bodies, presser))) join(root, moved, presser);
    }
    if (contact.b < 0 || is_static(at(world.bodies, contact.a)) ||
        is_static(at(world.bodies, contact.b))) {
      continue;
    }
    join(root, contact.a, contact.b);
  }
}

/// Lists the items 0 .. count - 1 by part, in their order: counting sort.
template <class PartOf>
void list_by_part(std::vector<Part>& list, int count, PartOf part_of, int Part::*begin,
                  int Part::*end, std::vector<int>& items) {
  for (int i = 0; i < count; ++i) {
    if (part_of(i) >= 0) ++(list[index(part_of(i))].*end);
  }
  int sum = 0;
  for (Part& part : list) {
    part.*begin = sum;
    sum += part.*end;
    part.*end = part.*begin;
  }
  items.resize(index(sum));
  for (int i = 0; i < count; ++i) {
    if (part_of(i) < 0) continue;
    Part& part = list[index(part_of(i))];
    items[index((part.*end)++)] = i;
  }
}

/// Which part each body and each cable is in; returns how many parts there are. Their order is that
/// of their first bodies, then of cables without any, then of all that are dormant.
int number_parts(const World& world, Parts& parts) {
  join_bodies(world, parts.root);
  const int bodies = static_cast<int>(world.bodies.size());
  int count = 0;
  parts.of_body.assign(index(bodies), -1);
  parts.immobile.resize(index(bodies));
  parts.movers.clear();
  for (int b = 0; b < bodies; ++b) {
    at(parts.immobile, b) = !may_change_gaps(at(world.bodies, b));
    if (can_move(at(world.bodies, b))) parts.movers.push_back(b);
    if (is_static(at(world.bodies, b))) continue;
    const int root = find_root(parts.root, b);
    at(parts.of_body, b) = root == b ? count++ : at(parts.of_body, root);
  }
  parts.of_cable.assign(world.cables.size(), -1);
  bool dormant = false;
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    dormant = dormant || is_dormant(world.cables[c]);
    if (is_dormant(world.cables[c])) continue;
    const int body = body_of_cable(world, world.cables[c]);
    parts.of_cable[c] = body >= 0 ? at(parts.of_body, body) : count++;
  }
  if (!dormant) return count;
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    if (is_dormant(world.cables[c])) parts.of_cable[c] = count;
  }
  return count + 1;
}

/// What a part is like, from its bodies and cables; and the places of its bodies.
void describe(const World& world, Parts& parts, Part& part) {
  for (const int c : cables_of(parts, part)) {
    part.dormant = part.dormant || is_dormant(at(world.cables, c));
    part.has_mass = part.has_mass || at(world.cables, c).piece || is_massed(at(world.cables, c));
    part.creeps = part.creeps || at(world.cables, c).creeps;
    part.stretches = part.stretches || at(world.cables, c).elastic;
    part.may_slide = part.may_slide || slides_somewhere(world, at(world.cables, c));
    part.may_brake = part.may_brake || rubs_somewhere(world, at(world.cables, c));
    part.has_sleeves = part.has_sleeves || has_sleeves(world, at(world.cables, c));
  }
  for (int k = part.bodies_begin; k < part.bodies_end; ++k) {
    const int b = at(parts.bodies, k);
    at(parts.local, b) = k - part.bodies_begin;
    part.can_move = part.can_move || may_change_gaps(at(world.bodies, b));
    if (can_move(at(world.bodies, b))) {
      part.lightest = std::min(part.lightest, at(world.bodies, b).mass);
    }
  }
  for (const int shape : carried_of(parts, part)) {
    at(parts.local, shape) = at(parts.local, at(world.bodies, shape).carrier);
    part.can_move = true;  // by turning, at least
  }
  // Between bodies that cannot give way a cable that none of them lets slip is held.
  if (!has_contacts(part) || part.cables_begin == part.cables_end) return;
  part.can_slip = part.can_move;
  for (const int c : cables_of(parts, part)) {
    part.can_slip = part.can_slip || at(world.cables, c).grip == 0.0;
  }
}

bool same(std::span<const int> a, std::span<const int> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

/// The part before that had the bodies and cables of this one, or nothing.
const Part* predecessor(const Parts& before, const Parts& parts, const Part& part) {
  const std::span<const int> bodies = bodies_of(parts, part), cables = cables_of(parts, part);
  const bool has_bodies = !bodies.empty();
  const int first = has_bodies ? bodies.front() : cables.front();
  const std::vector<int>& of = has_bodies ? before.of_body : before.of_cable;
  // A node that has come was in none: it was fixed.
  if (index(first) >= of.size() || at(of, first) < 0) return nullptr;
  const Part& old = at(before.list, at(of, first));
  const bool stands = same(bodies, bodies_of(before, old)) && same(cables, cables_of(before, old));
  return stands ? &old : nullptr;
}

/// Gives every part the system of its predecessor, or one that no part has, made anew.
void assign_systems(const Parts& before, Parts& parts, std::vector<PartSystem>& systems) {
  std::vector<char>& taken = parts.taken;
  taken.assign(std::max(systems.size(), parts.list.size()), 0);
  for (Part& part : parts.list) {
    const Part* old = predecessor(before, parts, part);
    if (old == nullptr) continue;
    part.system = old->system;
    at(taken, part.system) = 1;
  }
  systems.resize(taken.size());
  int next = 0;
  for (Part& part : parts.list) {
    if (part.system >= 0) continue;
    while (at(taken, next)) ++next;
    part.system = next;
    at(taken, next) = 1;
    forget(at(systems, next));
  }
}

void divide(const World& world, Parts& before, Parts& parts) {
  std::swap(before.list, parts.list);
  std::swap(before.bodies, parts.bodies);
  std::swap(before.cables, parts.cables);
  std::swap(before.of_body, parts.of_body);
  std::swap(before.of_cable, parts.of_cable);
  const int count = number_parts(world, parts);
  parts.list.assign(index(count), Part{});
  parts.local.assign(world.bodies.size(), -1);
  const int bodies = static_cast<int>(world.bodies.size());
  list_by_part(
      parts.list, bodies,
      [&](int b) { return mover_of(world, b) == b ? at(parts.of_body, b) : -1; },
      &Part::bodies_begin, &Part::bodies_end, parts.bodies);
  list_by_part(
      parts.list, world.carried.empty() ? 0 : bodies,
      [&](int b) { return mover_of(world, b) == b ? -1 : at(parts.of_body, b); },
      &Part::carried_begin, &Part::carried_end, parts.carried);
  list_by_part(
      parts.list, static_cast<int>(world.cables.size()),
      [&parts](int c) { return at(parts.of_cable, c); }, &Part::cables_begin, &Part::cables_end,
      parts.cables);
  list_by_part(
      parts.list, static_cast<int>(world.contacts.size()),
      [&](int i) { return at(parts.of_body, body_of_contact(world, at(world.contacts, i))); },
      &Part::contacts_begin, &Part::contacts_end, parts.contacts);
  for (Part& part : parts.list) describe(world, parts, part);
}

/// Below this speed (m/s; at the rim for turning) a body is at rest: a part in 1e8 of its size a
/// second, or what round-off of its coordinates makes of a step, whichever is more.
double rest_speed(const World& world, int body) {
  constexpr double slow = 1e-8, rounding = 1e-14;
  const double coordinate = at(world.position, body).cwiseAbs().maxCoeff();
  return std::max(slow * at(world.bodies, body).radius, rounding * coordinate / world.step_length);
}

bool rests(const Parts& parts, const Part& part, const World& world) {
  double slowest = infinity;  // of the bodies' rest speeds
  for (const int b : bodies_of(parts, part)) {
    const double least = rest_speed(world, b);
    slowest = std::min(slowest, least);
    if (at(world.velocity, b).cwiseAbs().maxCoeff() > least) return false;
    if (std::abs(at(world.angular_velocity, b)) * at(world.bodies, b).radius > least) return false;
  }
  if (!part.slides) return true;
  for (const int c : cables_of(parts, part)) {
    for (const Link& link : at(world.cables, c).links) {
      if (std::abs(link.slip_speed) > slowest) return false;
    }
  }
  return true;
}

}  // namespace

void find_parts(const World& world, Workspace& work) {
  find_parts(world, work.contacts.contacts_kept, work.parts, work.parts_before);
  if (work.parts.divided) assign_systems(work.parts_before, work.parts, work.systems);
}

void find_parts(const World& world, bool contacts_stand, Parts& parts, Parts& before) {
  parts.divided = structure_changed(world, contacts_stand, parts);
  if (parts.divided) divide(world, before, parts);
  parts.changed = parts.changed || parts.divided;
  parts.any_moves = false;
  const double enough = rest_time / world.step_length;
  for (Part& part : parts.list) {
    const bool slept = part.asleep;
    part.asleep =
        part.dormant || (world.configuration.sleep && part.bodies_begin < part.bodies_end);
    for (const int b : bodies_of(parts, part)) {
      if (!part.asleep) break;
      part.asleep = at(world.still_steps, b) >= enough;
    }
    part.kept = slept && part.asleep;
    parts.changed = parts.changed || part.asleep != slept;
    parts.any_moves = parts.any_moves || (!part.asleep && part.can_move);
  }
}

void set_pace(World& world, const Parts& parts, const Part& part, const Pace& pace) {
  for (const int b : bodies_of(parts, part)) at(world.pace, b) = pace;
  for (const int c : cables_of(parts, part)) world.pace[world.bodies.size() + index(c)] = pace;
}

void share_paces(const Parts& before, const Parts& parts, World& world) {
  const auto count = static_cast<int>(world.bodies.size());
  const auto was_awake = [&](int item) {  // a body, or a cable after them
    const int part = item < count ? at(before.of_body, item) : at(before.of_cable, item - count);
    return part >= 0 && !at(before.list, part).asleep;
  };
  for (const Part& part : parts.list) {
    Pace first = pace_of(world, parts, part);
    bool differ = false, found = false;
    const auto look_at = [&](int item) {
      differ = differ || at(world.pace, item) != first;
      if (found || !was_awake(item)) return;
      found = true;
      first.lag = at(world.pace, item).lag;
    };
    for (const int b : bodies_of(parts, part)) look_at(b);
    for (const int c : cables_of(parts, part)) look_at(count + c);
    if (differ) set_pace(world, parts, part, {.lag = first.lag});
  }
}

void note_rest(const Scene& scene, const Parts& parts, const Part& part, World& world) {
  if (!world.configuration.sleep) return;
  if (!rests(parts, part, world)) {
    for (const int b : bodies_of(parts, part)) at(world.still_steps, b) = 0;
    return;
  }
  for (const int b : bodies_of(parts, part)) {
    const std::vector<MotorPoint>& motor = at(scene.bodies, b).motor;
    const bool driven_on = !motor.empty() && world.time() <= motor.back().time;
    int& steps = at(world.still_steps, b);
    steps = driven_on ? 0 : steps + 1;
  }
}

}  // namespace pinchlab
