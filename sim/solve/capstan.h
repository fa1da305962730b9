// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Sliding with friction over bodies: the capstan law, with the friction of pinches on the way.
// Nothing here runs for cables all of whose bodies have infinite friction.

#include <vector>

#include "base/at.h"
#include "sim/contact.h"
#include "sim/solve/friction.h"
#include "sim/solve/terms.h"

namespace pinchlab {

struct Part;
struct Parts;
struct SolveScratch;
struct World;
struct CableState;

/// All links of a cable on one body in succession: one link, or the parts into which pinches divide
/// it, or those at a polygon's corners. Material slides over the body at one speed everywhere in
/// the run. (The direct solver with three rows a pinch has a run for each link; the segments
/// between them make the speeds equal.)
struct Run {
  int cable = 0, first_link = 0, last_link = 0;
  int row_in = -1, row_out = -1;  // segment rows before and after
  bool frictionless = false;      // always slides; the direction does not matter
  Slip slip = Slip::stick;
  double speed = 0.0;       // m/s, of the material over the body, by slip_speeds
  int flipped = 0;          // solve of this step at which `slip` last changed
  Slip slid = Slip::stick;  // the way in which it was last let slide in this step, if it was
  bool frozen = false;      // sticks for this step, whatever its bounds
  bool joins = false;       // slides between two segments of one group, by make_groups
  bool follows = false;     // slack, with a middle body that holds it better, by slip_speeds
  bool lets_go = false;     // what presses it holds as little as where all is slack
  int passages_begin = 0, passages_end = 0;
};

/// Segments joined by sliding runs, in the cable's order: their tensions depend on one unknown.
struct Group {
  int begin = 0, end = 0;               // of members
  int slack = -1;                       // the slack member, or -1
  int slack_begin = 0, slack_end = 0;   // of slack_terms: what of the group must not be taut
  int run_before = -1, run_after = -1;  // that end it on the cable, or -1: nothing slides there
};

/// What a group, or the slack rest of one, has to spare.
struct Shortage {
  double speed = 0.0;      // m/s, at which it gets less
  double clearance = 0.0;  // m; infinity: it stretches
  bool gives = false;      // impulses on it move something
};

/// What of a part slides. Runs, passages and the lists by cables are of find_runs, and stand for a
/// step's solves; groups and all of theirs of make_groups, anew for each guess of the states; terms
/// of express_impulses and add_group_equations; speeds, factors and end impulses of slip_speeds.
struct CapstanScratch {
  std::vector<Run> runs;
  std::vector<Passage> passages;
  std::vector<int> pressing;              // contacts, by list_pressing
  std::vector<ArcCut> cuts;               // storage, by find_cuts
  std::vector<int> segments, run_before;  // rows of the sliding cables' segments, and the run
                                          // before each; -1 at an open cable's start
  std::vector<int> cable_begin;           // into these two, one a sliding cable; and the end
  std::vector<int> members, member_runs;  // rows of the groups' segments, and the run before each;
                                          // -1 for the first of a group
  std::vector<Group> groups;
  std::vector<int> group_of_row;  // -1: not of a sliding cable
  std::vector<Term> expression, sums, slack_terms;
  std::vector<int> sums_begin, borders;
  std::vector<double> speeds, factors;  // of members: of their rows (m/s), and of their tensions
  std::vector<double> end_impulse;  // N s of each row: by the tension at the interval's end, over
                                    // the kick. Empty without PartSystem::elastic_ends
};

/// Sliding speed over the wrapped body at a middle link's pinch: that of its run.
inline double run_speed(const PartSystem& system, const CapstanScratch& capstan, const Row& row) {
  const int run = at(system.frictions, row.friction).run;
  return run >= 0 ? at(capstan.runs, run).speed : 0.0;
}

/// By how much that makes the friction of the middle body's row slide: not at all where the cable
/// goes with that body and slides over the wrapped one.
inline double sliding_of_run(const PartSystem& system, const CapstanScratch& capstan,
                             const Row& row) {
  const int run = at(system.frictions, row.friction).run;
  return run >= 0 && at(capstan.runs, run).follows ? 0.0 : run_speed(system, capstan, row);
}

inline int sign(Slip slip) {
  return static_cast<int>(slip);
}

/// Whether a segment bears more force than `tolerance` (N s): tension, or what it is pushed by in a
/// pinch.
inline bool bears(const Row& row, double tolerance) {
  return row.impulse > tolerance || (row.clamped && row.impulse < -tolerance);
}

/// Lists the runs of a part's cables that touch a body of finite friction; empty if none do.
void find_runs(const World& world, const Parts& parts, const Part& part, PartSystem& system,
               SolveScratch& scratch);

/// Joins segments into groups for the present states of runs and segments.
///
/// Two slack segments of one group would determine the tension between them twice, from either
/// side. One run between them must stick then; the one that has kept its state longest is made to.
/// So must one of a closed cable, whose tension would have to be another after a round.
void make_groups(const PartSystem& system, SolveScratch& scratch);

/// Impulses of the groups' members in terms of the unknowns, appended to the lists of `scratch`.
void express_impulses(SolveScratch& scratch);

/// Equations of the groups' unknowns, and of middle bodies that stick on their way: sums of rows in
/// which the sliding speeds cancel.
void add_group_equations(PartSystem& system, SolveScratch& scratch);

/// After add_group_equations.
Shortage shortage_of(const Group& group, const PartSystem& system, const CapstanScratch& capstan);

/// Whether a group of which that much is short may bear force: within reach; where nothing is to
/// that does not do so already, if what is slack of it now did.
bool may_bear(const Group& group, const Shortage& shortage, const PartSystem& system,
              const SolveScratch& scratch);

/// Sliding speeds of all runs for the rows' present speeds: those of elastic cables such that their
/// tensions at the interval's end follow from one another as the impulses do. Slack cable in a
/// pinch goes with the body that holds it more; its friction on the other is both bodies'.
void slip_speeds(const PartSystem& system, SolveScratch& scratch);

/// Appends a flip for every run or group whose state the present solution contradicts.
void check_runs(const PartSystem& system, SolveScratch& scratch, double speed_tolerance,
                double impulse_tolerance);

}  // namespace pinchlab
