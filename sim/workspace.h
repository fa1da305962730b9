// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the stages of a step keep beside the World: lists that stand while nothing of theirs has
// moved, and storage, so that a warm step allocates nothing, unless links of a cable come or go in
// it. All of it follows from the World: a new Workspace before each step gives the same bits, only
// later.

#include <cstdint>
#include <vector>

#include "sim/box_tree.h"
#include "sim/detect/broad_phase.h"
#include "sim/diagnostics.h"
#include "sim/motion/neighbourhoods.h"
#include "sim/parts.h"
#include "sim/solve/part_system.h"
#include "sim/solve/solve_scratch.h"
#include "sim/thesis/sweep_scratch.h"
#include "sim/world.h"

namespace pinchlab {

/// A body that has just left a cable.
struct Release {
  int cable, body, orientation;
};

/// What may happen within an interval, and then ends it: events.h. The last three are jumps.h's.
enum class EventKind : std::int8_t { catches, link_gone, hit, halts, turns, lets_go };

struct Happening {
  EventKind kind;
  int part = -1;        // catches, halts, turns, lets_go
  int row = -1;         // catches: of a contact that closes, or a segment that is pulled tight;
                        // halts, turns, lets_go: a contact, if it is one
  int cable = -1;       // link_gone, hit; halts, of one
  int item = -1;        // link; or span; of a group of rows that is caught or let go, how many
  int body = -1;        // hit; halts, turns: whose motor it is, if it is one
  int corner = -1;      // hit: of the body, if it is a polygon
  int orientation = 0;  // hit
  bool beside = false;  // hit: the body is beside the span when the first trial ends
  double clearance =
      0.0;             // m, that was left of it at the end of the last trial; negative: too late.
                       // Of what slides the way that it makes in a step; s: of tables, lets_go
  double reach = 0.0;  // likewise, to within which it must be met
  double before = infinity;  // likewise, that was left when the interval began, where it is known
  bool seen = false;         // in the last trial
};

/// Where things were when an interval began: by begin_interval.
struct Start {
  double time = 0.0;  // s
  std::vector<Vec2> position, velocity;
  std::vector<double> angle, angular_velocity;
  std::vector<double> material, slip;  // of the links of cables that can slide, cable after cable:
                                       // m, and m/s
  std::vector<Slip> contact_slip;      // of World::contacts, where they are of what moves,
  std::vector<char> touching;          // likewise,
  std::vector<double> contact_force;   // N, likewise: of the interval before
  std::int64_t fallbacks = 0;          // Diagnostics::fallbacks
};

/// What came of trying an interval.
struct IntervalTrial {
  bool met = true;            // lengths and gaps are exact at its end
  bool settled = true;        // every solve, and none left rows out
  bool froze = false;         // SolveScratch::froze, of any solve
  bool violated = false;      // what it began with, by more than it makes up for
  bool foreseen = false;      // its curvatures were; of one part
  bool curves = false;        // some way, by more than round-off; of one part
  bool contradicts = false;   // a correction of the first solution asks for what cannot be
  double missed = 0.0;        // by lengths and gaps, over the part's extent, where not met
  double excess = 0.0;        // the same, over what would do
  double local_error = 0.0;   // m
  double longest = infinity;  // s, that it may last: vanishing.h
  double turned = 0.0;        // rad^2, by what bears force, where it curved: turning.h
  double wave = 0.0;          // 1/s^2, on cables of nodes under the tensions that it found: waves.h
};

/// A step's start, but for what Start has, to take it back to. By keep_start.
struct StepStart {
  Start start;
  std::vector<int> first_link;  // of Workspace
  std::vector<CableState> cables;
  int changes = 0;  // World::changes
  std::vector<Contact> contacts;
  std::vector<int> still_steps;
  std::vector<Pace> pace;
  Diagnostics diagnostics;
};

/// Storage of find_contacts and configure_pinches.
struct ContactScratch {
  std::vector<Contact> old_contacts;  // of the step before; by find_contacts
  Lists<int> contacts_of_body;        // bodies without walls; by configure_pinches
  std::vector<int> fill;              // cursor of contacts_of_body while it is made, likewise
  bool contacts_kept = false;         // all contacts are those of the step before; by find_contacts
  bool pinches_kept = false;          // and all pinches; by configure_pinches
  std::vector<char> stirred;          // parts of which a contact is not; by configure_pinches
  std::vector<char> stands;     // cables whose links and pinches are those of the step before;
                                // likewise
  int configured_changes = -1;  // changes of all cables when pinches were configured
};

struct Workspace {
  std::uint64_t stamp = 0;  // World::stamp of the state that all of this is for

  Parts parts;                      // by find_parts
  Parts parts_before;               // lists of the last division, while the next is made
  std::vector<PartSystem> systems;  // of Part::system; by make_system and the solve
  SolveScratch solve;               // of the part being solved

  BroadPhase broad_phase;         // by find_body_pairs and find_span_pairs
  std::vector<Release> released;  // since update_segments, by their cables; by take_off
  bool spans_moved = true;        // any of them, by update_segments
  ContactScratch contacts;
  SweepScratch sweeps;  // of the iterative solver

  Start start;                  // of the last interval
  std::vector<int> first_link;  // of each cable, in `start`; -1: it cannot slide. As that
  std::vector<Eigen::Vector3d> linear_velocity;  // of a part, before SHAKE; by move_part
  std::vector<IntervalTrial> trials;             // the last of each part; by try_interval, as
  IntervalTrial trial;                           // the last, of all that were tried
  std::vector<Happening> events;        // of the interval being tried; by motion/events.cpp
  std::vector<Happening> tried_events;  // of a step that has just been divided; by move_each
  std::vector<int> known_events;        // of them, before the trial; by begin_trial

  Neighbourhoods neighbourhoods;  // by advance
  BoxTree surroundings;           // of nodes that come and go; by wants_other_nodes
  StepStart step_start;           // of a step that has been divided
  Instant before;                 // at the start of the step; with diagnostics, by step
  std::vector<double> speeds;     // m/s, of a part's bodies before an impact; by strike_and_hasten
};

/// Makes the workspace fit the world, if it was last used for another state: what stands of it is
/// forgotten, and the parts are found anew.
void fit(const World& world, Workspace& work);

/// Whether it has served the step before: until then anything may have been moved by hand.
inline bool is_known(const Workspace& work) {
  return work.stamp != 0;
}

/// Notes that the workspace is for the world as it is now, and for no other state.
void mark(World& world, Workspace& work);

}  // namespace pinchlab
