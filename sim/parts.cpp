// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/parts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/cable.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

/// Below this nothing moves (m/s, and rad/s times radius): far above round-off, and a nanometre a
/// second.
constexpr double rest_speed = 1e-9;
/// After this long (s) at rest a part stays at rest: all its forces are constant.
constexpr double rest_time = 0.5;

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

int find_root(std::vector<int>& root, int body) {
  while (root[index(body)] != body) {
    root[index(body)] = root[index(root[index(body)])];
    body = root[index(body)];
  }
  return body;
}

/// The tree with the lesser root takes the other, so that parts come in the order of their first
/// bodies.
void join(std::vector<int>& root, int a, int b) {
  a = find_root(root, a);
  b = find_root(root, b);
  root[index(std::max(a, b))] = std::min(a, b);
}

/// The pairs in contact and the changes of all cables; false if they are those of the last time.
bool structure_changed(const World& world, Parts& parts) {
  const int changes = changes_of_cables(world);
  bool same = changes == parts.changes && parts.structure.size() == 2 * world.contacts.size();
  for (std::size_t i = 0; same && i < world.contacts.size(); ++i) {
    same = parts.structure[2 * i] == world.contacts[i].a &&
           parts.structure[2 * i + 1] == world.contacts[i].b;
  }
  if (same) return false;
  parts.changes = changes;
  parts.structure.clear();
  for (const Contact& contact : world.contacts) {
    parts.structure.push_back(contact.a);
    parts.structure.push_back(contact.b);
  }
  return true;
}

int body_of_contact(const Scene& scene, const Contact& contact) {
  return is_static(scene.bodies[index(contact.a)]) ? contact.b : contact.a;
}

/// The first body of a cable that is not static, or -1.
int body_of_cable(const Scene& scene, const CableState& cable) {
  for (const Link& link : cable.links) {
    if (link.body >= 0 && !is_static(scene.bodies[index(link.body)])) return link.body;
  }
  return -1;
}

void join_bodies(const Scene& scene, const World& world, std::vector<int>& root) {
  root.resize(scene.bodies.size());
  std::iota(root.begin(), root.end(), 0);
  for (const CableState& cable : world.cables) {
    int first = -1;
    for (const Link& link : cable.links) {
      if (link.body < 0 || is_static(scene.bodies[index(link.body)])) continue;
      if (first < 0) first = link.body;
      join(root, first, link.body);
    }
  }
  for (const Contact& contact : world.contacts) {
    if (contact.b < 0 || is_static(scene.bodies[index(contact.a)]) ||
        is_static(scene.bodies[index(contact.b)])) {
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

void divide(const Scene& scene, const World& world, Parts& parts) {
  ++parts.divisions;
  join_bodies(scene, world, parts.root);
  const int bodies = static_cast<int>(scene.bodies.size());
  const int cables = static_cast<int>(world.cables.size());
  int count = 0;
  parts.of_body.assign(index(bodies), -1);
  parts.local.assign(index(bodies), -1);
  parts.mobile.assign(index(bodies), -1);
  parts.immobile.resize(index(bodies));
  for (int b = 0; b < bodies; ++b) {
    parts.immobile[index(b)] = !can_move(scene.bodies[index(b)]);
    if (is_static(scene.bodies[index(b)])) continue;
    const int root = find_root(parts.root, b);
    parts.of_body[index(b)] = root == b ? count++ : parts.of_body[index(root)];
  }
  parts.of_cable.assign(index(cables), -1);
  for (int c = 0; c < cables; ++c) {
    const int body = body_of_cable(scene, world.cables[index(c)]);
    parts.of_cable[index(c)] = body >= 0 ? parts.of_body[index(body)] : count++;
  }
  parts.list.assign(index(count), Part{});
  list_by_part(
      parts.list, bodies, [&parts](int b) { return parts.of_body[index(b)]; }, &Part::bodies_begin,
      &Part::bodies_end, parts.bodies);
  list_by_part(
      parts.list, cables, [&parts](int c) { return parts.of_cable[index(c)]; }, &Part::cables_begin,
      &Part::cables_end, parts.cables);
  list_by_part(
      parts.list, static_cast<int>(world.contacts.size()),
      [&](int i) { return parts.of_body[index(body_of_contact(scene, world.contacts[index(i)]))]; },
      &Part::contacts_begin, &Part::contacts_end, parts.contacts);
  for (Part& part : parts.list) {
    for (const int c : cables_of(parts, part)) {
      part.may_slide = part.may_slide || slides_somewhere(scene, world.cables[index(c)]);
    }
    for (int k = part.bodies_begin; k < part.bodies_end; ++k) {
      const std::size_t b = index(parts.bodies[index(k)]);
      const Body& body = scene.bodies[b];
      parts.local[b] = k - part.bodies_begin;
      const bool turns = body.kind != BodyKind::fixed && !body.driven_angular_velocity;
      if (can_move(body) || turns) parts.mobile[b] = parts.local[b];
      if (can_move(body)) part.lightest = std::min(part.lightest, body.mass);
      part.can_move = part.can_move || !parts.immobile[b];
    }
  }
}

}  // namespace

bool slides_somewhere(const Scene& scene, const CableState& cable) {
  return std::any_of(cable.links.begin(), cable.links.end(), [&scene](const Link& link) {
    return link.orientation != 0 && scene.bodies[index(link.body)].cable_friction < infinity;
  });
}

void find_parts(const Scene& scene, World& world) {
  Parts& parts = world.scratch.parts;
  if (structure_changed(world, parts)) divide(scene, world, parts);
  parts.any_moves = false;
  const auto note_moving = [&parts](const Part& part) {
    parts.any_moves = parts.any_moves || (!part.asleep && part.can_move);
  };
  if (!world.configuration.sleep) {
    std::for_each(parts.list.begin(), parts.list.end(), note_moving);
    return;
  }
  const double enough = rest_time / world.step_length;
  for (Part& part : parts.list) {
    const bool before = part.asleep;
    part.asleep = part.bodies_begin < part.bodies_end;
    for (const int b : bodies_of(parts, part)) {
      if (world.still_steps[index(b)] < enough) {
        part.asleep = false;
        break;
      }
    }
    part.kept = before && part.asleep;
    note_moving(part);
  }
}

void note_rest(const Scene& scene, World& world, const Part& part) {
  const Parts& parts = world.scratch.parts;
  bool rests = true;
  for (const int b : bodies_of(parts, part)) {
    rests =
        rests && world.velocity[index(b)].cwiseAbs().maxCoeff() <= rest_speed &&
        std::abs(world.angular_velocity[index(b)]) * scene.bodies[index(b)].radius <= rest_speed;
    if (!rests) break;
  }
  if (rests && part.slides) {
    for (const int c : cables_of(parts, part)) {
      for (const Link& link : world.cables[index(c)].links) {
        rests = rests && std::abs(link.slip_speed) <= rest_speed;
      }
    }
  }
  for (const int b : bodies_of(parts, part)) {
    world.still_steps[index(b)] = rests ? world.still_steps[index(b)] + 1 : 0;
  }
}

}  // namespace pinchlab
