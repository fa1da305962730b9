// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The parts of a scene that act on one another and on nothing else that moves. Each is solved by
// itself, and sleeps once it has come to rest.

#include <span>
#include <vector>

#include "base/at.h"
#include "sim/contact.h"
#include "sim/scene.h"
#include "sim/world.h"

namespace pinchlab {

struct Workspace;

struct Part {
  int system = -1;                           // of Workspace::systems: its own while it stands
  int bodies_begin = 0, bodies_end = 0;      // of Parts::bodies
  int carried_begin = 0, carried_end = 0;    // of Parts::carried
  int cables_begin = 0, cables_end = 0;      // of Parts::cables
  int contacts_begin = 0, contacts_end = 0;  // of Parts::contacts
  double lightest = infinity;                // kg, of the bodies that can do more than turn
  bool can_move = false;                     // a body of it may change gaps: touch.h
  bool creeps = false;                       // a cable of it does
  bool stretches = false;                    // likewise
  bool may_slide = false;                    // a cable of it touches a body of finite friction,
  bool may_brake = false;                    // of some friction
  bool has_mass = false;                     // a cable of it has, or is a piece between nodes
  bool has_sleeves = false;                  // a cable with mass that may slip on bodies
  bool asleep = false;                       // at rest for long enough: nothing of it changes
  bool dormant = false;                      // pieces of cable that are part of others
  bool kept = false;                         // asleep, and was so in the step before
  bool waits = false;                        // by list_parts: for others to come to its time
  bool can_slip = false;  // contacts may press cables of it, which may slip there
  bool slides = false;    // by solve_parts: cable may slide over bodies
  bool slid = false;      // a contact of it did when the interval began; one may
  bool may_turn = false;  // come to a corner: both by note_sliding
};

inline bool has_contacts(const Part& part) {
  return part.contacts_begin != part.contacts_end;
}

/// Whether cable of the part can slide over bodies, over those of finite friction or in pinches.
inline bool can_slide(const Part& part) {
  return part.may_slide || part.can_slip;
}

/// Whether cable that slides over bodies may come to rest on them by friction.
inline bool may_come_to_rest(const Part& part) {
  return part.may_brake && can_slide(part);
}

/// Whether nothing of it changes at present.
inline bool is_idle(const Part& part) {
  return part.asleep || part.waits;
}

/// What a contact joins into one part: its bodies, and cables that may slip where they are pressed,
/// or whose spans turn where their layers are.
struct Joined {
  int a, b, slipping, layers;

  explicit Joined(const Contact& contact)
      : a(contact.a),
        b(contact.b),
        slipping(contact.slipping_cable),
        layers(contact.layers_cable) {}
  bool operator==(const Joined&) const = default;
};

/// Lists of all parts, one after another; a part's own are given by bodies_of and so on.
struct Parts {
  std::vector<Part> list;
  std::vector<int> bodies;     // that can move or turn by themselves; every one is in one part
  std::vector<int> carried;    // shapes of these; every one is in one part
  std::vector<int> cables;     // every one is in one part
  std::vector<int> contacts;   // every one is in one part
  std::vector<int> of_body;    // part, or -1: fixed
  std::vector<int> of_cable;   // part
  std::vector<int> local;      // place of the body, or of what carries it, in its part's bodies, or
                               // -1: fixed
  bool any_moves = true;       // a body of a part that is awake may change gaps
  std::vector<char> immobile;  // whether the body cannot change gaps
  std::vector<int> movers;     // bodies whose centre can
  std::vector<Joined> structure;  // what the parts were found for: contacts,
  int changes = -1;               // and CableState::changes of all cables
  bool divided = true;      // anew, for the contacts that there are: they may have other places
  bool changed = true;      // anew, or others are asleep, since list_parts
  std::vector<int> root;    // of each body's tree while parts are found
  std::vector<char> taken;  // systems that go on with their parts, while parts are found
};

inline std::span<const int> slice(const std::vector<int>& all, int begin, int end) {
  return {all.data() + begin, index(end - begin)};
}
inline std::span<const int> bodies_of(const Parts& parts, const Part& part) {
  return slice(parts.bodies, part.bodies_begin, part.bodies_end);
}
inline std::span<const int> carried_of(const Parts& parts, const Part& part) {
  return slice(parts.carried, part.carried_begin, part.carried_end);
}
inline std::span<const int> cables_of(const Parts& parts, const Part& part) {
  return slice(parts.cables, part.cables_begin, part.cables_end);
}
inline std::span<const int> contacts_of(const Parts& parts, const Part& part) {
  return slice(parts.contacts, part.contacts_begin, part.contacts_end);
}

/// Divides the scene into parts, by its cables and by world.contacts, and finds which of them
/// sleep. A part of the same bodies and cables as before keeps its system.
void find_parts(const World& world, Workspace& work);

/// The same, without systems. `contacts_stand`: they are those of the parts that were found last,
/// whose lists go to `before` where they are not kept.
void find_parts(const World& world, bool contacts_stand, Parts& parts, Parts& before);

/// That of a part's bodies and cables, of which it has one at least.
inline const Pace& pace_of(const World& world, const Parts& parts, const Part& part) {
  const bool has_bodies = part.bodies_begin != part.bodies_end;
  return has_bodies ? at(world.pace, at(parts.bodies, part.bodies_begin))
                    : world.pace[world.bodies.size() + index(at(parts.cables, part.cables_begin))];
}
void set_pace(World& world, const Parts& parts, const Part& part, const Pace& pace);

/// Gives what has come to be one part one pace; it was in the parts `before`. Velocities of what
/// was awake are of one time.
void share_paces(const Parts& before, const Parts& parts, World& world);

/// Whether the body's outline is where it was: it cannot change, or its part is idle.
inline bool is_still(const Parts& parts, int body) {
  if (parts.immobile.empty()) return false;  // not divided yet
  const std::size_t b = index(body);
  return parts.immobile[b] || is_idle(at(parts.list, parts.of_body[b]));
}

/// Whether the cable's part is idle.
inline bool is_idle(const Parts& parts, std::size_t cable) {
  return !parts.of_cable.empty() && is_idle(at(parts.list, parts.of_cable[cable]));
}

/// Counts for how many steps the bodies of a part have been at rest, after the solve. A part with a
/// body that is faster is wide awake.
void note_rest(const Scene& scene, const Parts& parts, const Part& part, World& world);

}  // namespace pinchlab
