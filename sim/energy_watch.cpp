// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/energy_watch.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/held.h"
#include "sim/energy.h"
#include "sim/solve/part_system.h"

namespace pinchlab {
namespace {

bool is_driven(const Body& body) {
  return body.driven_angular_velocity.has_value() || body.torque != 0.0 || !body.motor.empty();
}

/// m, the greatest coordinate of a cable's spans, or its length.
double extent_of(const CableState& cable) {
  double extent = cable.length;
  for (std::size_t i = first_segment(cable); i < cable.segments.size(); ++i) {
    const Segment& span = cable.segments[i];
    extent = std::max({extent, span.tail.cwiseAbs().maxCoeff(), span.head.cwiseAbs().maxCoeff()});
  }
  return extent;
}

/// J. Lengths and gaps are right to a share of the extent (PartSystem::tolerance), and a step puts
/// that right with velocities of as much in its length: where nothing else moves that is all the
/// energy there is.
double energy_of_round_off(double mass, double extent, double step_length) {
  const double speed = 0.1 * within_reach * extent / step_length;
  return 0.5 * mass * speed * speed;
}

}  // namespace

void EnergyWatch::describe_items(const Scene& scene, const World& world) {
  const double g = scene.gravity.norm();
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    Group& group = groups_[b];
    group.driven = is_driven(body);
    group.drained = body.node || body.linear_drag > 0.0 || body.angular_drag > 0.0;
    if (body.kind == BodyKind::fixed) continue;
    group.mass = body.mass;
    group.extent = body.position.cwiseAbs().maxCoeff() + body.radius;
    if (can_move(body)) group.at_play = body.mass * g * body.radius;
  }
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    Group& group = groups_[world.bodies.size() + c];
    group.mass = world.cables[c].density * world.cables[c].length;
    group.extent = extent_of(world.cables[c]);
    group.drained = world.cables[c].density > 0.0 || scene.cables[c].damping > 0.0;
  }
}

void EnergyWatch::unite(int item, int other) {
  const int a = root_of(item), b = root_of(other);
  if (a == b) return;
  join(root_, a, b);
  Group& group = at(groups_, std::min(a, b));
  const Group& joins = at(groups_, std::max(a, b));
  group.start += joins.start;
  group.at_play += joins.at_play;
  group.kinetic += joins.kinetic;
  group.potential += joins.potential;
  group.mass += joins.mass;
  group.extent = std::max(group.extent, joins.extent);
  group.kept += joins.kept;
  group.driven = group.driven || joins.driven;
  group.drained = group.drained || joins.drained;
}

/// Bodies that may touch in the next step have a contact, and are in one part.
void EnergyWatch::unite_parts(const World& world) {
  find_parts(world, false, parts_, parts_before_);
  if (!parts_.divided) return;
  first_.assign(parts_.list.size(), -1);
  const auto add = [this](int item, int part) {
    if (part < 0 || at(parts_.list, part).dormant) return;
    int& first = at(first_, part);
    if (first < 0) first = item;
    unite(first, item);
  };
  for (int b = 0; index(b) < world.bodies.size(); ++b) add(b, at(parts_.of_body, b));
  for (int c = 0; index(c) < world.cables.size(); ++c) {
    add(cable_item(world, c), at(parts_.of_cable, c));
  }
}

/// Where links have come or gone a body may have met the cable, and come off it within the step.
/// That is one that may have been at its spans.
void EnergyWatch::unite_at_cable(const World& world, int number) {
  const CableState& cable = at(world.cables, number);
  Vec2 low = Vec2::Constant(infinity), high = -low;
  for (std::size_t i = first_segment(cable); i < cable.segments.size(); ++i) {
    const Segment& span = cable.segments[i];
    low = low.cwiseMin(span.tail.cwiseMin(span.head));
    high = high.cwiseMax(span.tail.cwiseMax(span.head));
  }
  for (int b = 0; index(b) < world.bodies.size(); ++b) {
    const BodyProperties& body = at(world.bodies, b);
    if (is_static(body) || body.node) continue;
    const double speed = std::max(at(world.velocity, b).norm(), at(before_.velocity, b).norm());
    const double reach = body.radius + 2.0 * cable.half_width + 2.0 * world.step_length * speed;
    const Vec2& x = at(world.position, b);
    const bool is_near =
        ((x - low).array() >= -reach).all() && ((high - x).array() >= -reach).all();
    if (is_near) unite(b, cable_item(world, number));
  }
}

void EnergyWatch::unite_all(const World& world) {
  unite_parts(world);
  links_changed_ = false;
  for (int c = 0; index(c) < world.cables.size(); ++c) {
    const int changes = at(world.cables, c).changes;
    if (changes == at(changes_, c)) continue;
    unite_at_cable(world, c);
    at(changes_, c) = changes;
    links_changed_ = true;
  }
}

void EnergyWatch::add_kinetic(const World& world, double Sums::*sum) {
  const double h = world.step_length;
  for (int b = 0; index(b) < world.bodies.size(); ++b) {
    at(sums_, root_of(b)).*sum += kinetic_energy(world, before_, h, b);
  }
  for (const Sleeve& sleeve : before_.sleeves) {
    const int group = root_of(cable_item(world, sleeve.cable));
    at(sums_, group).*sum += kinetic_energy_of_sleeve(world, before_, h, sleeve);
  }
}

void EnergyWatch::add_potential(const Scene& scene, const World& world) {
  for (int b = 0; index(b) < world.bodies.size(); ++b) {
    at(sums_, root_of(b)).potential += potential_energy_of_body(scene, world, b);
  }
  for (int c = 0; index(c) < world.cables.size(); ++c) {
    const int group = root_of(cable_item(world, c));
    at(sums_, group).potential += potential_energy_of_cable(scene, world, c);
  }
  for (const NodeChain& chain : scene.chains) {
    const int group = root_of(cable_item(world, chain.cable));
    at(sums_, group).potential += potential_energy_held(world, chain, scene.gravity);
  }
}

