// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which parts may meet within a step, and so share the intervals that events divide it into. What
// happens elsewhere costs them nothing, and counts against no limit of theirs.
//
// A step begins with all parts together. Where something ends its first interval early, they are
// divided: parts of which a body may reach a span of another's, at up to twice the speed that it
// has, or presses on a static body over which another's cable runs, are one neighbourhood. (Bodies
// that may meet have a contact, and are in one part.) Each then goes to the end of the step by
// intervals of its own, round by round. Should two come together after all, as where an impact
// makes a body far faster, the step is taken back and done with all together.

#include <span>
#include <vector>

#include "sim/parts.h"
#include "sim/solve/terms.h"
#include "sim/world.h"

namespace pinchlab {

struct Workspace;

struct Neighbourhood {
  double left = 0.0;      // s, of the step
  double time = 0.0;      // s, that it has come to
  int events = 0;         // of this step, and intervals that could not be met
  int jumps = 0;          // of this step: events that are nothing else (jumps.h)
  bool moved = false;     // in this round
  bool located = false;   // what happens in its last interval
  bool happened = false;  // something has, at the end of it
  bool crept = false;     // its last interval was next to nothing, though nothing happened in it
  bool violated = false;  // lengths or gaps there, or before, by more than is made up for
};

/// A body and the space that it may reach in a step.
struct Reach {
  int body;
  Vec2 centre;    // m
  double radius;  // m
};

struct Neighbourhoods {
  std::vector<Neighbourhood> list;
  Lists<int> parts;                    // awake ones, of each
  std::span<const int> moving;         // of these, those that an interval is found for
  std::vector<int> of_body, of_cable;  // -1: a static body. Empty where there is only one
  bool divided = false;                // there are several, at different times
  bool crossed = false;                // two have come together after all
  Lists<int> events;                   // of Workspace::events, of each; by list_events
  std::vector<int> unlike;             // parts; by find_unlike
  // Storage of divide(), find_unlike() and list_parts().
  std::vector<int> root, over;  // of each part's tree; a part whose cable runs over the body, or -1
  std::vector<Reach> reaches;   // by where they begin along x

  double left_of(int body) const;  // s, of the step
  bool separate_bodies(int body, int other) const;
  bool separate_from_cable(int body, int cable) const;

  /// A body that a cable has only now begun to move shares its course.
  void follow(int body, int cable);
};

/// All awake parts as one neighbourhood that has the whole step before it.
void put_together(const World& world, Parts& parts, Neighbourhoods& near);

/// Divides the parts by what they may reach from where Workspace::start has them; whether there are
/// several neighbourhoods then. All have as much of the step before them as they had together.
bool divide(const Scene& scene, const World& world, Workspace& work);

/// Lists the events of a step that has just been divided by neighbourhood: Neighbourhoods::events.
void list_events(const Workspace& work, Neighbourhoods& near);

/// Lists the awake parts by neighbourhood anew. Of a divided step those wait whose neighbourhood
/// has not moved in this round. They stand until Parts::changed.
void list_parts(Parts& parts, Neighbourhoods& near);

/// Keeps what a step starts from that has been divided after its first interval was tried:
/// Workspace::step_start; bodies and material are in Workspace::start.
void keep_start(const World& world, Workspace& work);

/// Goes back there, with all parts together.
void take_back(World& world, Workspace& work);

/// Finds the parts of a neighbourhood, which has one at least, that are so near to others, whose
/// velocities are of another time, that they may come to be one part, by the pairs that there are:
/// Neighbourhoods::unlike.
void find_unlike(const Scene& scene, const World& world, Workspace& work, int number);

/// The neighbourhood that a part is in.
int number_of(const Neighbourhoods& near, const Parts& parts, const Part& part);

/// The awake parts of one.
inline std::span<const int> parts_of(const Neighbourhoods& near, int number) {
  return slice(near.parts.items, at(near.parts.begin, number), at(near.parts.begin, number + 1));
}

/// What has become of a part in this round of a step that has been divided: that of its
/// neighbourhood, or of all in which it has bodies or cables, now that they have come to one time.
Neighbourhood course_of(const Neighbourhoods& near, const Parts& parts, const Part& part);

}  // namespace pinchlab