namespace {

/// Whether rough bodies may take energy from a cable: where it slides, or as it stretches on them.
bool is_rubbed(const World& world, const CableState& cable) {
  return std::ranges::any_of(cable.links, [&](const Link& link) {
    if (link.body < 0 || !(at(world.bodies, link.body).cable_friction > 0.0)) return false;
    return link.slip != Slip::stick || (cable.elastic && link.radius > 0.0);
  });
}

}  // namespace

/// What meets something or comes off it does so in an event, which does not tell of what group; and
/// so does, in the first step, what the scene gives a velocity that does not fit its cables.
void EnergyWatch::find_what_takes(const World& world) {
  const Diagnostics& now = world.diagnostics;
  const bool anywhere = world.step == 1 || now.events != events_ ||
                        now.node_changes != node_changes_ || links_changed_;
  events_ = now.events;
  node_changes_ = now.node_changes;
  if (anywhere) {
    for (Sums& sums : sums_) sums.taken = true;
    return;
  }
  for (const Contact& contact : world.contacts) {
    if (contact.slip == Slip::stick && contact.slipping_cable < 0) continue;
    at(sums_, root_of(contact.a)).taken = true;
    if (contact.b >= 0) at(sums_, root_of(contact.b)).taken = true;
  }
  for (int c = 0; index(c) < world.cables.size(); ++c) {
    if (is_rubbed(world, at(world.cables, c)))
      at(sums_, root_of(cable_item(world, c))).taken = true;
  }
}

/// Of nodes their cable.
int EnergyWatch::representative(const World& world, int group) {
  const auto bodies = static_cast<int>(world.bodies.size());
  if (group >= bodies || !at(world.bodies, group).node) return group;
  for (int item = bodies; index(item) < root_.size(); ++item) {
    if (root_of(item) == group) return item;
  }
  return group;
}

void EnergyWatch::start(const Scene& scene, const World& world) {
  const std::size_t items = world.bodies.size() + world.cables.size();
  root_.resize(items);
  std::iota(root_.begin(), root_.end(), 0);
  groups_.assign(items, {});
  sums_.assign(items, {});
  for (const CableState& cable : world.cables) changes_.push_back(cable.changes);
  describe_items(scene, world);
  note_instant(world, before_);
  unite_all(world);
  add_kinetic(world, &Sums::kinetic);
  add_potential(scene, world);
  for (std::size_t i = 0; i < items; ++i) {
    Group& group = groups_[i];
    group.kinetic = sums_[i].kinetic;
    group.potential = sums_[i].potential;
    group.start = group.kinetic + group.potential;
    group.at_play = std::max(group.at_play, group.kinetic);
  }
  events_ = world.diagnostics.events;
  node_changes_ = world.diagnostics.node_changes;
}

// Energy at the step's start: velocities were from before it and are half an interval after it, and
// between the two they change evenly. Where the step was divided that half is not known: then there
// is at least what the lesser of the velocities before and after tells, and at most what the
// greater does, but for what these and positions can have exchanged meanwhile, no more than
// potential energy changes by in the step.
EnergyWatch::Range EnergyWatch::energy_at_start(const Group& group, const Sums& sums) {
  if (sums.whole) return {sums.kinetic + group.potential, sums.kinetic + group.potential};
  const auto [lesser, greater] = std::minmax(group.kinetic, sums.kinetic_after);
  const double exchanged = std::abs(sums.potential - group.potential);
  return {lesser - exchanged + group.potential, greater + exchanged + group.potential};
}

/// Of a group, by so much (J).
void EnergyWatch::note_change(int group, double energy, Change& worst) const {
  const double share = energy / at(groups_, group).at_play;
  if (!(share <= worst.share)) worst = {share, group};  // NaN is noted
}

EnergyWatch::Changes EnergyWatch::note(const Scene& scene, const World& world) {
  unite_all(world);
  std::fill(sums_.begin(), sums_.end(), Sums{});
  add_kinetic(world, &Sums::kinetic);
  note_instant(world, before_);
  add_kinetic(world, &Sums::kinetic_after);
  add_potential(scene, world);
  find_what_takes(world);
  for (int b = 0; index(b) < world.bodies.size(); ++b) {
    if (is_static(at(world.bodies, b))) continue;
    Sums& sums = at(sums_, root_of(b));
    sums.whole = sums.whole && at(world.pace, b).lag == 0.5 * world.step_length;
  }
  Changes worst;
  for (int i = 0; index(i) < groups_.size(); ++i) {
    if (root_of(i) != i) continue;
    Group& group = at(groups_, i);
    const Sums& sums = at(sums_, i);
    group.at_play = std::max(group.at_play, sums.kinetic);
    if (!group.driven && group.at_play > 0.0) {
      const auto [least, most] = energy_at_start(group, sums);
      const double round_off = energy_of_round_off(group.mass, group.extent, world.step_length);
      note_change(i, least - group.start - round_off, worst.gained);
      if (group.drained || sums.taken) {
        group.kept = -infinity;
      } else if (group.kept > -infinity) {
        note_change(i, group.kept - most - round_off, worst.lost);
      } else if (sums.whole) {
        group.kept = most;
      }
    }
    group.kinetic = sums.kinetic_after;
    group.potential = sums.potential;
  }
  for (Change* change : {&worst.gained, &worst.lost}) {
    if (change->item >= 0) change->item = representative(world, change->item);
  }
  return worst;
}

}  // namespace pinchlab
